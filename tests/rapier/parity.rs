//! What rapier holds is our system: its state, its masses, its forces and its joints.

use nalgebra::{DVector, Vector3};
use rattlebench::engines::{self, Held};
use rattlebench::mechanics::{Drive, JointSpring, State, System, energy};

use crate::forward_dynamics::{Constraint, accelerations, velocities};
use crate::runs::{after, difference, spec};
use crate::scenes;

const IMPULSE: &str = "rapier:precision=f64";
const MULTIBODY: &str = "rapier:precision=f64,joints=multibody";
/// One substep, with impulses that are solved to the end and joints that do not yield.
const IMPULSE_CONVERGED: &str = "rapier:precision=f64,substeps=1,iterations=3000,stabilization=0,softness_hz=1e12";
const MULTIBODY_ONE_SUBSTEP: &str = "rapier:precision=f64,joints=multibody,substeps=1";

fn held(text: &str, system: &System) -> Held {
    engines::held(&spec(text), system, 1e-3).expect("rapier takes the system")
}

#[test]
fn rapier_starts_in_our_state_to_the_precision_of_its_floats() {
    for (text, bound) in [
        (IMPULSE, 4e-16),                                  // measured 1.2e-16
        (MULTIBODY, 5e-15),                                // measured 1.9e-15
        ("rapier:precision=f32", 3e-7),                    // measured 1.3e-7
        ("rapier:precision=f32,joints=multibody", 2.5e-6), // measured 1.0e-6
    ] {
        for system in scenes::all_and_shipped() {
            let error = difference(&held(text, &system).state, &system.initial);
            assert!(error <= bound, "{text}, {}: {error:e}", system.name);
        }
    }
}

/// What momenta are measured by: of the whole mass, and of it turning about the world's origin, with the energy scale.
fn momentum_scales(system: &System) -> [f64; 2] {
    let bodies = || system.bodies.iter().zip(&system.initial.bodies);
    let mass: f64 = bodies().map(|(body, _)| body.mass).sum();
    let inertia: f64 = bodies().map(|(body, s)| body.mass * s.position.norm_squared() + body.inertia.max()).sum();
    [mass, inertia].map(|m| (2.0 * m * system.energy_scale).sqrt())
}

/// Linear momentum, then angular momentum about the world's origin.
fn total_momentum(system: &System, state: &State) -> [Vector3<f64>; 2] {
    let mut total = [Vector3::zeros(); 2];
    for (body, s) in system.bodies.iter().zip(&state.bodies) {
        let spin = s.attitude * body.inertia.component_mul(&s.attitude.inverse_transform_vector(&s.angular_velocity));
        total[0] += body.mass * s.velocity;
        total[1] += s.position.cross(&(body.mass * s.velocity)) + spin;
    }
    total
}

/// The largest relative difference of masses, energies and momenta between a system and what rapier holds.
fn mechanical_difference(system: &System, held: &Held) -> f64 {
    let theirs = held.as_system(system);
    let (e, f) = (energy::energy(system, &system.initial), energy::energy(&theirs, &held.state));
    let (p, q) = (total_momentum(system, &system.initial), total_momentum(&theirs, &held.state));
    let scales = momentum_scales(system);
    let mut worst = [
        (e.kinetic - f.kinetic).abs() / system.energy_scale,
        (e.potential - f.potential).abs() / system.energy_scale,
        (theirs.energy_scale / system.energy_scale - 1.0).abs(),
        (p[0] - q[0]).norm() / scales[0],
        (p[1] - q[1]).norm() / scales[1],
    ]
    .into_iter()
    .fold(0.0, f64::max);
    for (ours, theirs) in system.bodies.iter().zip(&held.bodies) {
        assert_eq!((theirs.com, theirs.axes.angle()), (Vector3::zeros(), 0.0), "{}", ours.name);
        let mass = (theirs.mass / ours.mass).add_scalar(-1.0).amax();
        let inertia = theirs.inertia.component_div(&ours.inertia).add_scalar(-1.0).amax();
        worst = worst.max(mass).max(inertia);
    }
    worst
}

#[test]
fn masses_energies_and_momenta_that_rapier_holds_are_ours() {
    for system in scenes::all_and_shipped() {
        for text in [IMPULSE, MULTIBODY] {
            let error = mechanical_difference(&system, &held(text, &system));
            // measured 2.5e-15
            assert!(error <= 6e-15, "{text}, {}: {error:e}", system.name);
        }
    }
}

#[test]
fn an_inertia_that_is_one_percent_off_is_seen() {
    for system in scenes::all_and_shipped() {
        let mut off = system.clone();
        off.bodies[0].inertia *= 1.01;
        for text in [IMPULSE, MULTIBODY] {
            assert!(mechanical_difference(&off, &held(text, &system)) > 1e-3, "{text}, {}", system.name);
        }
    }
}

/// `(v1 - v0) / h` of one step, extrapolated to `h = 0` from `h`, `h/2` and `h/4`.
fn measured_accelerations(text: &str, system: &System, h: f64) -> DVector<f64> {
    let quotient = |h: f64| (velocities(&after(text, system, h, 1)) - velocities(&after(text, system, h, 0))) / h;
    (quotient(h) - 6.0 * quotient(0.5 * h) + 8.0 * quotient(0.25 * h)) / 3.0
}

