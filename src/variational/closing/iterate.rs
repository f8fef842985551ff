//! The constraint iteration.

use super::progress::{Measured, Progress, Verdict};
use super::stop::{Ending, LIMITS, Trust};
use crate::variational::rattle::{Failure, Rattle};

impl Rattle {
    /// Finds the wrenches with which the joints hold at the end of the drift: (1) to (3).
    ///
    /// # Errors
    /// See [`Failure`].
    pub(in crate::variational) fn solve_constraints(&mut self, h: f64) -> Result<(), Failure> {
        // A high degree starts closer, a low one survives a violent moment.
        let (mut degree, mut trust) = (self.memory.predictor.degree(), Trust::Eager);
        loop {
            let failure = match self.iterate(h, degree, trust) {
                Ok(ending) => {
                    self.memory.counters.end(ending);
                    return Ok(());
                }
                Err(failure) => failure,
            };
            match (failure, degree) {
                (Failure::Constraint { .. } | Failure::Loop { .. }, _) if trust == Trust::Eager => {
                    trust = Trust::Careful
                }
                (_, Some(used)) => degree = (used > 0).then_some(used / 2),
                (_, None) => return Err(failure),
            }
            self.memory.counters.restarts += 1;
        }
    }

    /// Corrects the wrenches round by round, until the rules of [`super::stop`] end it.
    fn iterate(&mut self, h: f64, degree: Option<usize>, trust: Trust) -> Result<Ending, Failure> {
        let unbiased = self.settings.unbiased.then_some(self.memory.contraction * h.abs());
        let mut progress = Progress::new(self.settings.tolerance, self.rows(), trust, unbiased);
        self.predict(h, degree);
        loop {
            let Measured { place, residual, roundoff } = self.drift_and_measure(h)?;
            let verdict = progress.judge(residual, roundoff);
            if let Some(rate) = progress.contraction() {
                self.memory.contraction = rate / h.abs();
            }
            match verdict {
                Verdict::Closed(ending) => {
                    self.refuse_false_solutions(h, &progress, LIMITS.kicked(degree))?;
                    return Ok(ending);
                }
                Verdict::GiveUp => return Err(place.failure(progress.rounds, residual)),
                Verdict::GoOn | Verdict::LastRound(_) => {}
            }
            if progress.factorise {
                self.memory.counters.refactorisations += 1;
                // A block that has no inverse there says nothing about the system, only that the step is too long.
                self.linearise(h).map_err(|_| place.failure(progress.rounds, residual))?;
            }
            if progress.exact {
                self.correct_exactly(h);
            } else {
                self.correct(h);
            }
            progress.corrected(residual);
            self.memory.counters.rounds += 1;
            if let Verdict::LastRound(ending) = verdict {
                self.drift_at_last(h)?;
                self.refuse_false_solutions(h, &progress, LIMITS.kicked(degree))?;
                return Ok(ending);
            }
        }
    }
}
