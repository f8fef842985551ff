//! Springs, dampers and drives in joints: the closed form of the midpoint map, the rigid limit, stiffness without bound,
//! order, reversibility, and that the tests can fail.

use nalgebra::Vector3;
use rattlebench::mechanics::coordinates::CoordinateTracker;
use rattlebench::mechanics::{Drive, JointSpring, State, System, energy};
use rattlebench::model::JointKind::{self, *};
use rattlebench::model::Scene;
use rattlebench::variational::composition::{self, Composition};
use rattlebench::variational::{Failure, Rattle};

use crate::common::*;

fn spring(body: usize, stiffness: f64, damping: f64, rest: f64) -> JointSpring {
    JointSpring { body, stiffness, damping, rest }
}

/// The same system with these springs, its energy scale made anew.
fn sprung(system: &System, springs: Vec<JointSpring>) -> System {
    let mut sprung = system.clone();
    sprung.parts.joint_springs = springs;
    sprung.energy_scale = energy::scale(&sprung);
    sprung
}

/// A rod on one joint without gravity, starting at a coordinate with a velocity.
fn oscillator(kind: JointKind, position: f64, velocity: f64) -> System {
    let mut scene = chain(&[(kind, Vector3::new(0.2, 1.0, 0.3))]);
    scene.gravity = Vector3::zeros();
    scene.initial[0].position = vec![position];
    scene.initial[0].velocity = vec![velocity];
    compile(&scene)
}

/// What a joint must move: kg or kg m^2.
fn inertia(system: &System) -> f64 {
    let theta = &system.initial_coordinates[0];
    2.0 * energy::energy(&System { gravity: Vector3::zeros(), ..system.clone() }, &system.initial).kinetic
        / theta.velocity[0].powi(2)
}

/// Three links; the middle joint is the one to be sprung.
fn three_links_scene() -> Scene {
    let mut scene =
        chain(&[(Revolute, Vector3::y()), (Revolute, Vector3::new(0.3, 0.2, 1.0)), (Revolute, Vector3::y())]);
    scene.initial[1].position = vec![0.4];
    scene.initial[2].position = vec![-0.7];
    scene
}

fn three_links() -> System {
    compile(&three_links_scene())
}

/// States after every step; the number of solver rounds.
fn run(system: &System, composition: &Composition, h: f64, steps: usize, mut see: impl FnMut(f64, &State)) -> u64 {
    let mut rattle = Rattle::new(system).unwrap();
    let mut state = system.initial.clone();
    for n in 1..=steps {
        composition.step(&mut rattle, h).unwrap();
        rattle.write_state(&mut state);
        see(n as f64 * h, &state);
    }
    rattle.counters().rounds
}

/// Largest relative energy error of a run without dampers and drives.
fn energy_error(system: &System, composition: &Composition, h: f64, duration: f64) -> f64 {
    let mut joints = CoordinateTracker::new(system);
    let start = energy::energy_at_coordinates(system, &system.initial, &joints.joints).total();
    let mut worst = 0.0_f64;
    run(system, composition, h, (duration / h).round() as usize, |_, state| {
        joints.update(system, state, h);
        let error =
            (energy::energy_at_coordinates(system, state, &joints.joints).total() - start) / system.energy_scale;
        assert!(error.is_finite());
        worst = worst.max(error.abs());
    });
    worst
}

/// Joint positions after every step.
fn positions(system: &System, h: f64, steps: usize) -> Vec<Vec<f64>> {
    let mut joints = CoordinateTracker::new(system);
    let mut all = Vec::new();
    run(system, &composition::ORDER_2, h, steps, |_, state| {
        joints.update(system, state, h);
        all.push(joints.joints.iter().map(|joint| joint.position[0]).collect());
    });
    all
}

