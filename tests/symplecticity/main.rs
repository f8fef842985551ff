//! One step of every variational method is a symplectic map of joint coordinates and conjugate momenta:
//! `A^T Omega A = Omega` for its derivative `A` (Marsden and West 2001, section 2.1; on the constraint manifold 3.5).
//!
//! The derivative is taken by central differences of the engine's step, which knows nothing of it.

mod chart;
mod runge_kutta;

use std::path::PathBuf;

use chart::Chart;
use nalgebra::{Isometry3, Vector3};
use rattlebench::discrete::solve::central_difference;
use rattlebench::discrete::structure::{canonical_form, join, split};
use rattlebench::discrete::{Matrix, Vector};
use rattlebench::engines::{self, Spec};
use rattlebench::mechanics::coordinates::{JointCoordinates, forward_kinematics, joint_coordinates};
use rattlebench::mechanics::{Body, Joint, JointKind, Mobility, Parts, State, System, energy};
use rattlebench::model::Scene;

/// s
const STEP: f64 = 0.01;

const METHODS: [&str; 6] =
    ["rattle:order=2", "rattle:order=4", "rattle:order=6", "rattle:order=8", "galerkin:stages=2", "galerkin:stages=4"];

fn step(method: &str, system: &System, state: &State, h: f64) -> State {
    let mut initial_coordinates = system.initial_coordinates.clone();
    joint_coordinates(system, state, &mut initial_coordinates);
    let from_here = System { initial: state.clone(), initial_coordinates, ..system.clone() };
    let mut engine = engines::build(&Spec::parse(method).unwrap(), &from_here, h).unwrap();
    engine.step().unwrap();
    let mut out = state.clone();
    engine.write_state(&mut out);
    out
}

/// How far a map is from symplectic at a state: the largest entry of `A^T Omega A - Omega`.
///
/// Coordinates and momenta are scaled by `theta_i = y_i`, `p_i = H_ii y'_i` with the mass matrix `H`, so that all `y` have
/// about the same size, and an entry of the defect that belongs to `i` and `j` is divided by `sqrt(H_ii H_jj)`.
struct Defect<'a> {
    map: &'a dyn Fn(&State) -> State,
    /// Charts at both ends of the step.
    here: Chart<'a>,
    there: Chart<'a>,
    start: Vector,
    /// `H_ii`, kg or kg m^2.
    scale: Vector,
}

impl<'a> Defect<'a> {
    fn new(system: &'a System, start: &State, map: &'a dyn Fn(&State) -> State) -> Defect<'a> {
        let (here, there) = (Chart::about(system, start), Chart::about(system, &map(start)));
        let theta = here.coordinates(start);
        let scale = here.mass_matrix(&theta).diagonal();
        let start = join(&theta, &here.momenta(&theta, start).component_div(&scale));
        Defect { map, here, there, start, scale }
    }

    /// By differences of the given reach, in rad and m, and rad/s and m/s for the momenta. A long reach errs by its sixth
    /// power, a short one by roundoff.
    fn at(&self, reach: f64) -> f64 {
        let (scale, d) = (&self.scale, self.scale.len());
        let derivative = central_difference(&self.start, reach, |y| {
            let (theta, rate) = split(y);
            let end = (self.map)(&self.here.state_at_momenta(&theta, &rate.component_mul(scale)));
            let theta = self.there.coordinates(&end);
            Ok(join(&theta, &self.there.momenta(&theta, &end).component_div(scale)))
        })
        .unwrap();
        let mut form = canonical_form(d);
        for i in 0..2 * d {
            form.row_mut(i).scale_mut(scale[i % d]);
        }
        let left = derivative.transpose() * &form * derivative - form;
        assert!(left.iter().all(|x| x.is_finite()));
        left.map_with_location(|i, j, value| value / (scale[i % d] * scale[j % d]).sqrt()).amax()
    }

    /// The smallest over several reaches: what is the map's own does not depend on them.
    fn smallest(&self) -> f64 {
        [1e-2, 4e-3, 1.6e-3, 6.4e-4].map(|reach| self.at(reach)).into_iter().fold(f64::INFINITY, f64::min)
    }
}

