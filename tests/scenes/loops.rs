//! Loops and mimic joints: they are closed at the start, stay closed, keep the order of the methods, and say so where they
//! cannot.

use nalgebra::{Isometry3, Matrix3, Unit, Vector3};
use rattlebench::mechanics::{State, System, constraint, energy};
use rattlebench::model::scene::{FixedFrame, Loop, LoopKind};
use rattlebench::model::{Inertial, Joint, JointKind, Link, Mimic, Model, Scene};
use rattlebench::variational::Rattle;
use rattlebench::variational::composition::{self, Composition};

use crate::common::*;

const LINKAGES: [&str; 4] = ["four_bar", "slider_crank", "bricard", "ladder"];

/// The state after a time, with the largest relative energy error and residuals on the way.
fn run(system: &System, composition: &Composition, h: f64, duration: f64) -> (State, f64, Open) {
    let mut rattle = Rattle::new(system).unwrap();
    let mut state = system.initial.clone();
    let start = energy::energy(system, &state).total();
    let (mut error, mut open) = (0.0_f64, Open::default());
    for _ in 0..(duration / h).round() as usize {
        composition.step(&mut rattle, h).unwrap();
        rattle.write_state(&mut state);
        let off = (energy::energy(system, &state).total() - start).abs() / system.energy_scale;
        assert!(off.is_finite());
        error = error.max(off);
        open.see(system, &state);
    }
    (state, error, open)
}

#[test]
fn mobility_counts_redundant_rows() {
    for (name, tree, rows, redundant) in
        [("four_bar", 3, 5, 3), ("slider_crank", 3, 5, 3), ("bricard", 5, 5, 1), ("ladder", 30, 50, 30)]
    {
        let system = shipped(name);
        let mobility = &system.mobility;
        assert_eq!((mobility.tree, mobility.rows, mobility.rows - mobility.rank), (tree, rows, redundant), "{name}");
        assert_eq!(mobility.redundant.iter().sum::<usize>(), redundant, "{name}");
        assert_eq!(Rattle::new(&system).unwrap().rank(), mobility.rank, "{name}");
    }
    assert_eq!(shipped("bricard").degrees_of_freedom(), 1);
}

#[test]
fn linkages_start_closed() {
    for name in LINKAGES {
        let system = shipped(name);
        let residual = constraint::residual(&system, &system.initial);
        // measured 1.1e-15 m and 2.7e-15 m/s
        assert!(residual.position <= 3e-15 && residual.velocity <= 8e-15, "{name}: {residual:?}");
    }
    // The velocity of the crank is kept, and the others follow it.
    let four_bar = shipped("four_bar");
    assert_eq!(four_bar.initial_coordinates[0].velocity[0], 6.0);
    assert!(four_bar.initial_coordinates[1].velocity[0].abs() > 1.0);
}

#[test]
fn linkages_stay_closed_and_their_energy_error_is_of_order_two() {
    for (name, h) in [("four_bar", 4e-3), ("slider_crank", 2e-3), ("bricard", 4e-3), ("ladder", 2e-3)] {
        let system = shipped(name);
        let mut points = Vec::new();
        for h in [h, h / 2.0, h / 4.0, h / 8.0] {
            let (_, error, open) = run(&system, &composition::ORDER_2, h, 1.0);
            println!("{name} h {h}: energy {error:.3e} {open:?}");
            // measured at most 1.1e-15 m (bricard) and 1.1e-14 m/s (slider_crank)
            assert!(open.at_most(2.5e-15, 2.5e-14), "{name}: {open:?}");
            points.push((h, error));
        }
        let order = slope(&points);
        println!("{name}: order {order:.3}");
        assert!(points[0].1 > 1e-6 && (order - 2.0).abs() <= 0.2, "{name}: order {order}");
    }
}

