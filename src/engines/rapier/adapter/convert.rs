//! Between nalgebra in double precision and rapier's types.

use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};

use super::super::rapier::math::{Pose, Rotation, Vector};
use super::super::{narrow, widen};
use super::seat::Motion;
use crate::mechanics::BodyState;

pub(super) fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(narrow(v.x), narrow(v.y), narrow(v.z))
}

pub(super) fn pose(pose: &Isometry3<f64>) -> Pose {
    let q = pose.rotation;
    let rotation = Rotation::from_xyzw(narrow(q.i), narrow(q.j), narrow(q.k), narrow(q.w));
    Pose::from_parts(vector(&pose.translation.vector), rotation)
}

pub(super) fn vector_of(v: Vector) -> Vector3<f64> {
    Vector3::new(widen(v.x), widen(v.y), widen(v.z))
}

/// Multibody joints let the norm of a quaternion drift by roundoff; the rotation is what it says after normalisation.
pub(super) fn attitude_of(q: Rotation) -> UnitQuaternion<f64> {
    UnitQuaternion::new_normalize(Quaternion::new(widen(q.w), widen(q.x), widen(q.y), widen(q.z)))
}

pub(super) fn body_state(motion: &Motion) -> BodyState {
    BodyState {
        position: vector_of(motion.pose.translation),
        attitude: attitude_of(motion.pose.rotation),
        velocity: vector_of(motion.velocity),
        angular_velocity: vector_of(motion.angular_velocity),
    }
}
