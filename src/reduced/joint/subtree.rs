//! The links beyond a joint.

use crate::reduced::number::linear::{Matrix3, Vector3};
use crate::reduced::number::real::Real;
use crate::reduced::spatial::Spatial;

/// What the equations know of the links beyond a joint, about its joint point and in world axes.
pub(in crate::reduced) struct Subtree<'a, T: Real> {
    /// Axes of the link frame.
    pub axes: &'a Matrix3<T>,
    /// Axes of the parent's link frame, `None` for the ground, and of the joint frame in it.
    pub parent: Option<&'a Matrix3<T>>,
    pub in_parent: &'a nalgebra::Matrix3<f64>,
    /// `P` and `L`.
    pub momentum: Spatial<T>,
    /// kg, and `m c` about the joint point.
    pub mass: T,
    pub first_moment: Vector3<T>,
    /// Velocity of the joint point, and angular velocity of the parent.
    pub velocity: Vector3<T>,
    pub parent_omega: Vector3<T>,
    pub gravity: Vector3<T>,
    /// What springs between points exert.
    pub load: Spatial<T>,
}

impl<T: Real> Subtree<'_, T> {
    /// `P x omega_parent + F`
    #[inline(always)]
    pub(super) fn force(&self) -> Vector3<T> {
        self.momentum.lin.cross(&self.parent_omega) + self.gravity * self.mass + self.load.lin
    }

    /// `L x omega_parent + P x v + N`
    #[inline(always)]
    pub(super) fn torque(&self) -> Vector3<T> {
        let Spatial { lin: p, ang: l } = self.momentum;
        l.cross(&self.parent_omega) + p.cross(&self.velocity) + self.first_moment.cross(&self.gravity) + self.load.ang
    }

    /// Axes of the joint frame in the parent.
    #[inline(always)]
    pub(super) fn joint_axes(&self) -> Matrix3<T> {
        let fixed = Matrix3::of(self.in_parent);
        self.parent.map_or(fixed, |parent| parent.product(&fixed))
    }
}
