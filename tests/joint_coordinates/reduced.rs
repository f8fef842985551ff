//! The equations in joint coordinates against each other and against the mechanics of bodies, and the methods on them.

use nalgebra::{DMatrix, DVector, Isometry3, Vector3};
use proptest::prelude::*;
use rattlebench::engines::reference::{distance, trajectory};
use rattlebench::engines::{self, Spec};
use rattlebench::mechanics::coordinates::{JointCoordinates, joint_coordinates};
use rattlebench::mechanics::{Anchor, Drive, JointKind, JointSpring, PointSpring, State, System, energy};
use rattlebench::model;
use rattlebench::reduced::Model;
use rattlebench::reduced::equations::Articulated;
use rattlebench::reduced::equations::Dynamics;

use crate::common::*;

/// Of the drives in the properties, s.
const TIME: f64 = 0.3;

const KINDS: [model::JointKind; 5] = [
    model::JointKind::Revolute,
    model::JointKind::Prismatic,
    model::JointKind::Planar,
    model::JointKind::Spherical,
    model::JointKind::Floating,
];

/// A tree whose link `i` hangs on `parents[i] % i`, with joints of random kinds, places, positions and velocities.
fn tree(kinds: &[usize], parents: &[usize], numbers: &[f64]) -> System {
    let mut number = numbers.iter().copied().cycle();
    let mut vector = |size: f64| {
        let mut next = || number.next().unwrap_or(0.3);
        Vector3::new(next(), next(), next()) * size
    };
    let joints: Vec<_> = kinds.iter().map(|&k| (KINDS[k], vector(1.0) + Vector3::new(0.0, 0.0, 1.5))).collect();
    let mut scene = chain(&joints);
    for (i, joint) in scene.model.joints.iter_mut().enumerate() {
        joint.parent = if i == 0 { 0 } else { 1 + parents[i] % i };
        joint.origin = Isometry3::new(vector(0.3), vector(2.0));
        joint.damping = if joint.kind == model::JointKind::Floating { 0.0 } else { 0.02 };
        for k in 0..scene.initial[i].position.len() {
            scene.initial[i].position[k] = vector(1.0).x;
            scene.initial[i].velocity[k] = vector(2.0).y;
        }
    }
    compile(&scene)
}

fn trees() -> impl Strategy<Value = System> {
    let kinds = prop::collection::vec(0..KINDS.len(), 1..8);
    let (parents, numbers) = (prop::collection::vec(0..7usize, 8), prop::collection::vec(-1.0..1.0f64, 97));
    (kinds, parents, numbers).prop_map(|(kinds, parents, numbers)| tree(&kinds, &parents, &numbers))
}

/// The same with a drive in every joint of one coordinate, and damped springs from each link to the ground and to its parent.
fn loaded_trees() -> impl Strategy<Value = System> {
    trees().prop_map(loaded)
}

fn loaded(mut system: System) -> System {
    for (i, body) in system.bodies.iter().enumerate() {
        let end = |body, x: f64| Anchor { body, point: Vector3::new(x, 0.1, -0.05 * i as f64) };
        let spring = |from, to| PointSpring { from, to, stiffness: 3.0, damping: 0.02, rest_length: 0.2 };
        system.parts.point_springs.push(spring(end(None, 2.0), end(Some(i), 0.1)));
        if body.joint.parent.is_some() {
            system.parts.point_springs.push(spring(end(Some(i), 0.6), end(body.joint.parent, -0.3)));
        }
        if let JointKind::Revolute | JointKind::Prismatic = body.joint.kind {
            let drive = Drive { body: i, effort: 0.1, amplitude: 0.3, angular_frequency: 5.0, phase: 0.3 * i as f64 };
            system.parts.drives.push(drive);
        }
    }
    system
}

