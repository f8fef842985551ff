//! Where a joint is, and by how much it is open there.

use nalgebra::{Matrix3, Vector3};

use super::node::Node;
use super::pose::Pose;
use crate::mechanics::JointKind;
use crate::variational::tree::spatial::{Spatial, Twist};

/// A joint's place in a configuration, world axes.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct JointFrame {
    /// From the body's centre of mass to its joint point, the origin of the child's joint frame.
    pub arm: Vector3<f64>,
    /// From the parent's joint point to this one.
    pub offset: Vector3<f64>,
    /// Axes of the joint frame that is fixed in the parent.
    pub axes: Matrix3<f64>,
}

impl JointFrame {
    pub(in crate::variational) const GROUND: JointFrame =
        JointFrame { arm: Vector3::new(0.0, 0.0, 0.0), offset: Vector3::new(0.0, 0.0, 0.0), axes: Pose::GROUND.r };

    /// `parent_arm_at` is the [`JointFrame::arm`] of the parent.
    #[inline(always)]
    pub(in crate::variational) fn new(
        node: &Node,
        pose: &Pose,
        parent: &Pose,
        parent_arm_at: &Vector3<f64>,
    ) -> JointFrame {
        let arm = pose.r * node.mount.arm;
        let offset = match node.kind {
            JointKind::Revolute | JointKind::Spherical => parent.r * node.mount.parent_arm - parent_arm_at,
            JointKind::Prismatic | JointKind::Planar | JointKind::Floating => {
                pose.way_from(parent) + (arm - parent_arm_at)
            }
        };
        JointFrame { arm, offset, axes: parent.r * node.mount.parent_frame }
    }
}

/// What of a relative pose the joint does not allow: the twist that would build it up in one second. World axes; the
/// rotation part is exact to first order, and zero exactly where the joint holds.
#[inline(always)]
pub(in crate::variational) fn mismatch(node: &Node, pose: &Pose, parent: &Pose) -> Twist {
    let gap = || pose.way_from(parent) + (pose.r * node.mount.arm - parent.r * node.mount.parent_arm);
    // The z axes of both joint frames: their cross product turns the parent's into the child's.
    let axis = || parent.r * node.mount.parent_frame.column(2);
    let tilt = |axis: &Vector3<f64>| axis.cross(&(pose.r * node.mount.frame.column(2)));
    match node.kind {
        JointKind::Revolute => Spatial::new(gap(), tilt(&axis())),
        JointKind::Spherical => Spatial::new(gap(), Vector3::zeros()),
        JointKind::Prismatic => {
            let (gap, axis) = (gap(), axis());
            let (child, parent_axes) = (pose.r * node.mount.frame, parent.r * node.mount.parent_frame);
            let turn = (0..3).map(|k| parent_axes.column(k).cross(&child.column(k))).sum::<Vector3<f64>>();
            // Twice: a long stroke leaves roundoff of its own length along the axis, where the joint cannot answer it.
            let across = gap - axis * axis.dot(&gap);
            Spatial::new(across - axis * axis.dot(&across), 0.5 * turn)
        }
        JointKind::Planar => {
            let axis = axis();
            Spatial::new(axis * axis.dot(&gap()), tilt(&axis))
        }
        JointKind::Floating => Spatial::ZERO,
    }
}
