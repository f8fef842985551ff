//! Kinetic and potential energy, and the scale that errors are divided by.

use nalgebra::Vector3;

use super::body::Body;
use super::coordinates::joint_coordinates;
use super::joint::JointCoordinates;
use super::path::path_lengths;
use super::state::State;
use super::system::System;

/// Energy of a state, J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy {
    pub kinetic: f64,
    /// Of gravity, zero at the world's origin, and of the springs, zero where they are at rest.
    pub potential: f64,
}

impl Energy {
    pub fn total(self) -> f64 {
        self.kinetic + self.potential
    }
}

/// `K = sum_b 1/2 m |v|^2 + 1/2 Omega . J Omega`, `U = -sum_b m g . x + sum 1/2 k Delta^2` over the springs in joints
/// (`Delta = theta - rest`) and between points (`Delta = distance - rest_length`).
///
/// A state does not tell how often a hinge has turned: the angle of a sprung hinge is taken within half a turn of the
/// spring's rest. Where one may wind up further, follow the run with a
/// [`CoordinateTracker`](super::coordinates::CoordinateTracker) and use [`energy_at_coordinates`].
pub fn energy(system: &System, state: &State) -> Energy {
    match joints_if_sprung(system, state) {
        Some(joints) => energy_at_coordinates(system, state, &nearest_to_rest(system, joints)),
        None => energy_at_coordinates(system, state, &[]),
    }
}

/// The same with the joints' coordinates given, angles unwrapped. They matter only to springs in joints: without these
/// the list may be empty.
pub fn energy_at_coordinates(system: &System, state: &State, joints: &[JointCoordinates]) -> Energy {
    energy_at_velocity_time(system, state, joints, 0.0)
}

/// The energy whose potential is taken where everything was `lag` seconds before, `U(q - lag v)`: for engines whose
/// positions and velocities belong to different times.
pub fn energy_at_velocity_time(system: &System, state: &State, joints: &[JointCoordinates], lag: f64) -> Energy {
    let potential =
        of_gravity(system, state, lag) + of_joint_springs(system, joints, lag) + of_point_springs(system, state, lag);
    Energy { kinetic: kinetic(&system.bodies, state), potential }
}

fn kinetic(bodies: &[Body], state: &State) -> f64 {
    bodies
        .iter()
        .zip(&state.bodies)
        .map(|(body, s)| {
            let omega = s.attitude.inverse_transform_vector(&s.angular_velocity);
            0.5 * body.mass * s.velocity.norm_squared() + 0.5 * omega.dot(&body.inertia.component_mul(&omega))
        })
        .sum()
}

fn of_gravity(system: &System, state: &State, lag: f64) -> f64 {
    let weighted: Vector3<f64> =
        system.bodies.iter().zip(&state.bodies).map(|(body, s)| body.mass * (s.position - lag * s.velocity)).sum();
    -system.gravity.dot(&weighted)
}

fn of_joint_springs(system: &System, joints: &[JointCoordinates], lag: f64) -> f64 {
    let springs = system.parts.joint_springs.iter();
    springs
        .map(|spring| {
            let joint = &joints[spring.body];
            0.5 * spring.stiffness * (joint.position[0] - lag * joint.velocity[0] - spring.rest).powi(2)
        })
        .sum()
}

fn of_point_springs(system: &System, state: &State, lag: f64) -> f64 {
    let springs = system.parts.point_springs.iter();
    springs
        .map(|spring| {
            let (line, rate) = spring.line(state);
            0.5 * spring.stiffness * ((line - lag * rate).norm() - spring.rest_length).powi(2)
        })
        .sum()
}

fn joints_if_sprung(system: &System, state: &State) -> Option<Vec<JointCoordinates>> {
    (!system.parts.joint_springs.is_empty()).then(|| {
        let mut joints = vec![JointCoordinates::default(); system.bodies.len()];
        joint_coordinates(system, state, &mut joints);
        joints
    })
}

/// Puts the angle of each sprung hinge within half a turn of the (last) spring's rest.
fn nearest_to_rest(system: &System, mut joints: Vec<JointCoordinates>) -> Vec<JointCoordinates> {
    use std::f64::consts::TAU;
    for spring in &system.parts.joint_springs {
        if let Some(k) = system.bodies[spring.body].joint.kind.angle_index() {
            let angle = &mut joints[spring.body].position[k];
            *angle += TAU * ((spring.rest - *angle) / TAU).round();
        }
    }
    joints
}

/// The yardstick of relative energy errors, a property of the scene alone, J: the largest of
///
/// - the initial kinetic energy,
/// - the initial energy of the springs,
/// - `sum_b m_b |g| d_b`, where `d_b` is the length of the path along the tree from the ground's joint to the body's
///   centre of mass,
/// - `sum (|effort| + |amplitude|) * 1` over the drives: the work that they do over one radian, or one metre, at full
///   effort.
///
/// A scene where all of them are zero but bodies fall is measured by the energy of its first second of free fall, and
/// one where nothing can happen by 1 J. [`System::energy_scale`] is not read.
pub fn scale(system: &System) -> f64 {
    let System { bodies, parts, gravity, initial, initial_coordinates, .. } = system;
    let mut potential = 0.0;
    for (body, path) in bodies.iter().zip(path_lengths(bodies)) {
        potential += body.mass * gravity.norm() * (path + body.joint.in_child.translation.vector.norm());
    }
    let springs = of_joint_springs(system, initial_coordinates, 0.0) + of_point_springs(system, initial, 0.0);
    let drives: f64 = parts.drives.iter().map(|drive| drive.effort.abs() + drive.amplitude.abs()).sum();
    let mass: f64 = bodies.iter().map(|b| b.mass).sum();
    let energies = [potential, kinetic(bodies, initial), springs, drives];
    let candidates = [energies.into_iter().fold(0.0, f64::max), 0.5 * mass * gravity.norm_squared(), 1.0];
    candidates.into_iter().find(|&e| e > 0.0).unwrap_or(1.0)
}
