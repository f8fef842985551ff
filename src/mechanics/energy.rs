//! Kinetic and potential energy, and the scale that errors are divided by.

use super::{Body, State, System};
use nalgebra::Vector3;

/// Energy of a state, J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy {
    pub kinetic: f64,
    /// Zero at the world's origin.
    pub potential: f64,
}

impl Energy {
    pub fn total(self) -> f64 {
        self.kinetic + self.potential
    }
}

/// `K = sum_b 1/2 m |v|^2 + 1/2 Omega . J Omega`, `U = -sum_b m g . x`.
pub fn energy(system: &System, state: &State) -> Energy {
    Energy { kinetic: kinetic(&system.bodies, state), potential: potential(system, state, 0.0) }
}

/// The energy whose potential is taken where the bodies were `lag` seconds before, `U(x - lag v)`: for engines whose
/// positions and velocities belong to different times.
pub fn energy_at_velocity_time(system: &System, state: &State, lag: f64) -> Energy {
    Energy { kinetic: kinetic(&system.bodies, state), potential: potential(system, state, lag) }
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

fn potential(system: &System, state: &State, lag: f64) -> f64 {
    let weighted: Vector3<f64> =
        system.bodies.iter().zip(&state.bodies).map(|(body, s)| body.mass * (s.position - lag * s.velocity)).sum();
    -system.gravity.dot(&weighted)
}

/// The yardstick of relative energy errors, a property of the scene alone, J: the larger of the initial kinetic energy
/// and `sum_b m_b |g| d_b`, where `d_b` is the length of the path along the tree from the ground's joint to the body's
/// centre of mass. A scene where both are zero but bodies fall is measured by the energy of its first second of free
/// fall, and one where nothing can happen by 1 J.
pub fn scale(bodies: &[Body], gravity: &Vector3<f64>, initial: &State) -> f64 {
    let mut to_joint: Vec<f64> = Vec::with_capacity(bodies.len());
    let mut potential = 0.0;
    for body in bodies {
        let joint = &body.joint;
        let path = joint.parent.map_or(0.0, |p| {
            let parent_origin = bodies[p].joint.in_child.translation.vector;
            to_joint[p] + (joint.in_parent.translation.vector - parent_origin).norm()
        });
        to_joint.push(path);
        potential += body.mass * gravity.norm() * (path + joint.in_child.translation.vector.norm());
    }
    let mass: f64 = bodies.iter().map(|b| b.mass).sum();
    let candidates = [potential.max(kinetic(bodies, initial)), 0.5 * mass * gravity.norm_squared(), 1.0];
    candidates.into_iter().find(|&e| e > 0.0).unwrap_or(1.0)
}