/// The midpoint rule turns a harmonic oscillator by `phi` a step, `tan(phi / 2) = x / 2`, `x = h sqrt(k / m)`, whatever
/// `x` is (Hairer, Lubich and Wanner 2006, section VI.4), and conserves its energy.
#[test]
fn a_slider_on_a_spring_oscillates_at_the_frequency_of_the_midpoint_rule() {
    let (h, amplitude, rest) = (1e-3, 2e-3, 0.7);
    let free = oscillator(Prismatic, rest + amplitude, 0.0);
    // measured 2.9e-13, 3.4e-13, 5.3e-13, 8.5e-12, 4.6e-11: the roundoff of a velocity of amplitude * x / h
    for (x, bound) in [(1e-3_f64, 8e-13), (0.1, 8e-13), (2.5, 1.5e-12), (1e3, 2e-11), (1e6, 1.2e-10)] {
        let k = (x / h) * (x / h) * free.bodies[0].mass;
        let system = sprung(&free, vec![spring(0, k, 0.0, rest)]);
        let phi = 2.0 * (0.5 * x).atan();
        let found = positions(&system, h, 1000);
        let error = |turn: f64| {
            let errors = found.iter().zip(1..).map(|(p, n)| (p[0] - rest) / amplitude - (f64::from(n) * turn).cos());
            errors.map(f64::abs).fold(0.0, f64::max)
        };
        let energy = energy_error(&system, &composition::ORDER_2, h, 1.0);
        println!("x {x:e}: position {:.1e} energy {energy:.1e}", error(phi));
        assert!(error(phi) <= bound && energy <= bound, "x {x:e}: {:e} {energy:e}", error(phi));
        // Negative control: the frequency of the exact motion is another one.
        assert!(error(x) > 5e-8, "x {x:e}");
    }
}

/// Positions of RATTLE do not depend on the projection of the momenta, so that the limit is RATTLE with a rigid joint.
#[test]
fn a_sprung_joint_tends_to_a_rigid_one_with_its_stiffness() {
    let free = three_links();
    let mut scene = three_links_scene();
    let joint = &mut scene.model.joints[1];
    joint.kind = Fixed;
    joint.origin *= nalgebra::UnitQuaternion::from_axis_angle(&joint.axis, 0.4);
    scene.initial[1] = Default::default();
    let rigid = positions(&compile(&scene), 1e-3, 1000);
    let mut points = Vec::new();
    for k in [1e4, 1e6, 1e8, 1e10, 1e12, 1e15] {
        let soft = positions(&sprung(&free, vec![spring(1, k, 0.0, 0.4)]), 1e-3, 1000);
        let pairs = soft.iter().zip(&rigid);
        let worst = pairs.map(|(a, b)| (a[0] - b[0]).abs().max((a[2] - b[1]).abs())).fold(0.0, f64::max);
        println!("k {k:e}: {worst:.2e}");
        points.push((k, worst));
    }
    let order = slope(&points[..5]);
    assert!((order + 1.0).abs() <= 0.05, "order {order}");
    // measured 2.1e-14: roundoff does not grow with the stiffness
    assert!(points[5].1 <= 6e-14);
}

#[test]
fn energy_stays_bounded_from_soft_to_stiff() {
    let (h, j) = (1e-3, 0.06);
    for x in [1e-3, 1e-1, 1.0, 3.0, 10.0, 1e2, 1e4, 1e6] {
        let k = j * (x / h) * (x / h);
        let system = sprung(&three_links(), vec![spring(1, k, 0.0, 0.4)]);
        let (short, long) = (
            energy_error(&system, &composition::ORDER_2, h, 5.0),
            energy_error(&system, &composition::ORDER_2, h, 20.0),
        );
        println!("x {x:e}: {short:.2e} over 5 s, {long:.2e} over 20 s");
        assert!(short > 1e-7 && long <= 4e-4 && long <= 3.0 * short, "x {x:e}: {short:e} {long:e}");
    }
}

