//! The bonds of a system.

use super::state::{Bond, Kind};
use crate::mechanics::{JointKind, PointSpring, System};
use crate::model::scene::LoopKind;
use crate::variational::chain::{Mount, Node};

/// The bonds of a system: loops, couplings, springs, in this order, so that the rows of springs come last.
pub(in crate::variational) fn bonds(system: &System, nodes: &[Node]) -> Vec<Bond> {
    let node = |body: Option<usize>| body.map_or(0, |b| b + 1);
    let parts = &system.parts;
    let loops = parts.loops.iter().map(|closure| {
        let joint = |kind| {
            Box::new(Node {
                parent: node(closure.parent),
                kind,
                mount: Box::new(Mount {
                    arm: closure.in_child.translation.vector,
                    frame: closure.in_child.rotation.to_rotation_matrix().into_inner(),
                    parent_arm: closure.in_parent.translation.vector,
                    parent_frame: closure.in_parent.rotation.to_rotation_matrix().into_inner(),
                }),
                ..nodes[0].clone()
            })
        };
        let (kind, ball) = match closure.kind {
            LoopKind::Revolute => (JointKind::Revolute, None),
            LoopKind::Spherical => (JointKind::Spherical, None),
            LoopKind::Prismatic => (JointKind::Prismatic, None),
            LoopKind::Fixed => (JointKind::Prismatic, Some(joint(JointKind::Spherical))),
        };
        let count = closure.locked().iter().filter(|locked| **locked).count();
        let kind = Kind::Loop { kind: closure.kind, joint: joint(kind), ball };
        (kind, node(closure.child), node(closure.parent), count)
    });
    let couplings = parts.couplings.iter().map(|coupling| {
        let kind = Kind::Coupling { source: coupling.source + 1, multiplier: coupling.multiplier };
        (kind, coupling.follower + 1, nodes[coupling.follower + 1].parent, 1)
    });
    let springs = parts.point_springs.iter().map(|spring| {
        let (from, to) = (spring.from.point, spring.to.point);
        let PointSpring { stiffness, damping, rest_length: rest, .. } = *spring;
        let (kind, count) = match (stiffness > 0.0, damping > 0.0) {
            (false, false) => (Kind::Spring { from, to, stiffness, damping, rest }, 0),
            (true, damped) if rest == 0.0 => (Kind::Pull { from, to, stiffness, damping }, 3 + usize::from(damped)),
            (true, _) | (false, true) => (Kind::Spring { from, to, stiffness, damping, rest }, 1),
        };
        (kind, node(spring.to.body), node(spring.from.body), count)
    });
    let mut first = 0;
    let bond = |(kind, child, parent, count)| {
        first += count;
        Bond::new(kind, (child, parent), first - count..first)
    };
    loops.chain(couplings).chain(springs).map(bond).collect()
}