/// Accelerations by articulated bodies at the time of the tests.
fn accelerations(model: &Model, q: &[f64], v: &[f64]) -> Vec<f64> {
    let mut a = vec![0.0; v.len()];
    Articulated::new(model.clone()).accelerations(TIME, q, v, &mut a).expect("every joint moves mass");
    a
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |all, x| if x.is_nan() || all.is_nan() { f64::NAN } else { all.max(x.abs()) })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Two algorithms that share no code: articulated bodies in world axes, and a dense mass matrix in link axes.
    #[test]
    fn articulated_bodies_and_the_dense_equations_give_the_same_accelerations(system in loaded_trees()) {
        let model = Model::new(&system);
        let (q, v) = model.initial();
        let found = accelerations(&model, &q, &v);
        let mut dynamics = Dynamics::new(model);
        let mut dense = vec![0.0; v.len()];
        dynamics.accelerations(TIME, &q, &v, &mut dense).unwrap();
        let condition = dynamics.mass_matrix(&q).clone().symmetric_eigenvalues();
        let error = largest(found.iter().zip(&dense).map(|(a, b)| a - b)) / largest(dense.iter().copied()).max(1.0);
        // measured over 200 000 trees at most 2.3e-14 of the condition number
        prop_assert!(error <= 6e-14 * condition.max() / condition.min(), "{error:e} {condition}");
    }

    /// `d/dt (K + U) = -c v^2 - c (d(d)/dt)^2 + f(t) v` along the accelerations, with the energy of the bodies by differences along the
    /// motion: `dE/dq v` at fixed velocities, and `dE/dv a`, which one difference of any width gives exactly, since `E` is quadratic in `v`.
    #[test]
    fn the_power_of_dampers_and_drives_is_the_change_of_energy(system in loaded_trees()) {
        let model = Model::new(&system);
        let (q, v) = model.initial();
        let a = accelerations(&model, &q, &v);
        let mut state = system.initial.clone();
        let mut energy_at = |moved: f64, pushed: f64| {
            let mut q = q.clone();
            model.advance(&mut q, &v, moved);
            let v: Vec<f64> = v.iter().zip(&a).map(|(v, a)| v + pushed * a).collect();
            model.write_state(&q, &v, &mut state);
            energy::energy(&system, &state).total()
        };
        // The energy of a spring bends within its length.
        let shortest = system.parts.point_springs.iter().map(|s| s.distance(&system.initial).0).fold(1.0, f64::min);
        let reach = 1e-3 * shortest / largest(v.iter().copied()).max(1.0);
        let mut slope = |h: f64| (energy_at(h, 0.0) - energy_at(-h, 0.0)) / (2.0 * h);
        let (near, far) = (slope(0.5 * reach), slope(reach));
        let along_positions = (4.0 * near - far) / 3.0;
        let width = largest(v.iter().copied()).max(1e-3) / largest(a.iter().copied()).max(1e-3);
        let along_velocities = (energy_at(0.0, width) - energy_at(0.0, -width)) / (2.0 * width);
        let power = along_positions + along_velocities;
        let lost: f64 = model
            .links
            .iter()
            .flat_map(|link| (0..link.kind.degrees_of_freedom()).map(|k| link.damping * v[link.velocity + k].powi(2)))
            .sum();
        let stretched = |spring: &PointSpring| spring.damping * spring.distance(&system.initial).1.powi(2);
        let lost = lost + system.parts.point_springs.iter().map(stretched).sum::<f64>();
        let driven = |drive: &Drive| drive.at(TIME) * v[model.links[drive.body].velocity];
        let lost = lost - system.parts.drives.iter().map(driven).sum::<f64>();
        let energy = energy::energy(&system, &system.initial).kinetic.max(system.energy_scale);
        let scale = energy * (1.0 / reach + 1.0 / width);
        let condition = Dynamics::new(model).mass_matrix(&q).clone().symmetric_eigenvalues();
        let error = (power + lost).abs() / scale;
        // measured over 200 000 trees at most 8.7e-15
        prop_assert!(error <= 2e-14 * (condition.max() / condition.min()).sqrt(), "{error:e} {power} {lost} {condition}");
    }

    /// `1/2 v . H v` is the kinetic energy of the bodies, and inverse dynamics undoes forward dynamics.
    #[test]
    fn the_mass_matrix_holds_the_kinetic_energy_of_the_bodies(system in trees()) {
        let model = Model::new(&system);
        let (q, v) = model.initial();
        let mut dynamics = Dynamics::new(model.clone());
        let rates = DVector::from_row_slice(&v);
        let kinetic = 0.5 * rates.dot(&(dynamics.mass_matrix(&q) * &rates));
        let bodies = energy::energy(&system, &system.initial).kinetic;
        // measured over 200 000 trees at most 1.8e-14
        prop_assert!((kinetic - bodies).abs() <= 5e-14 * bodies.max(1e-3), "{kinetic} {bodies}");
        let a = accelerations(&model, &q, &v);
        let mut effort = vec![0.0; v.len()];
        dynamics.inverse(&q, &v, &a, &mut effort);
        let mut error = 0.0f64;
        for link in &model.links {
            for k in link.velocity..link.velocity + link.kind.degrees_of_freedom() {
                error = error.max((effort[k] + link.damping * v[k]).abs());
            }
        }
        let weight = largest(dynamics.mass_matrix(&q).iter().copied()) * largest(a).max(10.0);
        // measured over 200 000 trees at most 5.4e-15
        prop_assert!(error <= 1.6e-14 * weight, "{error:e} {weight}");
    }
}

