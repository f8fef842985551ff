//! Energy from nowhere, and loops that no impulse closes.

use super::loops::Loops;
use super::solve::worst;
use crate::variational::chain::Node;

/// Redundant rows that contradict each other by more than this, over the system's length, are an open loop.
const CONTRADICTION: f64 = 1e-10;

/// The part of the kinetic energy that a step of a linkage may gain or lose by its error. Whips with `h |Omega|` near 1 gain 0.05.
const LEAP: f64 = 0.3;

/// The same of a step from which a run is worth a warning. Four-bars that pass their flat position within a step have 0.15 to
/// 0.26, at steps that resolve it up to 0.02; all other linkages are below 0.002.
pub(super) const JUMP: f64 = 0.05;

/// Energies of a step, J.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::variational) struct StepEnergy {
    /// Kinetic energy of the momenta between the half kicks.
    pub kinetic: f64,
    /// Work of gravity over the step.
    pub work: f64,
    /// Kinetic energy that gravity alone gives in the step from rest.
    pub fall: f64,
}

impl Loops {
    /// The bond that stays open although no impulse can close it further, and by how much, m; or a spring whose points would
    /// pass each other.
    pub(in crate::variational) fn contradiction(&mut self, nodes: &[Node], length: f64) -> Option<(usize, f64)> {
        let rigid = self.bonds.partition_point(|bond| !bond.is_spring());
        let (bond, size) = worst(&self.bonds[..rigid], nodes, &self.gap, length);
        let passed = self.bonds.iter().position(|bond| bond.passed() > 0.0);
        let open = (!(size <= CONTRADICTION * length)).then_some((bond, size));
        open.or(passed.map(|bond| (bond, self.bonds[bond].passed())))
    }

    /// The part of the kinetic energy that a step takes from nowhere, or loses, where that is more than [`LEAP`]. Constraints do
    /// no work: near a singular configuration the equations of a step have other solutions, which throw the linkage onto
    /// another branch.
    pub(in crate::variational) fn leap(&mut self, h: f64, energy: StepEnergy) -> Option<f64> {
        if self.rigid == 0 {
            return None;
        }
        (self.tried, self.tried_jump) = (energy, 0.0);
        let springs = self.bonds.iter().filter(|bond| bond.is_spring());
        let rates = springs.flat_map(|bond| (0..bond.rows().len()).map(move |row| bond.rate(row, h)));
        for ((pull, nu), rate) in self.tried_pulls.iter_mut().zip(&self.nu[self.rigid..]).zip(rates) {
            *pull = (*nu, rate);
        }
        let last = self.last?;
        let gained = energy.kinetic - last.kinetic - 0.5 * (energy.work + last.work) - self.work_of_springs();
        let kinetic = energy.kinetic.max(last.kinetic);
        // Near a turning point the work of a step is all that there is, and steps of different sizes share it unevenly.
        let turning = energy.fall + last.fall + energy.work.abs() + last.work.abs();
        self.tried_jump = if kinetic > 0.0 { (gained.abs() - turning) / kinetic } else { 0.0 };
        (gained.abs() > LEAP * kinetic + turning).then_some(gained / kinetic)
    }

    /// Work of the springs from the middle of the last step to that of the one that is being tried: their impulses in the two
    /// half kicks between, times the mean of how fast they get longer. It is right for stiff springs too, whose pull changes
    /// its sign from step to step.
    fn work_of_springs(&self) -> f64 {
        let pulls = self.last_pulls.iter().zip(&self.tried_pulls);
        pulls.map(|((nu0, rate0), (nu1, rate1))| 0.5 * (nu0 + nu1) * (rate0 + rate1)).sum()
    }
}