/// The states at ten times within 1 s, of `n` steps a second.
fn sampled(system: &System, composition: &Composition, n: usize) -> Vec<State> {
    let mut rattle = Rattle::new(system).unwrap();
    let mut states = vec![system.initial.clone(); 10];
    for state in &mut states {
        for _ in 0..n / 10 {
            composition.step(&mut rattle, 1.0 / n as f64).unwrap();
        }
        rattle.write_state(state);
    }
    states
}

#[test]
fn compositions_keep_their_order_on_linkages() {
    let swift =
        [(2, [260, 520, 1040, 2080]), (4, [120, 190, 260, 380]), (6, [130, 160, 200, 260]), (8, [110, 130, 150, 170])];
    let slow = [(2, [130, 260, 520, 1040]), (4, [60, 100, 130, 190]), (6, [60, 80, 100, 130]), (8, [50, 60, 70, 80])];
    for (name, counts) in [("four_bar", swift), ("bricard", slow)] {
        let system = shipped(name);
        let truth = sampled(&system, &composition::ORDER_8, 800);
        for (order, counts) in counts {
            let composition = composition::ALL.iter().find(|c| c.order == order).unwrap();
            let error = |n: usize| {
                let states = sampled(&system, composition, n);
                states.iter().zip(&truth).map(|(a, b)| distance(a, b)).fold(0.0, f64::max)
            };
            let errors = counts.map(|n| (1.0 / n as f64, error(n)));
            let fitted = slope(&errors);
            println!("{name}: order {order}: fitted {fitted:.3}, {errors:?}");
            assert!(errors[3].1 > 5e-14 && (fitted - f64::from(order)).abs() <= 0.2, "{name}: {order}: {fitted}");
        }
    }
}

#[test]
fn order_eight_holds_the_energy_of_linkages_to_roundoff() {
    // measured 4.5e-16 m and 5.3e-15 m/s, 2.0e-14 m and 9.9e-14 m/s
    for (name, position, velocity) in [("four_bar", 1.2e-15, 1.3e-14), ("bricard", 5e-14, 2.5e-13)] {
        let (_, error, open) = run(&shipped(name), &composition::ORDER_8, 2e-3, 10.0);
        println!("{name}: {error:e} {open:?}");
        // measured 2.4e-15 and 1.4e-15
        assert!(error <= 7e-15, "{name}: {error:e}");
        assert!(open.at_most(position, velocity), "{name}: {open:?}");
    }
}

#[test]
fn an_overconstrained_linkage_stays_on_its_path() {
    // Impulses that change nothing, extrapolated from step to step, once drove it off within 10 s.
    let (_, error, open) = run(&shipped("bricard"), &composition::ORDER_2, 2.5e-4, 20.0);
    // measured 1.1e-6, 1.6e-14 m, 1.0e-13 m/s
    assert!(error <= 3e-6 && open.at_most(4e-14, 3e-13), "{error:e} {open:?}");
}

#[test]
fn a_linkage_runs_back_to_its_start() {
    for name in LINKAGES {
        let system = shipped(name);
        let mut rattle = Rattle::new(&system).unwrap();
        let mut state = system.initial.clone();
        for h in [1e-3, -1e-3] {
            for _ in 0..500 {
                rattle.step(h).unwrap();
            }
        }
        rattle.write_state(&mut state);
        let back = distance(&state, &system.initial);
        println!("{name}: {back:e}");
        // measured 2.6e-16 on the four-bar
        assert!(back <= 8e-16, "{name}: {back:e}");
    }
}

/// A planar chain of three hinges whose end is held by a loop of the given kind.
fn closed_chain(kind: LoopKind, end: [f64; 3]) -> Scene {
    chain_held_at(3, kind, end)
}

fn chain_held_at(hinges: usize, kind: LoopKind, end: [f64; 3]) -> Scene {
    let mut scene = chain(&vec![(JointKind::Revolute, Vector3::y()); hinges]);
    scene.loops.push(Loop {
        name: "end".into(),
        kind,
        axis: Vector3::y_axis(),
        parent: FixedFrame { link: Some(hinges), origin: Isometry3::translation(0.3, 0.0, 0.0) },
        child: FixedFrame { link: None, origin: Isometry3::translation(end[0], end[1], end[2]) },
    });
    scene
}