/// Every joint type in one chain, with a velocity on every coordinate.
fn zoo() -> System {
    let kinds = [
        model::JointKind::Revolute,
        model::JointKind::Spherical,
        model::JointKind::Prismatic,
        model::JointKind::Planar,
        model::JointKind::Floating,
    ];
    let mut scene = chain(&kinds.map(|kind| (kind, Vector3::new(0.3, 1.0, 0.2))));
    for (k, joint) in scene.initial.iter_mut().enumerate() {
        for (i, v) in joint.velocity.iter_mut().enumerate() {
            *v = 1.3 - 0.5 * i as f64 + 0.2 * k as f64;
        }
        for (i, x) in joint.position.iter_mut().enumerate() {
            *x = 0.2 * (i as f64 + 1.0) - 0.1 * k as f64;
        }
    }
    compile(&scene)
}

#[test]
fn every_method_has_its_order_on_a_chain_of_every_joint_type() {
    orders(&zoo(), &[20, 28, 40, 56]);
}

#[test]
fn every_method_has_its_order_with_drives_and_damped_springs_between_points() {
    orders(&loaded(alternating_in_motion()), &[12, 14, 17, 20]);
}

/// `eighth`: numbers of steps for the method of order 8.
fn orders(system: &System, eighth: &[usize]) {
    let reference = &trajectory(system, &[0.4]).unwrap().states[0];
    let cases: [(&str, f64, &[usize]); 6] = [
        ("galerkin:stages=2", 4.0, &[40, 56, 80, 112]),
        ("galerkin:stages=3", 6.0, &[20, 28, 40, 56]),
        ("galerkin:stages=4", 8.0, eighth),
        ("rk4", 4.0, &[80, 112, 160, 224]),
        ("semi_implicit_euler", 1.0, &[800, 1131, 1600, 2263]),
        ("explicit_euler", 1.0, &[800, 1131, 1600, 2263]),
    ];
    for (text, order, counts) in cases {
        let error = |&n: &usize| (0.4 / n as f64, distance(&run_engine(text, system, 0.4 / n as f64, n), reference));
        let points: Vec<_> = counts.iter().map(error).collect();
        let found = slope(&points);
        println!("{text} {found:.2} {points:?}");
        assert!(points.iter().all(|p| p.1 > 1e-13 && p.1 < 0.1), "{text} {points:?}");
        assert!((found - order).abs() <= 0.25, "{text}: order {found}");
    }
}

