//! Where our bodies sit in a rapier world, and how they move there.

use super::super::rapier::math::{Pose, Vector};
use super::super::rapier::prelude::{MultibodyIndex, PhysicsWorld, RigidBodyHandle};

/// Where one of our bodies sits in rapier.
pub(super) struct Seat {
    pub name: String,
    pub body: RigidBodyHandle,
    /// The multibody and the link in it, for a body in reduced coordinates.
    pub link: Option<(MultibodyIndex, usize)>,
}

/// Pose of the body frame and twist at its origin, the centre of mass, in world axes.
#[derive(Clone, Copy)]
pub(super) struct Motion {
    pub pose: Pose,
    pub velocity: Vector,
    pub angular_velocity: Vector,
}

impl Motion {
    /// Whether every number is finite and the quaternion is a rotation: rapier's normalisation of an overflow is zero.
    pub(super) fn is_finite(&self) -> bool {
        let finite = self.pose.is_finite() && self.velocity.is_finite() && self.angular_velocity.is_finite();
        finite && self.pose.rotation.length_squared().is_normal()
    }
}

impl Seat {
    /// Reads the body's motion. The twist of a link is `J(q) qdot`, with the Jacobian of the present pose: the
    /// velocities that rapier stores in the bodies of a multibody are those of one substep before.
    pub(super) fn motion(&self, physics: &PhysicsWorld) -> Motion {
        let body = &physics.bodies[self.body];
        let pose = *body.position();
        let Some((index, link)) = self.link else {
            return Motion { pose, velocity: body.linvel(), angular_velocity: body.angvel() };
        };
        let multibody = &physics.multibody_joints[index];
        let rates = multibody.generalized_velocity();
        let (mut velocity, mut angular_velocity) = (Vector::ZERO, Vector::ZERO);
        for (column, rate) in multibody.body_jacobian(link).column_iter().zip(rates.iter()) {
            velocity += Vector::new(column[0], column[1], column[2]) * *rate;
            angular_velocity += Vector::new(column[3], column[4], column[5]) * *rate;
        }
        Motion { pose, velocity, angular_velocity }
    }
}
