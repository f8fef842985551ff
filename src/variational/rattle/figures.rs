//! What is asked of a run.

use super::state::Rattle;
use crate::variational::closing::counters::Counters;
use crate::variational::force::loops::Loops;

impl Rattle {
    /// The body that the forces in the joints would swing fastest, by index, and how fast, rad/s: a body with the
    /// forces `F_j` at the joint points `r_j` from its centre of mass turns about its own joint, at `r_0`, like a
    /// pendulum,
    ///
    /// ```text
    /// omega^2 = sum_j |F_j| |r_j| / (J + m |r_0|^2) .
    /// ```
    ///
    /// It is a bound of the size of the fastest sway of a taut chain, by the forces of the last step. `None` before the
    /// first.
    pub fn fastest_sway(&self) -> Option<(usize, f64)> {
        self.memory.predictor.degree()?;
        let nodes = &self.chain.nodes;
        let mut moment = vec![0.0; nodes.len()];
        for (i, node) in nodes.iter().enumerate().skip(1) {
            let force = self.memory.predictor.newest(i).linear.norm();
            moment[i] += force * node.mount.arm.norm();
            moment[node.parent] += force * node.mount.parent_arm.norm();
        }
        let rate = |i: usize| {
            let node = &nodes[i];
            let inertia = node.inertia.max() + node.mass * node.mount.arm.norm_squared();
            if inertia > 0.0 { (moment[i] / inertia).sqrt() } else { 0.0 }
        };
        (1..nodes.len()).map(|i| (i - 1, rate(i))).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Independent rows of the loops and couplings in the present configuration.
    pub fn rank(&self) -> usize {
        self.loops().map_or(0, Loops::rank)
    }

    /// What the solves since the start took.
    pub fn counters(&self) -> &Counters {
        &self.memory.counters
    }

    fn loops(&self) -> Option<&Loops> {
        self.parts.as_ref().and_then(|parts| parts.loops.as_deref())
    }
}