#[test]
fn the_error_of_dop853_follows_its_tolerance() {
    let system = zoo();
    let reference = &trajectory(&system, &[0.4]).unwrap().states[0];
    let errors = ["1e-5", "1e-7", "1e-9", "1e-11"]
        .map(|tolerance| distance(&run_engine(&format!("dop853:tolerance={tolerance}"), &system, 0.2, 2), reference));
    println!("{errors:?}");
    // measured 1.5e-7, 2.6e-9, 8.1e-11, 9.6e-13
    for (error, bound) in errors.into_iter().zip([4e-7, 7e-9, 2e-10, 3e-12]) {
        assert!(error <= bound, "{errors:?}");
    }
    let fine = distance(&run_engine("dop853:tolerance=1e-5", &system, 0.001, 400), reference);
    assert!(fine < 1e-2 * errors[0], "it lands on every step: {fine:e}");
}

/// The system released from where another one has come to, everything turned round.
fn turned_round(system: &System, state: &State) -> System {
    let mut back = system.clone();
    back.initial = reversed(state.clone());
    let mut joints = vec![JointCoordinates::default(); system.bodies.len()];
    joint_coordinates(&back, &back.initial, &mut joints);
    back.initial_coordinates = joints;
    back
}

#[test]
fn galerkin_is_reversible_and_runge_kutta_is_not() {
    let system = zoo();
    let there_and_back = |text: &str| {
        let back = run_engine(text, &turned_round(&system, &run_engine(text, &system, 0.01, 40)), 0.01, 40);
        distance(&back, &system.initial)
    };
    for stages in 2..=8 {
        let error = there_and_back(&format!("galerkin:stages={stages}"));
        println!("{stages} {error:.1e}");
        // measured 7e-14 to 7.5e-13
        assert!(error <= 2e-12, "{stages}: {error:e}");
    }
    let control = there_and_back("rk4");
    println!("rk4 {control:.1e}");
    // measured 5.0e-5
    assert!(control > 1e-5, "{control:e}");
}

/// `A^T Omega A - Omega` of one step's derivative, by sixth-order differences in the coordinates of the joints about the
/// start and about the end, with canonical momenta `p = H theta'` by the dense mass matrix.
#[test]
fn one_galerkin_step_is_symplectic_and_one_of_the_explicit_methods_is_not() {
    symplectic_or_not(&alternating_in_motion());
}

#[test]
fn springs_between_points_and_drives_keep_a_galerkin_step_symplectic() {
    let mut system = loaded(alternating_in_motion());
    system.parts.point_springs.iter_mut().for_each(|spring| spring.damping = 0.0);
    symplectic_or_not(&system);
}

fn symplectic_or_not(system: &System) {
    for text in ["galerkin:stages=2", "galerkin:stages=4"] {
        let defect = defect(system, text);
        println!("{text} {defect:.1e}");
        // measured 6.5e-13 and 1.3e-12, all of it from the differences
        assert!(defect <= 4e-12, "{text}: {defect:e}");
    }
    for text in ["rk4", "semi_implicit_euler", "explicit_euler"] {
        let defect = defect(system, text);
        println!("{text} {defect:.1e}");
        // measured 9.6e-5, 1.7e-1 and 2.2e-1
        assert!(defect > 3e-5, "{text}: {defect:e}");
    }
}

fn alternating_in_motion() -> System {
    let mut scene = alternating(3);
    for (i, joint) in scene.initial.iter_mut().enumerate() {
        joint.position = vec![0.4 - 0.3 * i as f64];
        joint.velocity = vec![1.0 + 2.0 * i as f64];
    }
    compile(&scene)
}

