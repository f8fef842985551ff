//! One step of every variational method is a symplectic map of joint coordinates and conjugate momenta:
//! `A^T Omega A = Omega` for its derivative `A` (Marsden and West 2001, section 2.1; on the constraint manifold 3.5).
//!
//! The derivative is taken by central differences of the engine's step, which knows nothing of it.

mod runge_kutta;

use nalgebra::{Isometry3, Vector3};
use rattlebench::discrete::solve::central_difference;
use rattlebench::discrete::{Matrix, Vector};
use rattlebench::engines::{self, Spec};
use rattlebench::measure::structure::{Differenced, Failure, PhaseChart, StateMap, defect_by, symplecticity, twists};
use rattlebench::mechanics::coordinates::{JointCoordinates, forward_kinematics};
use rattlebench::mechanics::{
    Anchor, Body, Drive, Joint, JointKind, JointSpring, Mobility, Parts, PointSpring, State, System, energy,
};
use rattlebench::model::Scene;

use crate::common::{compile, shipped_scenes};

/// s
const STEP: f64 = 0.01;

const METHODS: [&str; 14] = [
    "rattle:order=2",
    "rattle:order=4",
    "rattle:order=6",
    "rattle:order=8",
    "rattle:rotation=splitting",
    "rattle:rotation=cayley",
    "rattle:method=euler_a",
    "rattle:method=euler_b",
    "rattle:method=shake",
    "rattle:method=lobatto,stages=3",
    "rattle:method=lobatto,stages=4",
    "rattle:method=lobatto,stages=5",
    "galerkin:stages=2",
    "galerkin:stages=4",
];

/// One step of a new engine from the system's initial state.
///
/// # Errors
/// A step that does not converge, as far from the state as the longest differences reach.
fn first_step(method: &str, system: &System, h: f64) -> Result<State, Failure> {
    let mut engine = engines::build(&Spec::parse(method).unwrap(), system, h).unwrap();
    engine.step().map_err(|failure| Failure::Step(failure.to_string()))?;
    let mut out = system.initial.clone();
    engine.write_state(&mut out);
    Ok(out)
}

fn step(method: &str, system: &System, state: &State, h: f64) -> State {
    first_step(method, &System { initial: state.clone(), ..system.clone() }, h).unwrap()
}

fn defect(system: &System, state: &State, map: &StateMap) -> Differenced {
    symplecticity(system, state, 0.0, map).unwrap()
}

/// Every shipped scene that is made of joints and gravity alone.
fn of_joints_alone() -> Vec<System> {
    let (taken, left): (Vec<Scene>, Vec<Scene>) = shipped_scenes().into_iter().partition(|scene| {
        let forces = !scene.springs.is_empty() || !scene.drives.is_empty();
        let joints = &scene.model.joints;
        !forces && scene.loops.is_empty() && joints.iter().all(|j| j.mimic.is_none() && j.damping == 0.0)
    });
    let left: Vec<&str> = left.iter().map(|scene| scene.name.as_str()).collect();
    let expected = ["bricard", "damped_pendulum", "driven_arm", "four_bar", "gripper", "hung_plate"];
    assert_eq!(left, [&expected[..], &["ladder", "slider_crank", "stiff_joint"]].concat());
    taken.iter().map(compile).collect()
}

/// Five links in a row on joints of every kind.
fn five_links() -> System {
    let kinds =
        [JointKind::Revolute, JointKind::Spherical, JointKind::Prismatic, JointKind::Planar, JointKind::Floating];
    let (mut bodies, mut initial_coordinates) = (Vec::new(), Vec::new());
    for (i, kind) in kinds.into_iter().enumerate() {
        let turn = |k: f64| Vector3::new((k * i as f64).sin(), 0.7, (k + i as f64).cos());
        let in_parent = Isometry3::new(if i == 0 { Vector3::zeros() } else { Vector3::new(0.2, 0.05, 0.0) }, turn(1.3));
        let in_child = Isometry3::new(Vector3::new(-0.2, 0.0, 0.04), turn(2.1));
        let parent = i.checked_sub(1);
        let joint = Joint { name: format!("joint_{i}"), kind, parent, in_parent, in_child, damping: 0.0 };
        let (mass, inertia) = (1.0 + 0.2 * i as f64, Vector3::new(0.008, 0.015, 0.02));
        bodies.push(Body { name: format!("link_{i}"), mass, inertia, joint });
        let mut theta = JointCoordinates::default();
        for k in 0..kind.degrees_of_freedom() {
            theta.position[k] = 0.4 * (k as f64 + 1.7 * i as f64).sin();
            theta.velocity[k] = 1.5 * (2.0 * k as f64 + i as f64).cos();
        }
        initial_coordinates.push(theta);
    }
    let initial = forward_kinematics(&bodies, &initial_coordinates);
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    let mut system = System {
        name: "five_links".into(),
        bodies,
        gravity,
        initial,
        initial_coordinates,
        energy_scale: 1.0,
        floating_base: None,
        parts: Parts::default(),
        mobility: Mobility { tree: kinds.iter().map(|kind| kind.degrees_of_freedom()).sum(), ..Mobility::default() },
    };
    system.energy_scale = energy::scale(&system);
    system
}

