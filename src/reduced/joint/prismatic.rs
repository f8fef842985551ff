//! One length along z.

use nalgebra as na;

use super::mobilizer::Mobilizer;
use super::subtree::Subtree;
use crate::mechanics::coordinates::JointCoordinates;
use crate::reduced::elimination::Elimination;
use crate::reduced::link_frame::LinkFrame;
use crate::reduced::number::linear::{Matrix3, Vector3};
use crate::reduced::number::real::Real;
use crate::reduced::spatial::Spatial;

/// `q` is the length.
pub(in crate::reduced) struct Prismatic;

impl Mobilizer for Prismatic {
    const POSITIONS: usize = 1;

    fn initial(theta: &JointCoordinates, q: &mut [f64], v: &mut [f64]) {
        (q[0], v[0]) = (theta.position[0], theta.velocity[0]);
    }

    fn advance(q: &mut [f64], v: &[f64], h: f64) {
        q[0] += h * v[0];
    }

    fn normalise(_q: &mut [f64]) {}

    fn transform(q: &[f64]) -> na::Isometry3<f64> {
        na::Isometry3::translation(0.0, 0.0, q[0])
    }

    fn relative_twist(v: &[f64]) -> (na::Vector3<f64>, na::Vector3<f64>) {
        (na::Vector3::new(0.0, 0.0, v[0]), na::Vector3::zeros())
    }

    #[inline(always)]
    fn link_frame<T: Real>(
        axes: &Matrix3<T>,
        offset: Vector3<T>,
        q: &[T],
        _sin_cos: impl FnOnce(T) -> (T, T),
    ) -> LinkFrame<T> {
        LinkFrame { axes: *axes, offset: offset + *axes.column(2) * q[0] }
    }

    #[inline(always)]
    fn twist<T: Real>(axes: &Matrix3<T>, v: &[T]) -> Spatial<T> {
        Spatial::new(*axes.column(2) * v[0], Vector3::zeros())
    }

    fn elimination<T: Real>() -> Elimination<T> {
        Elimination::slide()
    }

    #[inline(always)]
    fn velocity_map<T: Real>(_q: &[T], v: &[T], qdot: &mut [T]) {
        qdot[0] = v[0];
    }

    #[inline(always)]
    fn momentum_along_velocities<T: Real>(_q: &[T], p: &[T], m: &mut [T]) {
        m[0] = p[0];
    }

    #[inline(always)]
    fn canonical_momentum<T: Real>(_q: &[T], m: &[T], p: &mut [T]) {
        p[0] = m[0];
    }

    #[inline(always)]
    fn momentum<T: Real>(subtree: &Subtree<T>, m: &mut [T]) {
        m[0] = subtree.axes.column(2).dot(&subtree.momentum.lin);
    }

    #[inline(always)]
    fn force<T: Real>(subtree: &Subtree<T>, _q: &[T], effort: impl Fn(usize) -> T, force: &mut [T]) {
        force[0] = subtree.axes.column(2).dot(&subtree.force()) + effort(0);
    }

    #[inline(always)]
    fn momentum_rate<T: Real>(_q: &[T], _p: &[T], _v: &[T], force: &[T], rate: &mut [T]) {
        rate[0] = force[0];
    }
}