/// Springs in a hinge and a slider, drives in a hinge and a slider.
fn driven(damping: f64) -> System {
    let mut scene = chain(&[
        (Revolute, Vector3::y()),
        (Prismatic, Vector3::new(0.3, 1.0, 0.2)),
        (Revolute, Vector3::new(0.0, 1.0, 1.0)),
        (Spherical, Vector3::x()),
    ]);
    scene.initial[2].velocity = vec![0.5];
    let mut system = compile(&scene);
    system.parts.joint_springs = vec![spring(1, 900.0, damping, 0.05), spring(2, 3.0, 0.2 * damping, -0.4)];
    let drive = |body, effort, amplitude, hz: f64, phase| Drive {
        body,
        effort,
        amplitude,
        angular_frequency: std::f64::consts::TAU * hz,
        phase,
    };
    system.parts.drives =
        vec![drive(0, 1.5, 0.0, 0.0, 0.0), drive(1, 0.0, 8.0, 1.5, 0.3), drive(2, 0.1, 0.6, 2.0, 1.0)];
    system.energy_scale = energy::scale(&system);
    system
}

fn end(system: &System, composition: &Composition, h: f64, duration: f64) -> State {
    let mut last = system.initial.clone();
    run(system, composition, h, (duration / h).round() as usize, |_, state| last.clone_from(state));
    last
}

#[test]
fn springs_and_drives_have_the_order_of_the_composition() {
    let system = driven(0.0);
    let exact = end(&system, &composition::ORDER_8, 2e-3, 1.0);
    let cases: [(Composition, f64, [f64; 4]); 4] = [
        (composition::ORDER_2, 2.0, [2e-3, 1e-3, 5e-4, 2.5e-4]),
        (composition::ORDER_4, 4.0, [5e-3, 4e-3, 2.5e-3, 2e-3]),
        (composition::ORDER_6, 6.0, [1e-2, 8e-3, 6.25e-3, 5e-3]),
        (composition::ORDER_8, 8.0, [1e-2, 8e-3, 6.25e-3, 5e-3]),
    ];
    for (composition, order, steps) in cases {
        let points: Vec<_> =
            steps.into_iter().map(|h| (h, distance(&end(&system, &composition, h, 1.0), &exact))).collect();
        let fitted = slope(&points);
        println!("order {order}: fitted {fitted:.2}, {points:?}");
        assert!((fitted - order).abs() <= 0.25, "{fitted}");
        assert!(points[3].1 > 1e-12, "above the roundoff floor");
    }
    // Negative control: the drives matter, and so does their time.
    let mut late = system.clone();
    late.parts.drives.iter_mut().for_each(|drive| drive.phase += 0.01);
    assert!(distance(&end(&late, &composition::ORDER_8, 2e-3, 1.0), &exact) > 1e-5);
}

#[test]
fn springs_dampers_and_drives_together_have_order_two() {
    let system = driven(2.0);
    let exact = end(&system, &composition::ORDER_2, 2e-5, 1.0);
    let points: Vec<_> = [4e-3, 2e-3, 1e-3, 5e-4]
        .into_iter()
        .map(|h| (h, distance(&end(&system, &composition::ORDER_2, h, 1.0), &exact)))
        .collect();
    let fitted = slope(&points);
    println!("fitted {fitted:.2}, {points:?}");
    assert!((fitted - 2.0).abs() <= 0.1, "{fitted}");
}

/// A step backwards undoes one forwards, drives included: each evaluates them at the same midpoint.
#[test]
fn a_thousand_steps_and_a_thousand_back_return_to_the_start() {
    let stiff = sprung(&three_links(), vec![spring(1, 1e12, 0.0, 0.4)]);
    for system in [driven(0.0), stiff] {
        let mut rattle = Rattle::new(&system).unwrap();
        let (mut there, mut back) = (system.initial.clone(), system.initial.clone());
        (0..1000).for_each(|_| rattle.step(1e-3).unwrap());
        rattle.write_state(&mut there);
        (0..1000).for_each(|_| rattle.step(-1e-3).unwrap());
        rattle.write_state(&mut back);
        let (travelled, missed) = (distance(&there, &system.initial), distance(&back, &system.initial));
        println!("travelled {travelled:.2}, missed by {missed:.1e}");
        // measured 2.4e-14 and 2.6e-15
        assert!(travelled > 0.1 && missed <= 7e-14);
    }
}