/// The largest entry of the defect on a chain of hinges, in units of the mass matrix's largest entry.
fn defect(system: &System, text: &str) -> f64 {
    let n = system.bodies.len();
    let mut dynamics = Dynamics::new(Model::new(system));
    let (q0, v0) = dynamics.model().initial();
    let p0 = dynamics.mass_matrix(&q0) * DVector::from_row_slice(&v0);
    let start = DVector::from_iterator(2 * n, q0.iter().copied().chain(p0.iter().copied()));
    let mut step = |y: &DVector<f64>| {
        let v = dynamics.mass_matrix(&y.as_slice()[..n]).clone().cholesky().unwrap().solve(&y.rows(n, n));
        let mut from = system.clone();
        for i in 0..n {
            from.initial_coordinates[i].position[0] = y[i];
            from.initial_coordinates[i].velocity[0] = v[i];
        }
        let end = run_engine(text, &from, 0.03, 1);
        let mut joints = vec![JointCoordinates::default(); n];
        joint_coordinates(system, &end, &mut joints);
        let q: Vec<f64> = joints.iter().map(|j| j.position[0]).collect();
        let p = dynamics.mass_matrix(&q) * DVector::from_iterator(n, joints.iter().map(|j| j.velocity[0]));
        DVector::from_iterator(2 * n, q.into_iter().chain(p.iter().copied()))
    };
    let mut derivative = DMatrix::zeros(2 * n, 2 * n);
    for k in 0..2 * n {
        let reach = 1e-3;
        let mut at = |factor: f64| {
            let mut y = start.clone();
            y[k] += factor * reach;
            step(&y)
        };
        let odd = [1.0, 2.0, 3.0].map(|f| at(f) - at(-f));
        derivative.set_column(k, &((&odd[0] * 45.0 - &odd[1] * 9.0 + &odd[2]) / (60.0 * reach)));
    }
    let mut omega = DMatrix::zeros(2 * n, 2 * n);
    for i in 0..n {
        omega[(i, n + i)] = 1.0;
        omega[(n + i, i)] = -1.0;
    }
    let left = derivative.transpose() * &omega * derivative - omega;
    largest(left.iter().copied())
}

#[test]
fn galerkin_holds_energy_over_a_long_run_and_runge_kutta_does_not() {
    let mut scene = alternating(2);
    scene.initial[1].position = vec![0.05];
    let system = compile(&scene);
    let start = energy::energy(&system, &system.initial).total();
    let drift = |text: &str, step: f64, steps: usize| {
        let mut engine = engines::build(&Spec::parse(text).unwrap(), &system, step).unwrap();
        let mut state = system.initial.clone();
        let mut worst = [0.0f64; 2];
        for n in 0..steps {
            engine.step().unwrap();
            engine.write_state(&mut state);
            let error = (energy::energy(&system, &state).total() - start).abs() / system.energy_scale;
            worst[2 * n / steps] = worst[2 * n / steps].max(error);
        }
        worst
    };
    let [first, last] = drift("galerkin:stages=8", 0.04, 25_000);
    println!("galerkin {first:.1e} {last:.1e}");
    // 1000 s; measured 2.3e-13 and 5.1e-13, a random walk of roundoff: its sign changes with the step
    assert!(first > 0.0 && first <= 6e-13 && last <= 1.2e-12, "{first:e} {last:e}");
    let [first, last] = drift("rk4", 0.01, 100_000);
    println!("rk4 {first:.1e} {last:.1e}");
    // measured 4.4e-5 and 9.2e-5: in proportion to time
    assert!(last > 1.8 * first && last > 3e-5, "{first:e} {last:e}");
}

/// A joint spring is the same as the spring of the closed form: `theta = theta0 cos(omega t)` without gravity.
#[test]
fn a_joint_spring_swings_with_the_frequency_of_the_textbook() {
    let mut scene = chain(&[(model::JointKind::Revolute, Vector3::y())]);
    scene.gravity = Vector3::zeros();
    scene.initial[0].position = vec![0.7];
    let mut system = compile(&scene);
    let (stiffness, rest) = (3.0, 0.2);
    system.parts.joint_springs.push(JointSpring { body: 0, stiffness, damping: 0.0, rest });
    let inertia = rod().inertia[(1, 1)] + 0.15 * 0.15;
    let expected = rest + (0.7 - rest) * ((stiffness / inertia).sqrt() * 1.5).cos();
    for text in ["reference", "galerkin:stages=6", "dop853:tolerance=1e-13"] {
        let state = run_engine(text, &system, 0.05, 30);
        let mut joints = [JointCoordinates::default()];
        joint_coordinates(&system, &state, &mut joints);
        let error = joints[0].position[0] - expected;
        println!("{text} {error:.1e}");
        // measured 6.6e-15, 7.5e-16 and 4.7e-14
        assert!(error.abs() <= 1.2e-13, "{text}: {error:e}");
    }
}

