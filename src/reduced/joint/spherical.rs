//! Every rotation about a point.

use nalgebra as na;

use super::mobilizer::Mobilizer;
use super::subtree::Subtree;
use crate::mechanics::coordinates::JointCoordinates;
use crate::reduced::elimination::{Direction, Elimination};
use crate::reduced::link_frame::LinkFrame;
use crate::reduced::number::linear::{Matrix3, Vector3};
use crate::reduced::number::quaternion::{self, matrix};
use crate::reduced::number::real::Real;
use crate::reduced::spatial::Spatial;

/// `q` is a quaternion `(x, y, z, w)`.
pub(in crate::reduced) struct Spherical;

impl Mobilizer for Spherical {
    const POSITIONS: usize = 4;

    fn initial(theta: &JointCoordinates, q: &mut [f64], v: &mut [f64]) {
        let vector = |values: &[f64]| na::Vector3::new(values[0], values[1], values[2]);
        let turn = na::UnitQuaternion::from_scaled_axis(vector(&theta.position));
        q[..4].copy_from_slice(turn.coords.as_slice());
        v[..3].copy_from_slice((turn.inverse() * vector(&theta.velocity)).as_slice());
    }

    fn advance(q: &mut [f64], v: &[f64], h: f64) {
        quaternion::turn(&mut q[..4], &v[..3], h);
    }

    fn normalise(q: &mut [f64]) {
        quaternion::normalise(&mut q[..4]);
    }

    fn transform(q: &[f64]) -> na::Isometry3<f64> {
        na::Isometry3::from_parts(na::Translation3::identity(), quaternion::rotation(&q[..4]))
    }

    fn relative_twist(v: &[f64]) -> (na::Vector3<f64>, na::Vector3<f64>) {
        (na::Vector3::zeros(), na::Vector3::new(v[0], v[1], v[2]))
    }

    #[inline(always)]
    fn link_frame<T: Real>(
        axes: &Matrix3<T>,
        offset: Vector3<T>,
        q: &[T],
        _sin_cos: impl FnOnce(T) -> (T, T),
    ) -> LinkFrame<T> {
        LinkFrame { axes: axes.product(&matrix(&q[..4])), offset }
    }

    #[inline(always)]
    fn twist<T: Real>(axes: &Matrix3<T>, v: &[T]) -> Spatial<T> {
        Spatial::new(Vector3::zeros(), axes.times(&Vector3::new(v[0], v[1], v[2])))
    }

    fn elimination<T: Real>() -> Elimination<T> {
        Elimination::three([Direction::About(0), Direction::About(1), Direction::About(2)])
    }

    #[inline(always)]
    fn velocity_map<T: Real>(q: &[T], v: &[T], qdot: &mut [T]) {
        quaternion::rate(&q[..4], &v[..3], &mut qdot[..4]);
    }

    #[inline(always)]
    fn momentum_along_velocities<T: Real>(q: &[T], p: &[T], m: &mut [T]) {
        quaternion::body_momentum(&q[..4], &p[..4], &mut m[..3]);
    }

    #[inline(always)]
    fn canonical_momentum<T: Real>(q: &[T], m: &[T], p: &mut [T]) {
        quaternion::canonical_momentum(&q[..4], &m[..3], &mut p[..4]);
    }

    #[inline(always)]
    fn momentum<T: Real>(subtree: &Subtree<T>, m: &mut [T]) {
        subtree.axes.transpose_times(&subtree.momentum.ang).write(m);
    }

    #[inline(always)]
    fn force<T: Real>(subtree: &Subtree<T>, _q: &[T], effort: impl Fn(usize) -> T, force: &mut [T]) {
        let torque = subtree.axes.transpose_times(&subtree.torque());
        (0..3).for_each(|k| force[k] = torque[k] + effort(k));
    }

    #[inline(always)]
    fn momentum_rate<T: Real>(q: &[T], p: &[T], v: &[T], force: &[T], rate: &mut [T]) {
        quaternion::momentum_rate(&q[..4], &p[..4], &v[..3], &force[..3], &mut rate[..4]);
    }
}