/// The systems, each in a state 0.6 s into its motion.
fn moving() -> Vec<(System, State)> {
    let systems = of_joints_alone().into_iter().chain([five_links()]);
    systems
        .map(|system| {
            let mut state = system.initial.clone();
            for _ in 0..60 {
                state = step("rattle:order=8", &system, &state, STEP);
            }
            assert!(energy::energy(&system, &state).kinetic > 1e-3 * system.energy_scale, "{}", system.name);
            (system, state)
        })
        .collect()
}

/// What roundoff does to differences. Where there is one freedom, the estimate comes from one number and is smaller by chance: of
/// 40 starts of the pendulum it has 7e-14 to 3.6e-12.
const ROUNDOFF: f64 = 3.6e-12;

#[test]
fn one_step_of_every_order_is_symplectic_and_one_of_runge_kutta_is_not() {
    let systems = moving();
    assert!(systems.len() >= 10);
    for (system, state) in &systems {
        let runge_kutta = defect(system, state, &|s| Ok(runge_kutta::step(system, &s.initial, STEP)));
        let found = METHODS.map(|method| defect(system, state, &|s| first_step(method, s, STEP)));
        let words = |d: Differenced| format!("{:.1e} ± {:.1e}", d.defect, d.error);
        println!("{:16} {} Runge-Kutta {}", system.name, found.map(words).join(", "), words(runge_kutta));
        for d in found {
            // measured at most 3.2e-12 in 40 starts of the pendulum
            assert!(d.defect <= 2.0 * d.error.max(ROUNDOFF), "{}: {d:?}", system.name);
            // measured at most 1.1e-9 (chain_10)
            assert!(d.error <= 2.5e-9, "{}: {d:?}", system.name);
        }
        // measured 103 (pendulum, 3.7e-10 to 4.0e-10 in 40 starts) to 1.3e6 (chain_10)
        assert!(runge_kutta.defect >= 40.0 * runge_kutta.error.max(ROUNDOFF), "{}: {runge_kutta:?}", system.name);
    }
}

/// Five links with springs in a hinge and a slider, and a drive in each.
fn sprung_and_driven(damping: f64) -> System {
    let mut system = five_links();
    let spring = |body, stiffness, rest| JointSpring { body, stiffness, damping, rest };
    system.parts.joint_springs = vec![spring(0, 40.0, 0.2), spring(2, 900.0, -0.1)];
    let drive = |body, amplitude| Drive { body, effort: 0.5, amplitude, angular_frequency: 20.0, phase: 0.3 };
    system.parts.drives = vec![drive(0, 2.0), drive(2, -3.0)];
    system
}

#[test]
fn springs_and_drives_leave_a_step_symplectic_and_dampers_do_not() {
    let defect =
        |system: &System, method: &str| defect(system, &system.initial, &|from| first_step(method, from, STEP));
    let system = sprung_and_driven(0.0);
    // The other methods know neither springs nor drives.
    let found: Vec<Differenced> = METHODS[..6].iter().map(|method| defect(&system, method)).collect();
    let damped = defect(&sprung_and_driven(0.01), METHODS[0]);
    println!("{found:?} damped {damped:?}");
    // measured 1.0e-9 and 1.4e-3
    assert!(found.iter().all(|d| d.defect <= d.error && d.error <= 2.5e-9), "{found:?}");
    assert!(damped.defect > 1e-5 && damped.defect > 100.0 * damped.error, "{damped:?}");
}

/// Five links with springs between points, one of them without a rest length.
fn on_point_springs(stiffness: f64, damping: f64) -> System {
    let mut system = five_links();
    let at = |body, point: [f64; 3]| Anchor { body, point: Vector3::from(point) };
    let spring = |from, to, rest_length| PointSpring { from, to, stiffness, damping, rest_length };
    system.parts.point_springs = vec![
        spring(at(None, [0.2, 0.3, 0.4]), at(Some(2), [0.15, 0.02, 0.01]), 0.3),
        spring(at(Some(0), [0.1, 0.05, 0.0]), at(Some(4), [-0.1, 0.0, 0.03]), 0.2),
        spring(at(Some(1), [0.0, 0.1, 0.0]), at(Some(3), [0.05, 0.0, 0.0]), 0.0),
    ];
    system
}

