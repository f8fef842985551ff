//! Several engines at several step sizes on one system: all traced runs, then all timed ones.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

use super::Horizon;
use super::clock::{self, Candidate, Timing};
use super::structure::{self, Structure};
use super::trace::{self, Limits, Outcome, Trace};
use crate::engines::{self, Spec};
use crate::mechanics::System;

/// What is compared.
#[derive(Debug)]
pub struct Comparison<'a> {
    pub system: &'a System,
    /// Run in this order, engine by engine.
    pub engines: &'a [Spec],
    pub horizons: &'a [Horizon],
    /// Wall-clock time that one run may take.
    pub budget: Duration,
    /// Threads for the traced runs. Timed runs have the machine to themselves.
    pub jobs: usize,
    /// Examine the structure of a few steps of each run too.
    pub structure: bool,
}

/// How far a comparison is, for a progress bar.
#[derive(Debug, Default)]
pub struct Progress {
    /// Steps of traced runs, runs of which a few steps were examined, and turns of timed ones.
    pub traced: AtomicU64,
    pub examined: AtomicU64,
    pub timed: AtomicU64,
}

/// One engine at one step size.
#[derive(Clone, Debug)]
pub struct Run {
    pub engine: Spec,
    pub horizon: Horizon,
    pub trace: Trace,
    pub structure: Option<Structure>,
    pub timing: Option<Timing>,
}

/// The runs that were finished, in the order of the comparison.
#[derive(Clone, Debug)]
pub struct Results {
    pub runs: Vec<Run>,
    /// Some runs or their timing are missing because the comparison was interrupted.
    pub interrupted: bool,
}

impl Comparison<'_> {
    /// Steps that the traced runs take together.
    pub fn steps(&self) -> u64 {
        self.engines.len() as u64 * self.horizons.iter().map(|h| h.steps).sum::<u64>()
    }

    /// Runs of which a few steps are examined.
    pub fn examinations(&self) -> u64 {
        if self.structure { (self.engines.len() * self.horizons.len()) as u64 } else { 0 }
    }

    /// Turns that the timed runs take at most.
    pub fn turns(&self) -> u64 {
        (self.engines.len() * self.horizons.len() * (clock::ROUNDS + 1)) as u64
    }

    /// Runs everything; `interrupted` may be set from outside at any time.
    pub fn run(&self, interrupted: &AtomicBool, progress: &Progress) -> Results {
        let mut results = self.trace(interrupted, progress);
        if !results.interrupted {
            results.interrupted = !self.time_all(&mut results.runs, interrupted, progress);
        }
        results
    }

    /// The traced runs alone.
    pub fn trace(&self, interrupted: &AtomicBool, progress: &Progress) -> Results {
        let cases: Vec<(&Spec, Horizon)> =
            self.engines.iter().flat_map(|spec| self.horizons.iter().map(move |h| (spec, *h))).collect();
        let limits = Limits { budget: self.budget, interrupted, taken: &progress.traced };
        let traces = self.trace_all(&cases, &limits);
        let missing = traces.iter().any(Option::is_none);
        let structures = self.examine_all(&cases, &Limits { taken: &progress.examined, ..limits });
        let runs: Vec<Run> = cases
            .into_iter()
            .zip(traces)
            .zip(structures)
            .filter_map(|(((spec, horizon), trace), structure)| {
                Some(Run { engine: spec.clone(), horizon, trace: trace?, structure, timing: None })
            })
            .collect();
        Results { runs, interrupted: missing }
    }

    /// Traces all cases, those with the most steps first.
    fn trace_all(&self, cases: &[(&Spec, Horizon)], limits: &Limits) -> Vec<Option<Trace>> {
        let mut order: Vec<usize> = (0..cases.len()).collect();
        order.sort_by_key(|&i| std::cmp::Reverse(cases[i].1.steps));
        self.on_threads(&order, |i| self.trace_one(cases[i].0, cases[i].1, limits))
    }

    /// Examines a few steps of every case, all from the same state.
    fn examine_all(&self, cases: &[(&Spec, Horizon)], limits: &Limits) -> Vec<Option<Structure>> {
        if !self.structure || limits.interrupted.load(Ordering::Relaxed) {
            return vec![None; cases.len()];
        }
        let shortest = cases.iter().map(|(_, horizon)| horizon.end).fold(f64::INFINITY, f64::min);
        let (state, at) = structure::examined_state(self.system, shortest);
        let order: Vec<usize> = (0..cases.len()).collect();
        self.on_threads(&order, |i| {
            let (spec, horizon) = cases[i];
            let found = structure::examine(self.system, spec, horizon.step, (&state, at), limits);
            limits.taken.fetch_add(1, Ordering::Relaxed);
            found
        })
    }

    /// Does the pieces of work named by `order` on `jobs` threads; the results stand at their own places.
    fn on_threads<T: Send>(&self, order: &[usize], work: impl Fn(usize) -> Option<T> + Sync) -> Vec<Option<T>> {
        let next = AtomicUsize::new(0);
        let found: Vec<Mutex<Option<T>>> = order.iter().map(|_| Mutex::new(None)).collect();
        std::thread::scope(|scope| {
            for _ in 0..self.jobs.clamp(1, order.len().max(1)) {
                scope.spawn(|| {
                    while let Some(&i) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
                        let result = work(i);
                        if let Ok(mut slot) = found[i].lock() {
                            *slot = result;
                        }
                    }
                });
            }
        });
        found.into_iter().map(|slot| slot.into_inner().ok().flatten()).collect()
    }

    fn trace_one(&self, spec: &Spec, horizon: Horizon, limits: &Limits) -> Option<Trace> {
        match engines::build(spec, self.system, horizon.step) {
            Ok(mut engine) => trace::trace(self.system, engine.as_mut(), horizon, limits),
            Err(unsupported) => {
                limits.taken.fetch_add(horizon.steps, Ordering::Relaxed);
                Some(Trace::unsupported(unsupported.what))
            }
        }
    }

    /// Times the runs that were completed, and those that were over budget as far as they came. False where interrupted.
    fn time_all(&self, runs: &mut [Run], interrupted: &AtomicBool, progress: &Progress) -> bool {
        let worth = |run: &Run| match run.trace.outcome {
            Outcome::Completed | Outcome::OverBudget { .. } => run.trace.steps > 0,
            _ => false,
        };
        let timings = {
            let candidates: Vec<Candidate> = runs
                .iter()
                .filter(|run| worth(run))
                .map(|run| Candidate {
                    build: Box::new(|| engines::build(&run.engine, self.system, run.horizon.step).ok()),
                    steps: run.trace.steps,
                })
                .collect();
            let skipped = runs.len() - candidates.len();
            progress.timed.fetch_add((skipped * (clock::ROUNDS + 1)) as u64, Ordering::Relaxed);
            clock::time(&candidates, interrupted, &progress.timed)
        };
        let Some(timings) = timings else { return false };
        for (run, timing) in runs.iter_mut().filter(|run| worth(run)).zip(timings) {
            run.timing = timing;
        }
        true
    }
}