/// Difference between the accelerations that rapier shows and those of the dense system, relative to these or, where
/// they are small, to 1 m/s^2 and 1 rad/s^2.
fn acceleration_error(text: &str, rapier: &System, dense: &System, h: f64, constraint: Constraint) -> f64 {
    let exact = accelerations(dense, &dense.initial, constraint);
    (measured_accelerations(text, rapier, h) - &exact).norm() / exact.norm().max(1.0)
}

fn constraint_of(text: &str) -> Constraint {
    if text.contains("multibody") { Constraint::Exact } else { Constraint::Frozen }
}

#[test]
fn initial_accelerations_are_those_of_the_dense_equations_of_motion() {
    for system in scenes::all_and_shipped().iter().map(scenes::softened) {
        // A spring's error has the scale of its period.
        let impulse_step = if system.parts.joint_springs.is_empty() { 1e-3 } else { 2e-4 };
        for (text, h) in [(IMPULSE_CONVERGED, impulse_step), (MULTIBODY_ONE_SUBSTEP, 1e-4)] {
            for (name, system) in [("moving", system.clone()), ("at rest", scenes::at_rest(&system))] {
                let error = acceleration_error(text, &system, &system, h, constraint_of(text));
                // measured 1.2e-8 (stiff_joint, 3.3e-9 others) with impulse joints, 3.9e-10 with multibody joints, 3e-14 of these at rest
                assert!(error <= 2.5e-8, "{text}, {} {name}: {error:e}", system.name);
            }
        }
    }
}

#[test]
fn dampers_add_their_force_to_the_initial_accelerations() {
    for system in scenes::all() {
        let damped = scenes::damped(&system, 0.02);
        for (text, h) in [(IMPULSE_CONVERGED, 1e-3), (MULTIBODY_ONE_SUBSTEP, 1e-4)] {
            let error = acceleration_error(text, &damped, &damped, h, constraint_of(text));
            // measured 2.9e-9
            assert!(error <= 8e-9, "{text}, {}: {error:e}", system.name);
        }
    }
}

#[test]
fn springs_and_drives_in_joints_add_their_efforts_to_the_initial_accelerations() {
    for system in scenes::all() {
        let sprung = scenes::sprung_and_driven(&system);
        for (text, h) in [(IMPULSE_CONVERGED, 1e-3), (MULTIBODY_ONE_SUBSTEP, 1e-4)] {
            let error = acceleration_error(text, &sprung, &sprung, h, constraint_of(text));
            println!("{text}, {}: {error:.1e}", system.name);
            // measured 1.1e-8 with impulse joints, 3.8e-10 with multibody joints
            assert!(error <= 2.5e-8, "{text}, {}: {error:e}", system.name);
            if sprung.parts.kinds().next().is_none() {
                continue;
            }
            let mut softer = sprung.clone();
            softer.parts.joint_springs.iter_mut().for_each(|spring| spring.stiffness *= 0.99);
            let mut later = sprung.clone();
            later.parts.drives.iter_mut().for_each(|drive| drive.phase += 0.01);
            for wrong in [softer, later] {
                let seen = acceleration_error(text, &sprung, &wrong, h, constraint_of(text));
                assert!(seen > 1e-5, "{text}, {}: {seen:e}", system.name);
            }
        }
    }
}

#[test]
fn springs_between_points_add_their_forces_to_the_initial_accelerations() {
    for system in scenes::all() {
        let hung = scenes::hung_on_springs(&system);
        let error = acceleration_error(IMPULSE_CONVERGED, &hung, &hung, 1e-3, Constraint::Frozen);
        println!("{}: {error:.1e}", system.name);
        // measured 3.0e-9
        assert!(error <= 8e-9, "{}: {error:e}", system.name);
        let mut longer = hung.clone();
        longer.parts.point_springs.iter_mut().for_each(|spring| spring.rest_length += 0.001);
        let seen = acceleration_error(IMPULSE_CONVERGED, &hung, &longer, 1e-3, Constraint::Frozen);
        assert!(seen > 1e-5, "{}: {seen:e}", system.name);
    }
}

