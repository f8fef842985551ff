//! False solutions: a step's equations have others than the one that continues the motion.

use nalgebra::Vector3;

use super::progress::Progress;
use crate::variational::chain::Node;
use crate::variational::force::step_energy::StepEnergy;
use crate::variational::rattle::{Failure, Rattle};
use crate::variational::tree::spatial::Spatial;

impl Rattle {
    /// Rows across the tree of joints.
    pub(super) fn rows(&self) -> usize {
        self.parts.as_ref().and_then(|parts| parts.loops.as_ref()).map_or(0, |loops| loops.rows())
    }

    /// Fails where the points of a spring would pass each other, and where the step leaps.
    pub(super) fn refuse_false_solutions(&mut self, h: f64, progress: &Progress, kicked: f64) -> Result<(), Failure> {
        if self.rows() == 0 {
            return if progress.exact { self.refuse_leap(h, kicked) } else { Ok(()) };
        }
        let (energy, rounds) = (self.step_energy(h), progress.rounds);
        let Some(loops) = self.parts.as_mut().and_then(|parts| parts.loops.as_mut()) else { return Ok(()) };
        let passed = loops.passed().map(|(index, residual)| Failure::Loop { index, rounds, residual });
        let leap = loops.leap(h, energy).map(|gained| Failure::Leap { gained });
        passed.or(leap).map_or(Ok(()), Err)
    }

    /// Fails where the exact linearisation has found a false solution. The joints' impulses do no work on the
    /// velocities at the start, so the kinetic energy between the half kicks is that of the start, half the work of the
    /// step, and the energy of the kick alone, a part `sin^2` of the angle by which the kick turns the momentum.
    /// Linkages compare two steps instead.
    fn refuse_leap(&self, h: f64, kicked: f64) -> Result<(), Failure> {
        let (energy, start) = (self.step_energy(h), self.kinetic_energy());
        let (gained, kinetic) = (energy.kinetic - start - 0.5 * energy.work, energy.kinetic.max(start));
        if gained.abs() <= kicked * kinetic + energy.fall {
            Ok(())
        } else {
            Err(Failure::Leap { gained: gained / kinetic })
        }
    }

    /// Kinetic energy of the momenta at the start of the step, J.
    fn kinetic_energy(&self) -> f64 {
        let moving = self.chain.nodes.iter().zip(&self.now.bodies).zip(&self.now.pose).skip(1);
        moving.map(|((node, body), pose)| kinetic_energy(node, &body.p.value, &pose.r.tr_mul(&body.pi.value))).sum()
    }

    /// The energies of the step that is being tried.
    fn step_energy(&self, h: f64) -> StepEnergy {
        let mut sum = StepEnergy::default();
        for i in 1..self.chain.nodes.len() {
            let (node, body, trial) = (&self.chain.nodes[i], &self.now.bodies[i], &self.trial.bodies[i]);
            sum.kinetic += if node.light {
                let Spatial { linear, angular } = self.momentum_of_motion(i, h);
                kinetic_energy(node, &linear, &self.now.pose[i].r.tr_mul(&angular))
            } else {
                kinetic_energy(node, &body.p.plus(&trial.kick.linear), &(trial.hm / h))
            };
            sum.work += node.mass * self.chain.gravity.dot(&trial.motion.dx);
            sum.fall += 0.5 * node.mass * (h * self.chain.gravity).norm_squared();
        }
        sum.work += self.parts.iter().flat_map(|parts| &parts.forces).map(|force| force.work(h)).sum::<f64>();
        sum
    }
}

/// Kinetic energy of a body by its momentum and its angular momentum in body axes, J; none where there is no inertia.
fn kinetic_energy(node: &Node, linear: &Vector3<f64>, angular: &Vector3<f64>) -> f64 {
    let part = |square: f64, inertia: f64| if inertia > 0.0 { 0.5 * square / inertia } else { 0.0 };
    part(linear.norm_squared(), node.mass) + (0..3).map(|k| part(angular[k] * angular[k], node.inertia[k])).sum::<f64>()
}
