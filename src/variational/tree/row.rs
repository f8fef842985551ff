//! Scalar rows across the tree.

use super::spatial::{Spatial, Twist, Wrench};
use crate::variational::chain::JointFrame;

/// Bodies that a row acts on, at most.
const ENDS: usize = 4;

/// A wrench on up to four nodes, each about the node's joint point, world axes.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct Row {
    pub(super) ends: [(usize, Wrench); ENDS],
    pub(super) count: usize,
}

impl Row {
    pub(in crate::variational) const NONE: Row = Row { ends: [(0, Spatial::ZERO); ENDS], count: 0 };

    /// Adds a wrench about a node's joint point. The ground takes none.
    pub(in crate::variational) fn push(&mut self, node: usize, wrench: Wrench) {
        if node > 0 && self.count < ENDS {
            self.ends[self.count] = (node, wrench);
            self.count += 1;
        }
    }

    pub(in crate::variational) fn ends(&self) -> &[(usize, Wrench)] {
        &self.ends[..self.count]
    }

    /// The velocity that the row sees, from twists at the joint points.
    pub(in crate::variational) fn rate(&self, twist: &[Twist]) -> f64 {
        self.ends().iter().map(|(node, wrench)| wrench.dot(&twist[*node])).sum()
    }

    /// The mobility of the row on free bodies, `k M^-1 k^T`. `com(i, w)` is that of a wrench about a centre of mass.
    pub(super) fn free_mobility(&self, frames: &[JointFrame], com: &impl Fn(usize, &Wrench) -> f64) -> f64 {
        self.ends().iter().map(|(node, wrench)| com(*node, &wrench.wrench_from(&frames[*node].arm))).sum()
    }
}
