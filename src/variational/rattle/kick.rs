//! Half kicks: the impulses of gravity and of the joints on the bodies.

use std::ops::Range;

use nalgebra::Vector3;

use super::state::BodyTrial;
use crate::variational::chain::{JointFrame, Node};
use crate::variational::tree::spatial::{Spatial, Wrench};

/// Nodes that stay in the nearest cache while one loop after another goes over them. One loop that did all for a node would read
/// what it has just written before the processor has put it together.
const BLOCK: usize = 8;

/// A range in blocks, in order.
pub(in crate::variational) fn blocks(range: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    range.clone().step_by(BLOCK).map(move |start| start..range.end.min(start + BLOCK))
}

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