#[test]
fn what_the_joint_coordinates_do_not_hold_is_refused_by_name() {
    let system = shipped("four_bar");
    for name in ["galerkin", "dop853", "rk4", "semi_implicit_euler", "explicit_euler"] {
        let refusal = engines::build(&Spec::parse(name).unwrap(), &system, 1e-3).err().unwrap();
        assert_eq!(refusal.to_string(), format!("engine '{name}' does not support loops"));
    }
    assert!(system.bodies.iter().all(|b| b.joint.kind == JointKind::Revolute));
}

/// Steps of 2 to 4 rad, where the rounds are no contraction at every start and Newton's method takes over: the stages lie on
/// the motion, and are solved to roundoff, for a step back leads to where the step came from.
#[test]
fn steps_of_several_radians_find_their_stages() {
    // Measured errors: 0.26, 0.29, 6.8e-3, 4.8e-10; 5.3e-3, 1.2e-3, 1.3e-3, 4.9e-5.
    let cases = [
        ("heavy_top", 2, 20, 0.6),
        ("heavy_top", 3, 20, 0.6),
        ("heavy_top", 4, 20, 1.5e-2),
        ("heavy_top", 8, 20, 1.2e-9),
        ("chain_10", 3, 6, 1.2e-2),
        ("chain_10", 4, 7, 3e-3),
        ("chain_10", 6, 10, 3e-3),
        ("chain_10", 8, 10, 1.2e-4),
    ];
    for (name, stages, steps, bound) in cases {
        let (system, text) = (shipped(name), format!("galerkin:stages={stages}"));
        let reference = &trajectory(&system, &[0.1 * steps as f64]).unwrap().states[0];
        let there = run_engine(&text, &system, 0.1, steps);
        let error = distance(&there, reference);
        let back = run_engine(&text, &turned_round(&system, &there), 0.1, 1);
        let missed = distance(&back, &run_engine(&text, &system, 0.1, steps - 1));
        println!("{text} {name} {error:.1e} {missed:.1e}");
        // Of the way there and back measured 2.7e-16 to 5.0e-13.
        assert!(error <= bound && missed <= 1.5e-12, "{text} {name}: {error:e} {missed:e}");
    }
}

/// A step that is far too long ends with a message in words or with a finite figure, and the state stays where it was.
#[test]
fn stages_that_do_not_converge_are_an_error_and_change_nothing() {
    let cases = [(zoo(), 8, 5.0, 0), (shipped("heavy_top"), 2, 0.2, 0), (shipped("chain_10"), 2, 0.1, 5)];
    for (system, stages, step, good) in cases {
        let text = format!("galerkin:stages={stages}");
        let mut engine = engines::build(&Spec::parse(&text).unwrap(), &system, step).unwrap();
        (0..good).for_each(|_| engine.step().unwrap());
        let (mut before, mut after) = (system.initial.clone(), system.initial.clone());
        engine.write_state(&mut before);
        let failure = engine.step().unwrap_err().to_string();
        engine.write_state(&mut after);
        println!("{failure}");
        assert!(failure.starts_with(&format!("t = {:.6} s: ", good as f64 * step)), "{failure}");
        assert!(
            failure.contains("the stages run away") && failure.contains(&format!("a step of {step} s")),
            "{failure}"
        );
        assert!(!failure.contains("NaN") && !failure.contains("inf"), "{failure}");
        assert_eq!(before, after);
        assert_eq!(engine.step().unwrap_err().to_string(), failure);
    }
}
