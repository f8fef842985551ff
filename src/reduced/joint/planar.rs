//! Lengths along x and y, and the angle about z.

use nalgebra as na;

use super::mobilizer::Mobilizer;
use super::subtree::Subtree;
use crate::mechanics::coordinates::JointCoordinates;
use crate::reduced::elimination::{Direction, Elimination};
use crate::reduced::link_frame::LinkFrame;
use crate::reduced::number::linear::{Matrix3, Vector3};
use crate::reduced::number::real::Real;
use crate::reduced::spatial::Spatial;

/// `q` is x, y and the angle; lengths are along the axes of the joint frame in the parent.
pub(in crate::reduced) struct Planar;

impl Mobilizer for Planar {
    const POSITIONS: usize = 3;

    fn initial(theta: &JointCoordinates, q: &mut [f64], v: &mut [f64]) {
        let (position, velocity) = (&theta.position, &theta.velocity);
        q[..3].copy_from_slice(&position[..3]);
        let (s, c) = position[2].sin_cos();
        v[0] = c * velocity[0] + s * velocity[1];
        v[1] = c * velocity[1] - s * velocity[0];
        v[2] = velocity[2];
    }

    fn advance(q: &mut [f64], v: &[f64], h: f64) {
        let (s, c) = q[2].sin_cos();
        q[0] += h * (c * v[0] - s * v[1]);
        q[1] += h * (s * v[0] + c * v[1]);
        q[2] += h * v[2];
    }

    fn normalise(_q: &mut [f64]) {}

    fn transform(q: &[f64]) -> na::Isometry3<f64> {
        let turn = na::UnitQuaternion::from_axis_angle(&na::Vector3::z_axis(), q[2]);
        na::Isometry3::from_parts(na::Translation3::new(q[0], q[1], 0.0), turn)
    }

    fn relative_twist(v: &[f64]) -> (na::Vector3<f64>, na::Vector3<f64>) {
        (na::Vector3::new(v[0], v[1], 0.0), na::Vector3::new(0.0, 0.0, v[2]))
    }

    #[inline(always)]
    fn link_frame<T: Real>(
        axes: &Matrix3<T>,
        offset: Vector3<T>,
        q: &[T],
        sin_cos: impl FnOnce(T) -> (T, T),
    ) -> LinkFrame<T> {
        LinkFrame {
            axes: axes.turned_about_z(sin_cos(q[2])),
            offset: offset + *axes.column(0) * q[0] + *axes.column(1) * q[1],
        }
    }

    #[inline(always)]
    fn twist<T: Real>(axes: &Matrix3<T>, v: &[T]) -> Spatial<T> {
        Spatial::new(*axes.column(0) * v[0] + *axes.column(1) * v[1], *axes.column(2) * v[2])
    }

    fn elimination<T: Real>() -> Elimination<T> {
        Elimination::three([Direction::Along(0), Direction::Along(1), Direction::About(2)])
    }

    #[inline(always)]
    fn velocity_map<T: Real>(q: &[T], v: &[T], qdot: &mut [T]) {
        let (s, c) = q[2].sin_cos();
        qdot[0] = c * v[0] - s * v[1];
        qdot[1] = s * v[0] + c * v[1];
        qdot[2] = v[2];
    }

    #[inline(always)]
    fn momentum_along_velocities<T: Real>(q: &[T], p: &[T], m: &mut [T]) {
        let (s, c) = q[2].sin_cos();
        (m[0], m[1], m[2]) = (c * p[0] + s * p[1], c * p[1] - s * p[0], p[2]);
    }

    #[inline(always)]
    fn canonical_momentum<T: Real>(q: &[T], m: &[T], p: &mut [T]) {
        let (s, c) = q[2].sin_cos();
        (p[0], p[1], p[2]) = (c * m[0] - s * m[1], s * m[0] + c * m[1], m[2]);
    }

    #[inline(always)]
    fn momentum<T: Real>(subtree: &Subtree<T>, m: &mut [T]) {
        let whole = subtree.axes.transpose_times(&subtree.momentum.lin);
        (m[0], m[1], m[2]) = (whole.x, whole.y, subtree.axes.column(2).dot(&subtree.momentum.ang));
    }

    #[inline(always)]
    fn force<T: Real>(subtree: &Subtree<T>, q: &[T], effort: impl Fn(usize) -> T, force: &mut [T]) {
        let pull = subtree.axes.transpose_times(&subtree.force());
        let (s, c) = q[2].sin_cos();
        let (x, y) = (pull.x + effort(0), pull.y + effort(1));
        (force[0], force[1]) = (c * x - s * y, s * x + c * y);
        force[2] = subtree.axes.column(2).dot(&subtree.torque()) + effort(2);
    }

    #[inline(always)]
    fn momentum_rate<T: Real>(_q: &[T], _p: &[T], _v: &[T], force: &[T], rate: &mut [T]) {
        rate[..3].copy_from_slice(&force[..3]);
    }
}
