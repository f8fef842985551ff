//! Origins and axes as URDF writes them.

use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

/// The direction of a vector of any length but zero, without overflow or underflow.
pub(in crate::model) fn direction(written: &Vector3<f64>) -> Option<Unit<Vector3<f64>>> {
    let largest = written.amax();
    (largest > 0.0).then(|| Unit::new_normalize(written / largest))
}

/// A URDF origin: the translation, and the rotation `Rz(yaw) Ry(pitch) Rx(roll)`.
pub(in crate::model) fn pose_of(xyz: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(xyz), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
}
