//! A list of runs on one system: first all traced, on several threads, then all timed, one at a time.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::Horizon;
use super::cost::clock::{self, Candidate, Effort};
use super::outcome::{Limits, Outcome};
use super::run::Run;
use super::threads;
use super::trace::{self, Trace};
use super::truth::trusted::Truth;
use crate::engines::{self, Spec};
use crate::mechanics::System;

/// What is run, and within which limits.
#[derive(Debug)]
pub(super) struct Batch<'a> {
    pub system: &'a System,
    pub cases: Vec<(&'a Spec, Horizon)>,
    /// What positions are compared with.
    pub truth: Option<&'a Truth>,
    /// Wall-clock time that one run may take.
    pub budget: Duration,
    /// Wall-clock time that all may take together; the runs with the fewest steps come first then.
    pub together: Option<Duration>,
    /// Threads for the traced runs.
    pub jobs: usize,
}

impl Batch<'_> {
    /// Traces every case; `None` stands where a run was interrupted. `taken` counts steps.
    pub fn trace(&self, interrupted: &AtomicBool, taken: &AtomicU64) -> Vec<Option<Run>> {
        let mut order: Vec<usize> = (0..self.cases.len()).collect();
        order.sort_by_key(|&i| self.cases[i].1.steps);
        if self.together.is_none() {
            // The longest first, so that no thread is left alone with it.
            order.reverse();
        }
        let begin = Instant::now();
        let traces = threads::map(self.jobs, order.len(), &order, |i| {
            let left = self.together.map_or(self.budget, |all| all.saturating_sub(begin.elapsed()));
            self.trace_one(i, &Limits { budget: left.min(self.budget), interrupted, taken })
        });
        let run = |(case, trace): (&(&Spec, Horizon), Option<Trace>)| {
            Some(Run { engine: case.0.clone(), horizon: case.1, trace: trace?, structure: None, timing: None })
        };
        self.cases.iter().zip(traces).map(run).collect()
    }

    fn trace_one(&self, case: usize, limits: &Limits) -> Option<Trace> {
        let (spec, horizon) = self.cases[case];
        match engines::build(spec, self.system, horizon.step) {
            Ok(mut engine) => trace::trace_against(self.truth, self.system, engine.as_mut(), horizon, limits),
            Err(unsupported) => {
                limits.taken.fetch_add(horizon.steps, Ordering::Relaxed);
                Some(Trace::unsupported(unsupported.what))
            }
        }
    }
}

/// Times the runs that were completed, and those that were over budget as far as they came. False where interrupted.
/// `taken` counts turns, [`Effort::turns`] for each run.
pub(super) fn time(
    system: &System,
    runs: &mut [&mut Run],
    effort: Effort,
    interrupted: &AtomicBool,
    taken: &AtomicU64,
) -> bool {
    let worth = |run: &Run| match run.trace.outcome {
        Outcome::Completed | Outcome::OverBudget { .. } => run.trace.steps > 0,
        Outcome::Diverged { .. } | Outcome::NotConverged { .. } | Outcome::Unsupported { .. } => false,
    };
    let timings = {
        let candidates: Vec<Candidate> = runs
            .iter()
            .filter(|run| worth(run))
            .map(|run| Candidate {
                build: Box::new(|| engines::build(&run.engine, system, run.horizon.step).ok()),
                steps: run.trace.steps,
            })
            .collect();
        let skipped = runs.len() - candidates.len();
        taken.fetch_add(skipped as u64 * effort.turns(), Ordering::Relaxed);
        clock::time(&candidates, effort, interrupted, taken)
    };
    let Some(timings) = timings else { return false };
    for (run, timing) in runs.iter_mut().filter(|run| worth(run)).zip(timings) {
        run.timing = timing;
    }
    true
}
