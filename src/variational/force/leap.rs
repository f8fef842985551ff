//! Energy from nowhere, and springs whose points would pass each other.

use super::bond::Bond;
use super::loops::Loops;
use super::step_energy::StepEnergy;
use crate::variational::closing::stop::LIMITS;

impl Loops {
    /// A spring whose points would pass each other, and how far, m.
    pub(in crate::variational) fn passed(&self) -> Option<(usize, f64)> {
        let passed = self.bonds.iter().map(Bond::passed);
        passed.enumerate().find(|(_, passed)| *passed > 0.0)
    }

    /// The part of the kinetic energy that a step takes from nowhere, or loses, where that is more than
    /// [`Limits::leap`](crate::variational::closing::stop::Limits). Constraints do no work: near a singular
    /// configuration the equations of a step have other solutions, which throw the linkage onto another branch.
    pub(in crate::variational) fn leap(&mut self, h: f64, energy: StepEnergy) -> Option<f64> {
        if self.rigid == 0 {
            return None;
        }
        self.tried = energy;
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
        (gained.abs() > LIMITS.leap * kinetic + turning).then_some(gained / kinetic)
    }

    /// Work of the springs from the middle of the last step to that of the one that is being tried: their impulses in
    /// the two half kicks between, times the mean of how fast they get longer. It is right for stiff springs too, whose
    /// pull changes its sign from step to step.
    fn work_of_springs(&self) -> f64 {
        let pulls = self.last_pulls.iter().zip(&self.tried_pulls);
        pulls.map(|((nu0, rate0), (nu1, rate1))| 0.5 * (nu0 + nu1) * (rate0 + rate1)).sum()
    }
}
