//! What a step does for springs, dampers, drives, loops and light bodies, where a system has them.

use super::failure::Failure;
use super::kick::Gravity;
use super::project::{RETURN, mobility, world_inertia};
use super::state::Rattle;
use crate::variational::force::Parts;
use crate::variational::force::joint::JointForce;
use crate::variational::tree::Singular;

impl Rattle {
    /// Takes in the configuration in which a run starts.
    pub(super) fn start_parts(&mut self) {
        let Some(parts) = &mut self.parts else { return };
        for (i, k) in Parts::forced(&self.chain.nodes) {
            parts.forces[k].start(1.0 / self.now.tree.compliance(i));
        }
        if let Some(loops) = &mut parts.loops {
            loops.start();
        }
    }

    /// Prepares a step of size `h`.
    pub(super) fn begin_parts(&mut self, h: f64) -> Result<(), Failure> {
        let Some(parts) = &mut self.parts else { return Ok(()) };
        let (nodes, now) = (&self.chain.nodes, &self.now);
        let Parts { forces, implicit, loops, .. } = &mut **parts;
        forces.iter_mut().for_each(|force| force.begin(now.time.value.x, h));
        if let Some(tree) = implicit {
            let in_joint = |i: usize| nodes[i].force.map_or(0.0, |k| forces[k].implicit(h));
            tree.factorise(nodes, &now.frames, |i| world_inertia(&nodes[i], &now.pose[i]), in_joint)
                .map_err(|Singular { node }| Failure::Singular { joint: node - 1 })?;
        }
        if let Some(loops) = loops {
            let tree = implicit.as_ref().unwrap_or(&now.tree);
            loops.prepare(h, tree, nodes, &now.frames, &mobility(nodes, &now.pose));
        }
        Ok(())
    }

    /// Takes over what the step of size `h` that has been found changes.
    pub(super) fn accept_parts(&mut self, h: f64) {
        let Some(parts) = &mut self.parts else { return };
        let time = self.now.time.value.x;
        parts.forces.iter_mut().for_each(JointForce::end);
        if let Some(loops) = &mut parts.loops {
            loops.record(time, h);
            loops.accept(RETURN);
        }
        self.kick_light(h);
    }

    /// (1) of what acts beside gravity and the joints of the tree.
    pub(in crate::variational) fn kick_parts(&mut self) {
        let Some(loops) = self.parts.as_ref().and_then(|parts| parts.loops.as_ref()) else { return };
        loops.push(&self.now.frames, |i, impulse| self.trial.bodies[i].kick += impulse);
    }

    /// Gravity in the first half kick of a step of size `h`.
    pub(in crate::variational) fn first_kick(&self, h: f64) -> Gravity {
        Gravity { time: self.settings.method.parts().0 * h, field: self.chain.gravity }
    }
}
