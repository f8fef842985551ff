//! Where a link is, in world axes, from the place of its parent.

use super::link::Link;
use super::number::linear::{Matrix3, Vector3};
use super::number::quaternion::matrix;
use super::number::real::Real;
use super::spatial::Spatial;
use crate::mechanics::JointKind;

/// Axes of a link frame and the way to its origin from the origin of the parent's link frame, world axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<T: Real> {
    pub r: Matrix3<T>,
    pub offset: Vector3<T>,
}

/// Axes and point of a joint in its parent's link frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hold<T: Real> {
    axes: Matrix3<T>,
    point: Vector3<T>,
}

impl<T: Real> Hold<T> {
    #[inline(always)]
    pub(super) fn of(link: &Link) -> Hold<T> {
        Hold { axes: Matrix3::of(&link.parent_axes), point: Vector3::of(&link.in_parent.translation.vector) }
    }
}

impl<T: Real> Place<T> {
    pub(super) fn ground() -> Place<T> {
        Place { r: Matrix3::identity(), offset: Vector3::zeros() }
    }

    /// `q` begins with the link's positions. A quaternion may have any length.
    #[inline(always)]
    pub(super) fn new(link: &Link, parent: &Matrix3<T>, q: &[T]) -> Place<T> {
        Place::with(link.kind, &Hold::of(link), parent, q, T::sin_cos)
    }

    /// The same with what the parent holds, and sines and cosines, from elsewhere.
    #[inline(always)]
    pub(super) fn with(
        kind: JointKind,
        hold: &Hold<T>,
        parent: &Matrix3<T>,
        q: &[T],
        sin_cos: impl FnOnce(T) -> (T, T),
    ) -> Place<T> {
        let axes = parent.product(&hold.axes);
        let offset = parent.times(&hold.point);
        match kind {
            JointKind::Revolute => Place { r: about_z(&axes, sin_cos(q[0])), offset },
            JointKind::Prismatic => Place { r: axes, offset: offset + *axes.column(2) * q[0] },
            JointKind::Planar => Place {
                r: about_z(&axes, sin_cos(q[2])),
                offset: offset + *axes.column(0) * q[0] + *axes.column(1) * q[1],
            },
            JointKind::Spherical => Place { r: axes.product(&matrix(&q[..4])), offset },
            JointKind::Floating => Place {
                r: axes.product(&matrix(&q[3..7])),
                offset: offset + axes.times(&Vector3::new(q[0], q[1], q[2])),
            },
        }
    }
}

/// `axes` turned about its own z axis by an angle of this sine and cosine.
#[inline(always)]
fn about_z<T: Real>(axes: &Matrix3<T>, (s, c): (T, T)) -> Matrix3<T> {
    let [x, y, z] = axes.columns;
    Matrix3::from_columns([x * c + y * s, y * c - x * s, z])
}

/// Relative twist of a link against its parent at its joint point, world axes. `v` begins with the link's velocities.
#[inline(always)]
pub(super) fn relative_twist<T: Real>(kind: JointKind, r: &Matrix3<T>, v: &[T]) -> Spatial<T> {
    let zero = Vector3::zeros();
    match kind {
        JointKind::Revolute => Spatial::new(zero, *r.column(2) * v[0]),
        JointKind::Prismatic => Spatial::new(*r.column(2) * v[0], zero),
        JointKind::Planar => Spatial::new(*r.column(0) * v[0] + *r.column(1) * v[1], *r.column(2) * v[2]),
        JointKind::Spherical => Spatial::new(zero, r.times(&Vector3::new(v[0], v[1], v[2]))),
        JointKind::Floating => {
            Spatial::new(r.times(&Vector3::new(v[0], v[1], v[2])), r.times(&Vector3::new(v[3], v[4], v[5])))
        }
    }
}