/// A slider on a spring, against `x'' = -w^2 x - 2 d x' + (u/m) sin(W t)`: rapier's spring is implicit, of order one.
#[test]
fn a_damped_and_driven_oscillator_converges_to_its_closed_form() {
    let mut system = scenes::named("cart-pole");
    system.bodies.truncate(1);
    system.initial.bodies.truncate(1);
    system.initial_coordinates.truncate(1);
    system.gravity = Vector3::zeros();
    let (m, k, c, u, w) = (system.bodies[0].mass, 40.0, 0.8, 2.0, 11.0_f64);
    system.parts.joint_springs = vec![JointSpring { body: 0, stiffness: k, damping: c, rest: 0.1 }];
    system.parts.drives = vec![Drive { body: 0, effort: 0.0, amplitude: u, angular_frequency: w, phase: 0.0 }];
    let start = &system.initial_coordinates[0];
    let (x0, v0) = (start.position[0] - 0.1, start.velocity[0]);
    // x = a sin(w t) + b cos(w t) + exp(-d t) (p cos(s t) + q sin(s t))
    let (r, d) = (k - m * w * w, 0.5 * c / m);
    let (a, b) = (u * r / (r * r + c * c * w * w), -u * c * w / (r * r + c * c * w * w));
    let s = (k / m - d * d).sqrt();
    let p = x0 - b;
    let q = (v0 - a * w + d * p) / s;
    let exact =
        |t: f64| a * (w * t).sin() + b * (w * t).cos() + (-d * t).exp() * (p * (s * t).cos() + q * (s * t).sin()) + 0.1;
    let axis = system.bodies[0].joint.in_parent.rotation * Vector3::z();
    let error = |text: &str, steps: u32| {
        let state = after(text, &system, 1.0 / f64::from(steps), steps);
        let moved = (state.bodies[0].position - system.initial.bodies[0].position).dot(&axis);
        (moved + x0 + 0.1 - exact(1.0)).abs()
    };
    assert!((exact(1.0) - exact(0.0)).abs() > 0.01);
    // measured 1.4e-3, 1.4e-3, 2.3e-7
    for (text, order, bound) in
        [(IMPULSE_CONVERGED, 1.0, 4e-3), (MULTIBODY_ONE_SUBSTEP, 1.0, 4e-3), ("rattle", 2.0, 6e-7)]
    {
        let text = text.replace("iterations=3000", "iterations=100");
        let (coarse, fine) = (error(&text, 1000), error(&text, 4000));
        let found = (coarse / fine).log(4.0);
        println!("{text}: {coarse:.1e} {fine:.1e} order {found:.2}");
        assert!(fine <= bound && (found - order).abs() <= 0.1, "{text}: {coarse:e} {fine:e}");
    }
}

#[test]
fn what_rapier_cannot_do_with_springs_is_said() {
    let refused =
        |text: &str, system: &System| engines::build(&spec(text), system, 1e-3).err().expect("refused").to_string();
    let system = scenes::named("chain");
    let mut wound = system.clone();
    wound.parts.joint_springs = vec![JointSpring { body: 0, stiffness: 1.0, damping: 0.0, rest: 5.0 }];
    assert!(refused(IMPULSE, &wound).contains("a motor knows angles modulo a turn"), "{}", refused(IMPULSE, &wound));
    assert!(engines::build(&spec(MULTIBODY), &wound, 1e-3).is_ok());
    let hung = scenes::hung_on_springs(&system);
    assert!(refused(MULTIBODY, &hung).contains("springs between points with joints=multibody"));
    let mut faint = system.clone();
    faint.parts.joint_springs = vec![JointSpring { body: 0, stiffness: 1e-16, damping: 0.0, rest: 0.0 }];
    assert!(refused(IMPULSE, &faint).ends_with("so weak a motor acts as a lock"));
}

#[test]
fn accelerations_see_one_percent_of_mass_and_inertia_and_two_millimetres_of_a_joint() {
    for system in scenes::all_and_shipped() {
        let mut heavy = system.clone();
        for body in &mut heavy.bodies {
            (body.mass, body.inertia.x) = (0.99 * body.mass, 1.01 * body.inertia.x);
        }
        let mut shifted = system.clone();
        for body in &mut shifted.bodies {
            body.joint.in_child.translation.vector += Vector3::new(0.002, 0.001, -0.001);
        }
        for (text, h) in [(IMPULSE_CONVERGED, 1e-3), (MULTIBODY_ONE_SUBSTEP, 1e-4)] {
            for wrong in [&heavy, &shifted] {
                let seen = acceleration_error(text, &system, wrong, h, constraint_of(text));
                let free = system.bodies.len() == 1 && std::ptr::eq(wrong, &shifted);
                // measured at least 7.4e-4
                assert!(free || seen > 5e-4, "{text}, {}: {seen:e}", system.name);
            }
        }
    }
}

#[test]
fn runs_converge_to_those_of_the_variational_core_at_first_order() {
    let time = 0.02;
    for system in scenes::all_and_shipped().iter().map(scenes::softened) {
        let exact = after("rattle", &system, time / 2000.0, 2000);
        for text in [IMPULSE_CONVERGED, MULTIBODY_ONE_SUBSTEP] {
            let text = text.replace("iterations=3000", "iterations=600");
            let error = |steps: u32| difference(&after(&text, &system, time / f64::from(steps), steps), &exact);
            let (coarse, fine) = (error(100), error(400));
            let order = (coarse / fine).log(4.0);
            // measured 5.6e-5, and 4.0e-4 with springs (driven_arm)
            let bound = if system.parts.joint_springs.is_empty() { 1.5e-4 } else { 1e-3 };
            assert!(fine <= bound, "{text}, {}: {fine:e}", system.name);
            assert!((order - 1.0).abs() <= 0.05, "{text}, {}: order {order}", system.name);
        }
    }
}
