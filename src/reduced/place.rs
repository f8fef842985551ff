//! Where a link is, in world axes, from the place of its parent.

use nalgebra::{Matrix3, Vector3};

use super::model::Link;
use super::spatial::Spatial;
use crate::mechanics::JointKind;

/// Axes of a link frame and the way to its origin from the origin of the parent's link frame, world axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub r: Matrix3<f64>,
    pub offset: Vector3<f64>,
}

impl Place {
    pub(super) const GROUND: Place =
        Place { r: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), offset: Vector3::new(0.0, 0.0, 0.0) };

    /// `q` begins with the link's positions. A quaternion may have any length.
    #[inline(always)]
    pub(super) fn new(link: &Link, parent: &Matrix3<f64>, q: &[f64]) -> Place {
        let axes = parent * link.parent_axes;
        let offset = parent * link.in_parent.translation.vector;
        match link.kind {
            JointKind::Revolute => Place { r: about_z(&axes, q[0]), offset },
            JointKind::Prismatic => Place { r: axes, offset: offset + axes.column(2) * q[0] },
            JointKind::Planar => {
                Place { r: about_z(&axes, q[2]), offset: offset + axes.column(0) * q[0] + axes.column(1) * q[1] }
            }
            JointKind::Spherical => Place { r: axes * matrix(&q[..4]), offset },
            JointKind::Floating => {
                Place { r: axes * matrix(&q[3..7]), offset: offset + axes * Vector3::new(q[0], q[1], q[2]) }
            }
        }
    }
}

/// `axes` turned about its own z axis.
#[inline(always)]
fn about_z(axes: &Matrix3<f64>, angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    let (x, y) = (axes.column(0), axes.column(1));
    Matrix3::from_columns(&[x * c + y * s, y * c - x * s, axes.column(2).into_owned()])
}

/// The rotation of a quaternion `(x, y, z, w)` of any length.
#[inline(always)]
fn matrix(q: &[f64]) -> Matrix3<f64> {
    let (x, y, z, w) = (q[0], q[1], q[2], q[3]);
    let s = 2.0 / (x * x + y * y + z * z + w * w);
    Matrix3::new(
        1.0 - s * (y * y + z * z),
        s * (x * y - w * z),
        s * (x * z + w * y),
        s * (x * y + w * z),
        1.0 - s * (x * x + z * z),
        s * (y * z - w * x),
        s * (x * z - w * y),
        s * (y * z + w * x),
        1.0 - s * (x * x + y * y),
    )
}

/// Relative twist of a link against its parent at its joint point, world axes. `v` begins with the link's velocities.
#[inline(always)]
pub(super) fn relative_twist(kind: JointKind, r: &Matrix3<f64>, v: &[f64]) -> Spatial {
    let zero = Vector3::zeros();
    match kind {
        JointKind::Revolute => Spatial::new(zero, r.column(2) * v[0]),
        JointKind::Prismatic => Spatial::new(r.column(2) * v[0], zero),
        JointKind::Planar => Spatial::new(r.column(0) * v[0] + r.column(1) * v[1], r.column(2) * v[2]),
        JointKind::Spherical => Spatial::new(zero, r * Vector3::new(v[0], v[1], v[2])),
        JointKind::Floating => Spatial::new(r * Vector3::new(v[0], v[1], v[2]), r * Vector3::new(v[3], v[4], v[5])),
    }
}
