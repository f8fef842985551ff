//! Where the bodies of a system are and how they move.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

/// Pose and velocity of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Centre of mass, m, world.
    pub position: Vector3<f64>,
    /// Body axes to world axes.
    pub attitude: UnitQuaternion<f64>,
    /// Of the centre of mass, m/s, world axes.
    pub velocity: Vector3<f64>,
    /// rad/s, world axes
    pub angular_velocity: Vector3<f64>,
}

impl BodyState {
    /// The state of the ground, as if it were a body.
    pub fn ground() -> BodyState {
        BodyState {
            position: Vector3::zeros(),
            attitude: UnitQuaternion::identity(),
            velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
        }
    }

    /// Pose of the body frame in the world.
    pub fn pose(&self) -> Isometry3<f64> {
        Isometry3::from_parts(self.position.into(), self.attitude)
    }
}

/// State of a system: one entry a body, in the order of [`System::bodies`](super::System::bodies).
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    pub bodies: Vec<BodyState>,
}

impl State {
    /// True where every number is finite.
    pub fn is_finite(&self) -> bool {
        self.bodies.iter().all(|b| {
            b.position
                .iter()
                .chain(b.attitude.coords.iter())
                .chain(b.velocity.iter())
                .chain(b.angular_velocity.iter())
                .all(|x| x.is_finite())
        })
    }
}
