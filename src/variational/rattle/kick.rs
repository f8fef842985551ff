//! Half kicks: the impulses of gravity and of the joints on the bodies.

use nalgebra::Vector3;

use super::state::BodyTrial;
use crate::variational::chain::{JointFrame, Node};
use crate::variational::tree::spatial::{Spatial, Wrench};

/// Gravity in a half kick.
pub(in crate::variational) struct Gravity {
    /// s
    pub time: f64,
    /// m/s^2
    pub field: Vector3<f64>,
}

impl Gravity {
    #[inline(always)]
    pub(in crate::variational) fn impulse(&self, mass: f64) -> Vector3<f64> {
        self.time * mass * self.field
    }
}

/// Puts an impulse of joint `i`, known about its joint point, on its two bodies.
#[inline(always)]
pub(in crate::variational) fn add_joint_impulse(
    bodies: &mut [BodyTrial],
    nodes: &[Node],
    frames: &[JointFrame],
    i: usize,
    wrench: &Wrench,
) {
    let (frame, parent) = (&frames[i], nodes[i].parent);
    bodies[i].kick += wrench.wrench_from(&frame.arm);
    if parent > 0 {
        bodies[parent].kick -= wrench.wrench_from(&(frames[parent].arm + frame.offset));
    }
}

/// (1) for joint `i` and its body, after the parent's.
#[inline(always)]
pub(in crate::variational) fn kick_joint(
    bodies: &mut [BodyTrial],
    nodes: &[Node],
    frames: &[JointFrame],
    i: usize,
    gravity: &Gravity,
    wrench: &Wrench,
) {
    bodies[i].kick = Spatial::new(gravity.impulse(nodes[i].mass), Vector3::zeros());
    add_joint_impulse(bodies, nodes, frames, i, wrench);
}
