//! Where a joint is fixed in its parent.

use super::joint::for_kind;
use super::link::Link;
use super::link_frame::LinkFrame;
use super::number::linear::{Matrix3, Vector3};
use super::number::real::Real;
use crate::mechanics::JointKind;

/// Axes and point of a joint in its parent's link frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointFrame<T: Real> {
    axes: Matrix3<T>,
    point: Vector3<T>,
}

impl<T: Real> JointFrame<T> {
    #[inline(always)]
    pub(super) fn of(link: &Link) -> JointFrame<T> {
        JointFrame { axes: Matrix3::of(&link.parent_axes), point: Vector3::of(&link.in_parent.translation.vector) }
    }

    /// The child's link frame with the axes of the parent's. `q` begins with the positions of the joint; a quaternion
    /// may have any length. The sine and cosine of an angle come from elsewhere.
    #[inline(always)]
    pub(super) fn link_frame(
        &self,
        kind: JointKind,
        parent: &Matrix3<T>,
        q: &[T],
        sin_cos: impl FnOnce(T) -> (T, T),
    ) -> LinkFrame<T> {
        let axes = parent.product(&self.axes);
        let offset = parent.times(&self.point);
        for_kind!(kind, Joint => Joint::link_frame(&axes, offset, q, sin_cos))
    }
}