/// Every shipped scene that is made of joints and gravity alone.
fn shipped() -> Vec<System> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("models");
    let mut systems = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path().join("scene.json");
        let scene = Scene::load(path).unwrap();
        let forces = scene.springs.is_empty() && scene.drives.is_empty();
        if forces && scene.loops.is_empty() && scene.model.joints.iter().all(|j| j.mimic.is_none()) {
            systems.push(System::compile(&scene).unwrap());
        }
    }
    systems.retain(|s| s.bodies.iter().all(|b| b.joint.damping == 0.0));
    systems
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
    let energy_scale = energy::scale(&bodies, &gravity, &initial);
    System {
        name: "five_links".into(),
        bodies,
        gravity,
        initial,
        initial_coordinates,
        energy_scale,
        floating_base: None,
        parts: Parts::default(),
        mobility: Mobility { tree: kinds.iter().map(|kind| kind.degrees_of_freedom()).sum(), ..Mobility::default() },
    }
}

/// The systems, each in a state 0.6 s into its motion.
fn moving() -> Vec<(System, State)> {
    let systems = shipped().into_iter().chain([five_links()]);
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

#[test]
fn one_step_of_every_order_is_symplectic_and_one_of_runge_kutta_is_not() {
    let systems = moving();
    assert!(systems.len() >= 10);
    for (system, state) in &systems {
        let defect = |map: &dyn Fn(&State) -> State| Defect::new(system, state, map).smallest();
        let runge_kutta = defect(&|s| runge_kutta::step(system, s, STEP));
        let found = METHODS.map(|method| defect(&|s| step(method, system, s, STEP)));
        println!("{:16} {} Runge-Kutta {runge_kutta:.1e}", system.name, found.map(|d| format!("{d:.1e}")).join(" "));
        let worst = found.into_iter().fold(0.0, f64::max);
        // measured 6e-14 (cart_pole) to 1.0e-10 (arm_6), all of it from the differences
        assert!(worst <= 2e-10, "{}: {found:?}", system.name);
        // measured 8.6e2 (pendulum) to 4e7 (chain_10)
        assert!(runge_kutta >= 4e2 * worst, "{}: {runge_kutta:e}", system.name);
    }
}

/// What is left of RATTLE's defect is the error of the differences: it falls with the sixth power of their reach, where
/// that of Runge-Kutta stays.
#[test]
fn the_defect_falls_with_the_reach_of_the_differences() {
    let system = five_links();
    let ratio = |map: &dyn Fn(&State) -> State| {
        let defect = Defect::new(&system, &system.initial, map);
        defect.at(1e-2) / defect.at(5e-3)
    };
    let rattle = METHODS.map(|method| ratio(&|s| step(method, &system, s, STEP)));
    let runge_kutta = ratio(&|s| runge_kutta::step(&system, s, STEP));
    println!("{rattle:?} {runge_kutta}");
    // measured 62.1 to 62.5, and 1.2
    assert!(rattle.iter().all(|r| (55.0..70.0).contains(r)), "{rattle:?}");
    assert!((0.8..1.5).contains(&runge_kutta), "{runge_kutta}");
}

/// What the test rests on: rates and positions of a chart belong together, and a state is found again.
#[test]
fn the_rates_of_a_chart_are_the_rates_of_its_coordinates() {
    for (system, start) in moving() {
        let chart = Chart::about(&system, &system.initial);
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
        let back = chart::twists(&chart.state_at_momenta(&theta, &p)) - chart::twists(&state);
        let errors = [(poses - velocity).amax(), (again - theta).amax(), back.amax()];
        println!("{:16} {errors:?}", system.name);
        // measured 5.8e-13, 5.0e-16, 3.0e-14
        assert!(errors[0] <= 1.5e-12 && errors[1] <= 1.5e-15 && errors[2] <= 1e-13, "{}: {errors:?}", system.name);
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
