//! What the equations of motion ask of a kind of joint.

use nalgebra as na;

use super::subtree::Subtree;
use crate::mechanics::coordinates::JointCoordinates;
use crate::reduced::elimination::Elimination;
use crate::reduced::link_frame::LinkFrame;
use crate::reduced::number::linear::{Matrix3, Vector3};
use crate::reduced::number::real::Real;
use crate::reduced::spatial::Spatial;

/// A kind of joint, with positions `q` and velocities `v` that begin with those of the joint.
///
/// The velocities are the free components of the relative twist against the parent, in the axes of the link frame and
/// in the order of [`JointKind::free`](crate::mechanics::JointKind::free). `N(q)` maps them to the rates of the
/// positions.
pub(in crate::reduced) trait Mobilizer {
    /// Numbers that hold the position.
    const POSITIONS: usize;

    /// Positions and velocities from the coordinates of the compiled system.
    fn initial(theta: &JointCoordinates, q: &mut [f64], v: &mut [f64]);

    /// Moves the positions for a time `h` at constant velocities: lengths along the axes at the start, quaternions
    /// exactly.
    fn advance(q: &mut [f64], v: &[f64], h: f64);

    /// Gives a quaternion its unit length back.
    fn normalise(q: &mut [f64]);

    /// Pose of the link frame in the joint frame of the parent.
    fn transform(q: &[f64]) -> na::Isometry3<f64>;

    /// Relative twist (linear, angular) at the origin and in the axes of the link frame, `S v`.
    fn relative_twist(v: &[f64]) -> (na::Vector3<f64>, na::Vector3<f64>);

    /// The link frame from the axes of the joint frame in the parent and the way to its origin, world axes, with sine
    /// and cosine of an angle from elsewhere.
    fn link_frame<T: Real>(
        axes: &Matrix3<T>,
        offset: Vector3<T>,
        q: &[T],
        sin_cos: impl FnOnce(T) -> (T, T),
    ) -> LinkFrame<T>;

    /// Relative twist at the joint point in world axes, with the axes of the link frame.
    fn twist<T: Real>(axes: &Matrix3<T>, v: &[T]) -> Spatial<T>;

    /// Room for the elimination of the free directions.
    fn elimination<T: Real>() -> Elimination<T>;

    /// `qdot = N(q) v`
    fn velocity_map<T: Real>(q: &[T], v: &[T], qdot: &mut [T]);

    /// Momentum along the velocities from the canonical one, `m = N(q)^T p`.
    fn momentum_along_velocities<T: Real>(q: &[T], p: &[T], m: &mut [T]);

    /// The canonical momentum that gives `m = N(q)^T p`, across a quaternion: `q . p = 0`.
    fn canonical_momentum<T: Real>(q: &[T], m: &[T], p: &mut [T]);

    /// `m = S^T (P, L)` with the momentum of the links beyond.
    fn momentum<T: Real>(subtree: &Subtree<T>, m: &mut [T]);

    /// Force along the velocities: what `pdot` has beside the turning of a quaternion. That on lengths of planar and
    /// free joints is in the axes of the joint frame in the parent. `effort` is what acts in the joint along each
    /// velocity.
    fn force<T: Real>(subtree: &Subtree<T>, q: &[T], effort: impl Fn(usize) -> T, force: &mut [T]);

    /// `pdot` from that force.
    fn momentum_rate<T: Real>(q: &[T], p: &[T], v: &[T], force: &[T], rate: &mut [T]);
}