/// On a slider the midpoint rule gives `v_n = h/m sum_k u((k + 1/2) h)`, a sum with a closed form. After a million steps
/// of 0.1 s, which has no exact binary form, a time summed step by step would be late by 1.3e-6 s.
#[test]
fn drives_keep_time_over_a_million_steps() {
    let mut system = oscillator(Prismatic, 0.0, 0.0);
    let (h, steps, w, phase) = (0.1, 1_000_000, 7.3, 0.4);
    system.parts.drives = vec![Drive { body: 0, effort: 0.0, amplitude: 2.0, angular_frequency: w, phase }];
    let mut rattle = Rattle::new(&system).unwrap();
    let mut state = system.initial.clone();
    let axis = system.bodies[0].joint.in_parent.rotation * Vector3::z();
    let closed = |n: f64| {
        2.0 * h / system.bodies[0].mass * ((phase).cos() - (w * n * h + phase).cos()) / (2.0 * (0.5 * w * h).sin())
    };
    let mut worst = 0.0_f64;
    for n in 1..=steps {
        rattle.step(h).unwrap();
        if n > steps - 1000 {
            rattle.write_state(&mut state);
            worst = worst.max((state.bodies[0].velocity.dot(&axis) - closed(f64::from(n))).abs());
        }
    }
    println!("{worst:.1e} m/s");
    // measured 3.2e-10, the roundoff of a phase of 7.3e5 rad
    assert!(worst <= 9e-10);
    assert!((closed(1e6) - closed(1e6 + 1e-5)).abs() > 1e-6, "a late drive would be seen");
}

/// A flywheel on a torsion spring that winds up over three turns: its energy needs the unwrapped angle.
#[test]
fn a_torsion_spring_winds_up_over_several_turns() {
    let free = oscillator(Revolute, 0.0, 6.0);
    let j = inertia(&free);
    let system = sprung(&free, vec![spring(0, 0.09 * j, 0.0, 0.0)]);
    let error = energy_error(&system, &composition::ORDER_2, 1e-3, 30.0);
    let highest = positions(&system, 1e-3, 30_000).iter().map(|p| p[0]).fold(0.0, f64::max);
    println!("energy {error:.1e}, {highest:.2} rad");
    // measured 5e-6; 6 / 0.3 = 20 rad
    assert!(error <= 1.5e-5 && (highest - 20.0).abs() < 1e-2);
}

/// The chord iteration takes as many rounds for a stiff spring as for a soft one.
#[test]
fn stiffness_costs_nothing() {
    let rounds = [1.0, 1e12].map(|k| {
        let system = sprung(&three_links(), vec![spring(1, k, 0.0, 0.4)]);
        run(&system, &composition::ORDER_2, 1e-3, 5000, |_, _| {}) as f64 / 5000.0
    });
    println!("{rounds:?} rounds a step");
    // measured 3.7 and 3.9
    assert!(rounds[1] <= 1.1 * rounds[0], "{rounds:?}");
}

#[test]
fn dampers_beside_springs_are_refused_above_order_two() {
    use rattlebench::engines::{Spec, build};
    let system = sprung(&three_links(), vec![spring(1, 5.0, 0.1, 0.0)]);
    let error = build(&Spec::parse("rattle:order=4").unwrap(), &system, 1e-3).err().expect("refused").to_string();
    assert_eq!(
        error,
        "engine 'rattle:order=4' does not support damping (joint 'joint_2') at order 4: a composition of order above 2 has \
         backward substeps, in which a damper would give energy; use order=2"
    );
}

#[test]
fn a_stiffness_beyond_numbers_is_refused() {
    let system = sprung(&three_links(), vec![spring(1, f64::MAX, 0.0, 0.3)]);
    let failure = Rattle::new(&system).unwrap().step(1e-3).unwrap_err();
    assert!(
        matches!(failure, Failure::NotFinite { .. } | Failure::Singular { .. } | Failure::Rotation { .. }),
        "{failure:?}"
    );
}
