//! Where a link is, in world axes, from the place of its parent.

use super::number::linear::{Matrix3, Vector3};
use super::number::real::Real;

/// Axes of a link frame and the way to its origin from the origin of the parent's link frame, world axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinkFrame<T: Real> {
    pub axes: Matrix3<T>,
    pub offset: Vector3<T>,
}

impl<T: Real> LinkFrame<T> {
    pub(super) fn ground() -> LinkFrame<T> {
        LinkFrame { axes: Matrix3::identity(), offset: Vector3::zeros() }
    }
}