#[test]
fn springs_between_points_leave_a_step_symplectic_and_dampers_do_not() {
    let defect =
        |system: &System, method: &str| defect(system, &system.initial, &|from| first_step(method, from, STEP));
    for stiffness in [60.0, 600.0] {
        let found: Vec<Differenced> =
            METHODS[..6].iter().map(|m| defect(&on_point_springs(stiffness, 0.0), m)).collect();
        let damped = defect(&on_point_springs(stiffness, 1.0), METHODS[0]);
        println!("{found:?} damped {damped:?}");
        // measured defects up to 5.7e-11 and errors up to 1.1e-9
        assert!(found.iter().all(|d| d.defect <= d.error && d.error <= 2.5e-9), "{found:?}");
        // measured 0.15 and 0.17
        assert!(damped.defect > 0.05 && damped.defect > 100.0 * damped.error, "{damped:?}");
    }
}

/// What is left of RATTLE's defect is the error of the differences: it falls with the sixth power of their reach, where
/// that of Runge-Kutta stays.
#[test]
fn the_defect_falls_with_the_reach_of_the_differences() {
    let system = five_links();
    let ratio = |map: &StateMap| {
        let at = |reach| defect_by(&system, &system.initial, 0.0, reach, map).unwrap().amax();
        at(1e-2) / at(5e-3)
    };
    let rattle = METHODS.map(|method| ratio(&|s| first_step(method, s, STEP)));
    let runge_kutta = ratio(&|s| Ok(runge_kutta::step(&system, &s.initial, STEP)));
    println!("{rattle:?} {runge_kutta}");
    // measured 62.1 to 62.5, and 1.2
    assert!(rattle.iter().all(|r| (55.0..70.0).contains(r)), "{rattle:?}");
    assert!((0.8..1.5).contains(&runge_kutta), "{runge_kutta}");
}

/// What the test rests on: rates and positions of a chart belong together, and a state is found again.
#[test]
fn the_rates_of_a_chart_are_the_rates_of_its_coordinates() {
    for (system, start) in moving() {
        let chart = PhaseChart::about(&system, &system.initial);
        let theta = chart.coordinates(&start);
        let d = chart.dimension();
        let rate = Vector::from_fn(d, |i, _| (1.0 + i as f64).sin());
        let state = chart.state(&theta, &rate);
        let poses = central_difference(&Vector::zeros(1), 1e-3, |t| {
            let moved = chart.state(&(&theta + &rate * t[0]), &rate);
            Ok(poses(&moved))
        })
        .unwrap();
        let velocity: Matrix = pose_rates(&state);
        let again = chart.coordinates(&state);
        let p = chart.momenta(&theta, &state);
        let rates = chart.mass_matrix(&theta).cholesky().unwrap().solve(&p);
        let back = twists(&chart.state(&theta, &rates)) - twists(&state);
        let errors = [(poses - velocity).amax(), (again - theta).amax(), back.amax()];
        println!("{:16} {errors:?}", system.name);
        // measured 1.9e-12, 5.0e-16, 1.1e-13
        assert!(errors[0] <= 4e-12 && errors[1] <= 1.5e-15 && errors[2] <= 3e-13, "{}: {errors:?}", system.name);
    }
}

/// Positions and the entries of the attitude matrices.
fn poses(state: &State) -> Vector {
    let rows = state.bodies.iter().flat_map(|b| {
        let r = b.attitude.to_rotation_matrix().into_inner();
        b.position.iter().chain(r.iter()).copied().collect::<Vec<_>>()
    });
    Vector::from_vec(rows.collect())
}

fn pose_rates(state: &State) -> Matrix {
    let rows = state.bodies.iter().flat_map(|b| {
        let r = b.angular_velocity.cross_matrix() * b.attitude.to_rotation_matrix().into_inner();
        b.velocity.iter().chain(r.iter()).copied().collect::<Vec<_>>()
    });
    let all: Vec<f64> = rows.collect();
    Matrix::from_vec(all.len(), 1, all)
}

/// The negative control is the same motion: it agrees with order 8 to its own accuracy.
#[test]
fn the_runge_kutta_step_follows_the_same_motion() {
    for (system, state) in moving() {
        let error = |h: f64| {
            let by = [runge_kutta::step(&system, &state, h), step("rattle:order=8", &system, &state, h)];
            (poses(&by[0]) - poses(&by[1])).amax()
        };
        let (error, ratio) = (error(STEP), error(STEP) / error(0.5 * STEP));
        println!("{:16} {error:.1e} {ratio:.1}", system.name);
        // measured at most 2.9e-5 (heavy_top), and ratios of 25 to 38: the error of one step is of order 5
        assert!(error <= 8e-5 && (20.0..45.0).contains(&ratio), "{}: {error:e} {ratio}", system.name);
    }
}