#[test]
fn loops_of_every_kind_stay_closed() {
    // Energy errors measured: 7.6e-8 twice, 6.5e-7, 2.4e-7.
    for (hinges, kind, axis, bound) in [
        (3, LoopKind::Revolute, Vector3::y_axis(), 2e-7),
        (3, LoopKind::Spherical, Vector3::y_axis(), 2e-7),
        (3, LoopKind::Prismatic, Unit::new_normalize(Vector3::new(1.0, 0.0, 0.5)), 1.6e-6),
        // The last link is welded to the ground: the other three and the ground between are a four-bar.
        (4, LoopKind::Fixed, Vector3::y_axis(), 6e-7),
    ] {
        let mut scene = chain_held_at(hinges, kind, [0.5, 0.0, 0.1]);
        scene.loops[0].axis = axis;
        scene.initial[0].velocity = vec![1.0];
        scene.initial[0].velocity_given = true;
        // The slider's crank and rod are of one length and fold onto each other after 0.38 s, where their path forks.
        let duration = if kind == LoopKind::Prismatic { 0.3 } else { 1.0 };
        let system = compile(&scene);
        let (state, error, open) = run(&system, &composition::ORDER_2, 1e-3, duration);
        println!("{kind:?}: {error:e} {open:?}");
        assert!(distance(&state, &system.initial) > 3e-3, "{kind:?} moves");
        // measured at most 4.8e-16 m or rad and 4.4e-15 m/s or rad/s
        assert!(error <= bound && open.at_most(1.2e-15, 1.1e-14), "{kind:?}: {error:e} {open:?}");
    }
    // A fixed loop at the end of three hinges leaves nothing to move.
    let error = System::compile(&closed_chain(LoopKind::Fixed, [0.5, 0.0, 0.1])).unwrap_err().to_string();
    println!("{error}");
    assert!(error.contains("loop 'end' cannot be closed") || error.contains("nothing can move"), "{error}");
}

#[test]
fn a_path_that_forks_is_followed() {
    let mut scene = closed_chain(LoopKind::Prismatic, [0.5, 0.0, 0.1]);
    scene.loops[0].axis = Unit::new_normalize(Vector3::new(1.0, 0.0, 0.5));
    scene.initial[0].velocity = vec![1.0];
    scene.initial[0].velocity_given = true;
    let system = compile(&scene);
    let start = energy::energy(&system, &system.initial).total();
    // At 0.38 s crank and rod lie on each other, where the path forks.
    for h in [4e-3_f64, 2e-3, 1e-3, 5e-4, 2.5e-4] {
        let mut rattle = Rattle::new(&system).unwrap();
        let mut state = system.initial.clone();
        let ended = (0..(1.0 / h) as usize).find_map(|_| rattle.step(h).err());
        rattle.write_state(&mut state);
        let error = (energy::energy(&system, &state).total() - start).abs() / system.energy_scale;
        println!("h {h}: {ended:?}, energy {error:e}");
        assert_eq!(ended, None);
        // measured 0.251 h^2 / s^2: it goes on without energy from nowhere
        assert!(error <= 0.6 * h * h, "{error:e}");
    }
}

