//! Joints that close loops of the tree.

use nalgebra::Isometry3;

use super::link::Link;
use crate::mechanics;
use crate::model::scene::LoopKind;

/// A joint that closes a loop between two links; `None` is the ground.
#[derive(Clone, Debug)]
pub struct Closure {
    pub name: String,
    kind: LoopKind,
    pub(super) parent: Option<usize>,
    pub(super) child: Option<usize>,
    /// Pose of the joint frame in the link frames (in the world for the ground).
    pub(super) in_parent: Isometry3<f64>,
    pub(super) in_child: Isometry3<f64>,
}

impl Closure {
    pub(super) fn new(closure: &mechanics::Closure, links: &[Link]) -> Closure {
        let in_link = |body: Option<usize>, pose: Isometry3<f64>| body.map_or(pose, |b| links[b].body * pose);
        Closure {
            name: closure.name.clone(),
            kind: closure.kind,
            parent: closure.parent,
            child: closure.child,
            in_parent: in_link(closure.parent, closure.in_parent),
            in_child: in_link(closure.child, closure.in_child),
        }
    }

    /// The locked rows: axes of `d`, and index pairs of `Q`.
    pub(super) fn locked(&self) -> (&'static [usize], &'static [(usize, usize)]) {
        const TURNS: &[(usize, usize)] = &[(1, 2), (2, 0), (0, 1)];
        match self.kind {
            LoopKind::Revolute => (&[0, 1, 2], &[(0, 2), (1, 2)]),
            LoopKind::Spherical => (&[0, 1, 2], &[]),
            LoopKind::Prismatic => (&[0, 1], TURNS),
            LoopKind::Fixed => (&[0, 1, 2], TURNS),
        }
    }

    pub(super) fn rows(&self) -> usize {
        let (lengths, turns) = self.locked();
        lengths.len() + turns.len()
    }
}
