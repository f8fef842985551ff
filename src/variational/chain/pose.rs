//! Where a body is.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3, Vector4};

use crate::numeric::Compensated3;

/// Where a body is.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct Pose {
    /// Centre of mass, m, and what did not fit into it.
    pub x: Vector3<f64>,
    pub(super) rest: Vector3<f64>,
    /// Attitude, quaternion coordinates (i, j, k, w).
    pub q: Vector4<f64>,
    /// The same as a matrix, body axes to world axes.
    pub r: Matrix3<f64>,
}

impl Pose {
    pub(in crate::variational) const GROUND: Pose = Pose {
        x: Vector3::new(0.0, 0.0, 0.0),
        rest: Vector3::new(0.0, 0.0, 0.0),
        q: Vector4::new(0.0, 0.0, 0.0, 1.0),
        r: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
    };

    #[inline(always)]
    pub(in crate::variational) fn new(x: &Compensated3, q: Vector4<f64>) -> Pose {
        let r = UnitQuaternion::new_unchecked(Quaternion::from(q)).to_rotation_matrix().into_inner();
        Pose { x: x.value, rest: *x.rest(), q, r }
    }

    /// The same somewhere else.
    pub(in crate::variational) fn moved(&self, dx: &Vector3<f64>, r: Matrix3<f64>) -> Pose {
        Pose { x: self.x + dx, r, ..*self }
    }

    /// The way from another body's centre of mass, to the roundoff of that way and not of the positions.
    #[inline(always)]
    pub(in crate::variational) fn way_from(&self, other: &Pose) -> Vector3<f64> {
        (self.x - other.x) + (self.rest - other.rest)
    }
}
