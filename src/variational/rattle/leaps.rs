//! False solutions: a step's equations have others than the one that continues the motion.

use super::{Failure, Rattle};
use crate::variational::loops::StepEnergy;

/// The part of the kinetic energy between the half kicks that may be that of the kick: of a first solution, and of one that no
/// lower degree of the extrapolation betters. In whips of 10 to 50 links with `h |Omega|` near 1 right solutions have up to
/// 0.31, those that were refused 0.33 to 0.94; with a bound of 0.4 a planar whip of 10 links leaps.
pub(super) const KICKED: (f64, f64) = (0.3, 0.32);

impl Rattle {
    /// Fails where redundant rows contradict each other, so that no impulse closes the loop, and where a linkage leaps.
    pub(super) fn refuse_false_solutions(&mut self, h: f64, rounds: usize, kicked: Option<f64>) -> Result<(), Failure> {
        let Some(mut loops) = self.loops.take() else {
            return kicked.map_or(Ok(()), |kicked| self.refuse_leap(h, kicked));
        };
        let open = loops.contradiction(&self.nodes, self.length);
        let open = open.map(|(index, residual)| Failure::Loop { index, rounds, residual });
        let leap = loops.leap(h, self.step_energy(h)).map(|gained| Failure::Leap { gained });
        self.loops = Some(loops);
        open.or(leap).map_or(Ok(()), Err)
    }

    /// Fails where the exact linearisation has found a false solution. The joints' impulses do no work on the velocities at the
    /// start, so the kinetic energy between the half kicks is that of the start, half the work of the step, and the energy of
    /// the kick alone, a part `sin^2` of the angle by which the kick turns the momentum. Linkages compare two steps instead.
    fn refuse_leap(&self, h: f64, kicked: f64) -> Result<(), Failure> {
        let (energy, start) = (self.step_energy(h), self.kinetic_energy());
        let (gained, kinetic) = (energy.kinetic - start - 0.5 * energy.work, energy.kinetic.max(start));
        if gained.abs() <= kicked * kinetic + energy.fall {
            Ok(())
        } else {
            Err(Failure::Leap { gained: gained / kinetic })
        }
    }

    /// Kinetic energy of the momenta at the start of the step, J. Light bodies are left out.
    fn kinetic_energy(&self) -> f64 {
        let heavy = (1..self.nodes.len()).filter(|&i| !self.nodes[i].light);
        heavy
            .map(|i| {
                let (node, body) = (&self.nodes[i], &self.bodies[i]);
                let spin = self.pose[i].r.tr_mul(&body.pi.value);
                let spinning = spin.component_mul(&spin).component_div(&node.inertia).sum();
                0.5 * (body.p.value.norm_squared() / node.mass + spinning)
            })
            .sum()
    }

    /// The energies of the step that is being tried. Light bodies are left out.
    fn step_energy(&self, h: f64) -> StepEnergy {
        let mut sum = StepEnergy::default();
        for ((node, body), trial) in self.nodes.iter().zip(&self.bodies).zip(&self.trial).skip(1) {
            if node.light {
                continue;
            }
            let p = body.p.plus(&trial.kick.linear);
            let spin = trial.hm.component_mul(&trial.hm).component_div(&node.inertia).sum() / (h * h);
            sum.kinetic += 0.5 * (p.norm_squared() / node.mass + spin);
            sum.work += node.mass * self.gravity.dot(&trial.motion.dx);
            sum.fall += 0.5 * node.mass * (h * self.gravity).norm_squared();
        }
        sum.work += self.forces.iter().map(|force| force.work(h)).sum::<f64>();
        sum
    }
}