#[test]
fn what_cannot_be_closed_says_by_how_much() {
    // The chain is 0.9 m long.
    let message = |scene: &Scene| System::compile(scene).unwrap_err().to_string();
    insta::assert_snapshot!(message(&closed_chain(LoopKind::Spherical, [1.0, 0.0, 0.0])), @r#"scene 'chain': loop 'end' cannot be closed: 9.881e-2 m or rad stay open at the nearest positions that were found; leave a joint of the loop out of "initial", or check its geometry"#);
    let mut given = closed_chain(LoopKind::Spherical, [0.5, 0.0, 0.1]);
    given.initial.iter_mut().for_each(|initial| initial.position_given = true);
    insta::assert_snapshot!(message(&given), @r#"scene 'chain': loop 'end' cannot be closed: 4.000e-1 m or rad stay open at the nearest positions that were found; leave a joint of the loop out of "initial", or check its geometry"#);
    let mut fast = closed_chain(LoopKind::Spherical, [0.5, 0.0, 0.1]);
    for initial in &mut fast.initial {
        (initial.velocity, initial.velocity_given) = (vec![1.0], true);
    }
    insta::assert_snapshot!(message(&fast), @r#"scene 'chain': the initial velocities open loop 'end' at 9.598e-1 m/s or rad/s; leave the velocity of a joint of the loop out of "initial""#);
    let mut itself = closed_chain(LoopKind::Spherical, [0.5, 0.0, 0.1]);
    itself.loops[0].child.link = Some(3);
    insta::assert_snapshot!(message(&itself), @"scene 'chain': loop 'end' connects two places of one rigid body ('link_3'); remove it, or free a joint between them");
}

#[test]
fn a_slider_goes_through_its_dead_centres() {
    // 12 rad/s carry the crank round about twice a second: the guide stops and turns back at every half turn.
    let system = shipped("slider_crank");
    let (_, error, open) = run(&system, &composition::ORDER_2, 1e-3, 5.0);
    println!("{error:e} {open:?}");
    // measured 1.4e-4
    assert!(error <= 4e-4 && open.at_most(2e-15, 3e-14), "{error:e} {open:?}");
}

/// Parallelograms in a row, of rods of 1 m and 1 kg, upright, with every crank at 1 rad/s: the N-four-bar of the IFToMM benchmark
/// library.
fn parallelograms(n: usize) -> Scene {
    let rod = |along: usize| {
        let moments = Vector3::from_fn(|k, _| if k == along { 1e-3 } else { 1.0 / 12.0 });
        let com = Vector3::from_fn(|k, _| if k == along { 0.5 } else { 0.0 });
        Some(Inertial { mass: 1.0, com, inertia: Matrix3::from_diagonal(&moments) })
    };
    let link = |name: String, inertial| Link { name, inertial, collisions: vec![] };
    let mut links = vec![link("base".into(), None)];
    links.extend((0..=n).map(|i| link(format!("crank_{i}"), rod(2))));
    links.extend((0..n).map(|i| link(format!("bar_{i}"), rod(0))));
    let hinge = |name: String, parent: usize, child: usize, at: [f64; 3]| Joint {
        name,
        kind: JointKind::Revolute,
        parent,
        child,
        origin: Isometry3::translation(at[0], at[1], at[2]),
        axis: Vector3::y_axis(),
        damping: 0.0,
        friction: 0.0,
        mimic: None,
    };
    let mut joints: Vec<Joint> = (0..=n).map(|i| hinge(format!("pivot_{i}"), 0, 1 + i, [i as f64, 0.0, 0.0])).collect();
    joints.extend((0..n).map(|i| hinge(format!("top_{i}"), 1 + i, n + 2 + i, [0.0, 0.0, 1.0])));
    let model = Model { name: "parallelograms".into(), links, joints, ignored: vec![], remarks: vec![] };
    let mut scene = Scene { steps: vec![1e-3], ..Scene::of_model("parallelograms", model) };
    for (i, initial) in scene.initial.iter_mut().enumerate() {
        (initial.velocity, initial.velocity_given) = (vec![if i <= n { 1.0 } else { -1.0 }], true);
        initial.position_given = true;
    }
    scene.loops.extend((0..n).map(|i| Loop {
        name: format!("corner_{i}"),
        kind: LoopKind::Revolute,
        axis: Vector3::y_axis(),
        parent: FixedFrame { link: Some(n + 2 + i), origin: Isometry3::translation(1.0, 0.0, 0.0) },
        child: FixedFrame { link: Some(2 + i), origin: Isometry3::translation(0.0, 0.0, 1.0) },
    }));
    scene
}

#[test]
fn parallelograms_in_a_row_pass_their_flat_positions() {
    for (n, h) in [(2, 1e-3), (2, 2e-3), (10, 2e-3)] {
        let system = compile(&parallelograms(n));
        let mut rattle = Rattle::new(&system).unwrap();
        let (mut state, mut worst, mut flat) = (system.initial.clone(), 0.0_f64, 0);
        let mut side = 1.0;
        for _ in 0..(10.0 / h) as usize {
            rattle.step(h).unwrap();
            rattle.write_state(&mut state);
            worst = worst.max(energy_error(&system, &state).abs());
            let height = state.bodies[0].position.z;
            flat += i32::from(height * side < 0.0);
            side = height.signum();
        }
        // Twice the way to the centre of mass.
        let tip = 2.0 * state.bodies[0].position;
        println!("{n} at {h}: energy {worst:e}, flat {flat} times, tip ({}, {})", tip.x, tip.z);
        assert!(flat >= 6, "{flat}");
        // measured 9.3 h^2 / s^2 at 1 ms
        assert!(worst <= 25.0 * h * h, "{worst:e}");
        // Converged, by generalised-alpha methods of the library: (0.32846, 0.94452) m for two.
        let off = (tip.x - 0.328457).hypot(tip.z - 0.944519);
        // measured 2.0e-5 m at 1 ms
        assert!(n != 2 || off <= 50.0 * h * h, "{off:e}");
    }
}

#[test]
fn a_parallelogram_starts_from_its_flat_position() {
    // The first cell of the ladder, started flat: there its rows lose a rank.
    let mut scene = shipped_scene("ladder");
    for name in ["left_1", "right_1"] {
        let index = scene.model.joints.iter().position(|j| j.name == name).unwrap();
        scene.initial[index].position = vec![-std::f64::consts::FRAC_PI_2];
    }
    let system = compile(&scene);
    let mut rattle = Rattle::new(&system).unwrap();
    let (mut state, mut open, mut worst) = (system.initial.clone(), Open::default(), 0.0_f64);
    let failure = (0..1000).find_map(|_| {
        let failed = rattle.step(1e-3).err();
        rattle.write_state(&mut state);
        open.see(&system, &state);
        worst = worst.max(energy_error(&system, &state).abs());
        failed
    });
    println!("{failure:?} {open:?} {worst:e}");
    assert_eq!(failure, None);
    // measured 8.0e-15 m and 2.3e-5
    assert!(open.position <= 2.4e-14 && worst <= 7e-5, "{open:?} {worst:e}");
}

/// Two hinges of which the second follows the first.
fn geared(multiplier: f64, offset: f64) -> Scene {
    let mut scene = chain(&[(JointKind::Revolute, Vector3::y()); 2]);
    scene.model.joints[1].mimic = Some(Mimic { source: 0, multiplier, offset });
    scene.initial[0].velocity = vec![2.0];
    (scene.initial[0].position_given, scene.initial[0].velocity_given) = (true, true);
    scene
}

#[test]
fn a_mimic_joint_follows() {
    let system = compile(&geared(-1.5, 0.2));
    assert_eq!(system.degrees_of_freedom(), 1);
    let theta = &system.initial_coordinates;
    assert!((theta[1].position[0] - 0.2).abs() <= 1e-15 && (theta[1].velocity[0] + 3.0).abs() <= 1e-15);
    let mut points = Vec::new();
    for h in [4e-3, 2e-3, 1e-3, 5e-4] {
        let mut rattle = Rattle::new(&system).unwrap();
        let mut tracker = rattlebench::mechanics::coordinates::CoordinateTracker::new(&system);
        let (mut state, mut worst, mut open) = (system.initial.clone(), 0.0_f64, 0.0_f64);
        let start = energy::energy(&system, &state).total();
        for _ in 0..(5.0 / h) as usize {
            rattle.step(h).unwrap();
            rattle.write_state(&mut state);
            tracker.update(&system, &state, h);
            let residual = constraint::residual_with_couplings(&system, &state, &tracker.joints);
            open = open.max(residual.position).max(0.1 * residual.velocity);
            worst = worst.max((energy::energy(&system, &state).total() - start).abs() / system.energy_scale);
        }
        println!("h {h}: energy {worst:e}, open {open:e}");
        // measured 1.2e-15
        assert!(open <= 3.5e-15, "{open:e}");
        points.push((h, worst));
    }
    // measured 2.00
    assert!((slope(&points) - 2.0).abs() <= 0.1);
}

#[test]
fn the_motion_of_a_geared_pair_is_that_of_its_one_coordinate() {
    // Equal and opposite angles keep the second rod parallel to its start: with theta the first angle, twice the length l
    // and half of it, T = (m l^2 / 3 + m l^2 ...) thetadot^2 / 2 as below, V = -m g l (3/2) sin(theta).
    let system = compile(&geared(-1.0, 0.0));
    let (mass, length, moment) = (1.0, 0.3, system.bodies[0].inertia.max());
    let first = moment + mass * 0.25 * length * length;
    let effective = first + mass * length * length;
    let acceleration = |theta: f64| mass * 9.81 * 1.5 * length * theta.cos() / effective;
    let (mut theta, mut omega, n) = (0.0_f64, 2.0_f64, 20_000);
    let h = 0.5 / f64::from(n);
    // Classical Runge-Kutta: its error is far below that of the map it is compared with.
    for _ in 0..n {
        let (k1, l1) = (omega, acceleration(theta));
        let (k2, l2) = (omega + 0.5 * h * l1, acceleration(theta + 0.5 * h * k1));
        let (k3, l3) = (omega + 0.5 * h * l2, acceleration(theta + 0.5 * h * k2));
        let (k4, l4) = (omega + h * l3, acceleration(theta + h * k3));
        theta += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        omega += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
    }
    let (state, ..) = run(&system, &composition::ORDER_8, 1.0 / 400.0, 0.5);
    let tip = Vector3::new(length * theta.cos() + 0.5 * length, 0.0, -length * theta.sin());
    let off = (state.bodies[1].position - tip).norm();
    println!("{off:e}");
    // measured 2.1e-15
    assert!(off <= 6e-15, "{off:e}");
}

#[test]
fn the_gripper_stays_geared_and_the_plate_keeps_its_energy() {
    for (name, freedoms) in [("gripper", 1), ("hung_plate", 6)] {
        let system = shipped(name);
        assert_eq!(system.degrees_of_freedom(), freedoms, "{name}");
        let mut tracker = rattlebench::mechanics::coordinates::CoordinateTracker::new(&system);
        let start = energy::energy_at_coordinates(&system, &system.initial, &tracker.joints).total();
        let (mut state, mut kinetic) = (system.initial.clone(), 0.0_f64);
        let mut rattle = Rattle::new(&system).unwrap();
        let (mut worst, mut position, mut velocity) = (0.0_f64, 0.0_f64, 0.0_f64);
        for _ in 0..5000 {
            rattle.step(1e-3).unwrap();
            rattle.write_state(&mut state);
            tracker.update(&system, &state, 1e-3);
            let residual = constraint::residual_with_couplings(&system, &state, &tracker.joints);
            let now = energy::energy_at_coordinates(&system, &state, &tracker.joints);
            assert!(state.is_finite() && residual.velocity.is_finite());
            (position, velocity) = (position.max(residual.position), velocity.max(residual.velocity));
            worst = worst.max((now.total() - start).abs() / system.energy_scale);
            kinetic = kinetic.max(now.kinetic);
        }
        println!("{name}: energy {worst:e}, position {position:e}, velocity {velocity:e}, kinetic {kinetic:e}");
        assert!(kinetic > 0.05 * system.energy_scale, "{name} moves");
        // measured 3.4e-5, 5.6e-16 m or rad and 2.7e-14 m/s or rad/s, all on the gripper
        assert!(
            worst <= 8e-5 && position <= 1.5e-15 && velocity <= 7e-14,
            "{name}: {worst:e} {position:e} {velocity:e}"
        );
    }
}
