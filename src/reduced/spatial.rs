//! Twists and wrenches at joint points, in world axes.

use std::ops::{Add, AddAssign};

use super::number::linear::Vector3;
use super::number::real::Real;

/// A twist or acceleration (of a point, angular), or a wrench or momentum (force, torque about a point).
#[derive(Clone, Copy, Debug)]
pub(super) struct Spatial<T: Real> {
    pub lin: Vector3<T>,
    pub ang: Vector3<T>,
}

impl<T: Real> Spatial<T> {
    #[inline(always)]
    pub(super) fn zero() -> Spatial<T> {
        Spatial::new(Vector3::zeros(), Vector3::zeros())
    }

    #[inline(always)]
    pub(super) fn new(lin: Vector3<T>, ang: Vector3<T>) -> Spatial<T> {
        Spatial { lin, ang }
    }

    #[inline(always)]
    pub(super) fn dot(&self, other: &Spatial<T>) -> T {
        self.lin.dot(&other.lin) + self.ang.dot(&other.ang)
    }

    #[inline(always)]
    pub(super) fn scaled(&self, factor: T) -> Spatial<T> {
        Spatial::new(self.lin * factor, self.ang * factor)
    }

    /// A twist of the parent's joint point, seen at the joint point that is `d` away.
    #[inline(always)]
    pub(super) fn twist_at(&self, d: &Vector3<T>) -> Spatial<T> {
        Spatial::new(self.lin + self.ang.cross(d), self.ang)
    }

    /// A wrench about a joint point that is `d` away from the parent's, about the parent's.
    #[inline(always)]
    pub(super) fn wrench_from(&self, d: &Vector3<T>) -> Spatial<T> {
        Spatial::new(self.lin, self.ang + d.cross(&self.lin))
    }
}

impl<T: Real> Add for Spatial<T> {
    type Output = Spatial<T>;
    #[inline(always)]
    fn add(self, other: Spatial<T>) -> Spatial<T> {
        Spatial::new(self.lin + other.lin, self.ang + other.ang)
    }
}

impl<T: Real> AddAssign for Spatial<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Spatial<T>) {
        self.lin += other.lin;
        self.ang += other.ang;
    }
}
