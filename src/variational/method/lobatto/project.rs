//! (3): the joints at the end of a step, and the momenta that fit them.

use super::integrator::Lobatto;
use crate::variational::chain::{JointFrame, keep_locked, mismatch};
use crate::variational::rattle::{Failure, RETURN, world_inertia};
use crate::variational::tree::Singular;
use crate::variational::tree::spatial::Spatial;

impl Lobatto {
    pub(super) fn factorise(&mut self) -> Result<(), Failure> {
        for i in 1..self.nodes.len() {
            let parent = self.nodes[i].parent;
            let parent_arm = self.frames[parent].arm;
            let (node, pose, above) = (&self.nodes[i], &self.pose[i], &self.pose[parent]);
            self.frames[i] = JointFrame::new(node, pose, above, &parent_arm);
            self.gap0[i] = mismatch(node, pose, above).scaled(RETURN);
        }
        let (nodes, pose) = (&self.nodes, &self.pose);
        self.tree
            .factorise(nodes, &self.frames, |i| world_inertia(&nodes[i], &pose[i]), |_| 0.0)
            .map_err(|Singular { node }| Failure::Singular { joint: node - 1 })
    }

    /// (3): the last stage's multipliers, which make the twists fit.
    pub(super) fn project_momenta(&mut self) {
        let s = self.tableau.stages;
        let (bodies, twist, bias) = (&self.bodies, &mut self.twist, &mut self.bias);
        self.tree.project(
            &self.frames,
            |i| Spatial::new(bodies[i].p.value, bodies[i].pi.value),
            |i, v, f| {
                twist[i] = *v;
                bias[i] = f;
            },
        );
        for i in 1..self.nodes.len() {
            self.stages[i * s].load = Spatial::ZERO;
        }
        for i in 1..self.nodes.len() {
            let (frame, parent) = (&self.frames[i], self.nodes[i].parent);
            // A difference of momenta: what roundoff leaves along the free directions would be an impulse there.
            keep_locked(&self.nodes[i], frame, &mut self.bias[i]);
            self.stages[i * s].load += self.bias[i].wrench_from(&frame.arm);
            if parent > 0 {
                self.stages[parent * s].load -= self.bias[i].wrench_from(&(self.frames[parent].arm + frame.offset));
            }
        }
        for i in 1..self.nodes.len() {
            let impulse = self.stages[i * s].load;
            self.bodies[i].p.add(&impulse.linear);
            self.bodies[i].pi.add(&impulse.angular);
        }
    }
}
