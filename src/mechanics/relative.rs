//! The motion of a child against its parent, seen from the joint between them.

use nalgebra::{Isometry3, Vector3};

use super::joint::{Joint, JointCoordinates};
use super::joint_kind::JointKind;
use super::state::BodyState;
use crate::numeric::larger;

/// Pose and twist of a child against its parent, at the joint between them.
pub(super) struct RelativeMotion {
    /// Pose of the child's joint frame in the parent's joint frame.
    pub relative: Isometry3<f64>,
    /// Relative twist at the origin of the child's joint frame, axes of the parent's joint frame.
    pub twist: (Vector3<f64>, Vector3<f64>),
}

impl RelativeMotion {
    pub(super) fn new(joint: &Joint, child: &BodyState, parent: Option<&BodyState>) -> RelativeMotion {
        let child_arm = child.attitude * joint.in_child.translation.vector;
        let child_frame = child.attitude * joint.in_child.rotation;
        // Positions first, so that two bodies far from the origin subtract without loss.
        let (parent_frame, offset, parent_twist) = match parent {
            None => {
                let frame = joint.in_parent.rotation;
                (
                    frame,
                    child.position - joint.in_parent.translation.vector + child_arm,
                    (Vector3::zeros(), Vector3::zeros()),
                )
            }
            Some(p) => {
                let between = child.position - p.position;
                let offset = between - p.attitude * joint.in_parent.translation.vector + child_arm;
                let linear = p.velocity + p.angular_velocity.cross(&(between + child_arm));
                (p.attitude * joint.in_parent.rotation, offset, (linear, p.angular_velocity))
            }
        };
        let to_joint = parent_frame.inverse();
        let linear = child.velocity + child.angular_velocity.cross(&child_arm) - parent_twist.0;
        let angular = child.angular_velocity - parent_twist.1;
        RelativeMotion {
            relative: Isometry3::from_parts((to_joint * offset).into(), to_joint * child_frame),
            twist: (to_joint * linear, to_joint * angular),
        }
    }

    /// Coordinates with angles in (-pi, pi].
    pub(super) fn coordinates(&self, kind: JointKind) -> JointCoordinates {
        let free = kind.free();
        let (position, _) = kind.decompose(&self.relative);
        let twist = [self.twist.0.x, self.twist.0.y, self.twist.0.z, self.twist.1.x, self.twist.1.y, self.twist.1.z];
        let mut velocity = [0.0; 6];
        for (slot, i) in (0..6).filter(|&i| free[i]).enumerate() {
            velocity[slot] = twist[i];
        }
        JointCoordinates { position, velocity }
    }

    /// Largest component that the joint does not allow: of the pose (m, rad) and of the twist (m/s, rad/s).
    pub(super) fn residual(&self, kind: JointKind) -> (f64, f64) {
        let free = kind.free();
        let (_, locked) = kind.decompose(&self.relative);
        let twist = [self.twist.0.x, self.twist.0.y, self.twist.0.z, self.twist.1.x, self.twist.1.y, self.twist.1.z];
        let largest = |values: [f64; 6]| (0..6).filter(|&i| !free[i]).map(|i| values[i].abs()).fold(0.0, larger);
        (largest(locked), largest(twist))
    }
}
