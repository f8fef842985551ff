//! Every motion.

use nalgebra as na;

use super::mobilizer::Mobilizer;
use super::subtree::Subtree;
use crate::mechanics::coordinates::JointCoordinates;
use crate::reduced::elimination::Elimination;
use crate::reduced::link_frame::LinkFrame;
use crate::reduced::number::linear::{Matrix3, Vector3};
use crate::reduced::number::quaternion::{self, matrix};
use crate::reduced::number::real::Real;
use crate::reduced::spatial::Spatial;

/// `q` is the position in the axes of the joint frame in the parent, then a quaternion `(x, y, z, w)`.
pub(in crate::reduced) struct Floating;

impl Mobilizer for Floating {
    const POSITIONS: usize = 7;

    fn initial(theta: &JointCoordinates, q: &mut [f64], v: &mut [f64]) {
        let vector = |values: &[f64]| na::Vector3::new(values[0], values[1], values[2]);
        let (position, velocity) = (&theta.position, &theta.velocity);
        let turn = na::UnitQuaternion::from_scaled_axis(vector(&position[3..]));
        q[..3].copy_from_slice(&position[..3]);
        q[3..7].copy_from_slice(turn.coords.as_slice());
        v[..3].copy_from_slice((turn.inverse() * vector(velocity)).as_slice());
        v[3..6].copy_from_slice((turn.inverse() * vector(&velocity[3..])).as_slice());
    }

    fn advance(q: &mut [f64], v: &[f64], h: f64) {
        let way = quaternion::rotation(&q[3..7]) * na::Vector3::new(v[0], v[1], v[2]) * h;
        (0..3).for_each(|k| q[k] += way[k]);
        quaternion::turn(&mut q[3..7], &v[3..6], h);
    }

    fn normalise(q: &mut [f64]) {
        quaternion::normalise(&mut q[3..7]);
    }

    fn transform(q: &[f64]) -> na::Isometry3<f64> {
        na::Isometry3::from_parts(na::Translation3::new(q[0], q[1], q[2]), quaternion::rotation(&q[3..7]))
    }

    fn relative_twist(v: &[f64]) -> (na::Vector3<f64>, na::Vector3<f64>) {
        (na::Vector3::new(v[0], v[1], v[2]), na::Vector3::new(v[3], v[4], v[5]))
    }

    #[inline(always)]
    fn link_frame<T: Real>(
        axes: &Matrix3<T>,
        offset: Vector3<T>,
        q: &[T],
        _sin_cos: impl FnOnce(T) -> (T, T),
    ) -> LinkFrame<T> {
        LinkFrame {
            axes: axes.product(&matrix(&q[3..7])),
            offset: offset + axes.times(&Vector3::new(q[0], q[1], q[2])),
        }
    }

    #[inline(always)]
    fn twist<T: Real>(axes: &Matrix3<T>, v: &[T]) -> Spatial<T> {
        Spatial::new(axes.times(&Vector3::new(v[0], v[1], v[2])), axes.times(&Vector3::new(v[3], v[4], v[5])))
    }

    fn elimination<T: Real>() -> Elimination<T> {
        Elimination::free()
    }

    #[inline(always)]
    fn velocity_map<T: Real>(q: &[T], v: &[T], qdot: &mut [T]) {
        matrix(&q[3..7]).times(&Vector3::new(v[0], v[1], v[2])).write(qdot);
        quaternion::rate(&q[3..7], &v[3..6], &mut qdot[3..7]);
    }

    #[inline(always)]
    fn momentum_along_velocities<T: Real>(q: &[T], p: &[T], m: &mut [T]) {
        matrix(&q[3..7]).transpose_times(&Vector3::new(p[0], p[1], p[2])).write(m);
        quaternion::body_momentum(&q[3..7], &p[3..7], &mut m[3..6]);
    }

    #[inline(always)]
    fn canonical_momentum<T: Real>(q: &[T], m: &[T], p: &mut [T]) {
        matrix(&q[3..7]).times(&Vector3::new(m[0], m[1], m[2])).write(p);
        quaternion::canonical_momentum(&q[3..7], &m[3..6], &mut p[3..7]);
    }

    #[inline(always)]
    fn momentum<T: Real>(subtree: &Subtree<T>, m: &mut [T]) {
        subtree.axes.transpose_times(&subtree.momentum.lin).write(m);
        subtree.axes.transpose_times(&subtree.momentum.ang).write(&mut m[3..]);
    }

    /// Nothing acts in the joint: the compiler of scenes refuses a damper there.
    #[inline(always)]
    fn force<T: Real>(subtree: &Subtree<T>, _q: &[T], _effort: impl Fn(usize) -> T, force: &mut [T]) {
        subtree.joint_axes().transpose_times(&subtree.force()).write(force);
        subtree.axes.transpose_times(&subtree.torque()).write(&mut force[3..]);
    }

    #[inline(always)]
    fn momentum_rate<T: Real>(q: &[T], p: &[T], v: &[T], force: &[T], rate: &mut [T]) {
        rate[..3].copy_from_slice(&force[..3]);
        quaternion::momentum_rate(&q[3..7], &p[3..7], &v[3..6], &force[3..6], &mut rate[3..7]);
    }
}
