//! The constraint iteration.

use super::accept::KICKED;
use super::progress::{Measured, Progress, Verdict};
use super::stop::Ending;
use super::tail::{Tail, Waited};
use crate::variational::rattle::{Failure, Rattle};

impl Rattle {
    /// Finds the wrenches with which the joints hold at the end of the drift: (1) to (3).
    ///
    /// # Errors
    /// See [`Failure`].
    pub(in crate::variational) fn solve_constraints(&mut self, h: f64) -> Result<(), Failure> {
        // A high degree starts closer, a low one survives a violent moment.
        let mut degree = self.memory.predictor.degree();
        loop {
            self.predict(h, degree);
            match (self.iterate(h, if degree.is_some() { KICKED.0 } else { KICKED.1 }), degree) {
                (Err(_), Some(used)) => degree = (used > 0).then_some(used / 2),
                (result, _) => {
                    return result.map(|ending| self.memory.counters.end(ending));
                }
            }
            self.memory.counters.degree_drops += 1;
        }
    }

    /// Corrects the wrenches round by round, until the rules of [`super::stop`] end it; `kicked` is the bound of
    /// [`Rattle::refuse_leap`].
    fn iterate(&mut self, h: f64, kicked: f64) -> Result<Ending, Failure> {
        let unbiased = self.settings.unbiased.then_some(self.memory.contraction * h.abs());
        let mut progress = Progress::new(self.settings.tolerance, self.is_tree(), unbiased);
        // Where the joints of a long chain have closed but for those near its base, the others wait.
        let (mut tail, mut may_wait): (Option<Tail>, bool) = (None, self.may_wait());
        self.start_light(h);
        loop {
            let end = tail.as_ref().map_or(self.chain.nodes.len(), |tail| tail.first);
            let Measured { place, residual, roundoff } = self.drift_and_measure(h, end)?;
            let verdict = progress.judge(residual, roundoff);
            if let Some(rate) = progress.contraction() {
                self.memory.contraction = rate / h.abs();
            }
            let last = match verdict {
                Verdict::Closed(ending) if tail.is_none() => {
                    self.refuse_false_solutions(h, progress.rounds, progress.exact.then_some(kicked))?;
                    return Ok(ending);
                }
                Verdict::Closed(ending) | Verdict::LastRound(ending) => Some(ending),
                Verdict::GoOn => None,
                Verdict::GiveUp => return Err(place.failure(progress.rounds, residual)),
            };
            self.memory.counters.rounds += 1;
            if tail.is_none() && may_wait && !progress.exact && last.is_none() && progress.rounds > 0 {
                tail = self.settled_tail(roundoff);
            }
            if let Some(waiting) = &mut tail {
                match self.correct_head_or_all(waiting, h, roundoff, last.is_some(), progress.falls(residual)) {
                    Waited::ToTheEnd => return self.drift(h).map(|()| last.unwrap_or(Ending::Negligible)),
                    Waited::On => progress.corrected(residual),
                    Waited::TooLong => {
                        progress.corrected(residual.max(waiting.residual));
                        (tail, may_wait) = (None, false);
                    }
                }
                continue;
            }
            if progress.turns_exact() {
                self.memory.counters.refactorisations += 1;
                // A block that has no inverse there says nothing about the system, only that the step is too long.
                self.correct_exactly(h).map_err(|_| place.failure(progress.rounds, residual))?;
            } else {
                self.correct(h);
            }
            progress.corrected(residual);
            if let Some(ending) = last {
                self.drift_at_last(h)?;
                self.refuse_false_solutions(h, progress.rounds, progress.exact.then_some(kicked))?;
                return Ok(ending);
            }
        }
    }
}
