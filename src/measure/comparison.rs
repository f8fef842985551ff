//! Several engines at several step sizes on one system: all traced runs, then all timed ones.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use super::Horizon;
use super::batch::{self, Batch};
use super::cost::clock::Effort;
use super::outcome::Limits;
use super::run::Run;
use super::structure::{self, Structure};
use super::threads;
use super::truth::trusted::Truth;
use crate::engines::Spec;
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
    /// Steps of traced runs, runs of which a few steps were examined, turns of timed ones, and turns of those that are
    /// timed again to rank them.
    pub traced: AtomicU64,
    pub examined: AtomicU64,
    pub timed: AtomicU64,
    pub ranked: AtomicU64,
    /// Turns to be taken for the ranking; none before it is known how many.
    pub to_rank: AtomicU64,
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
    pub(crate) fn examinations(&self) -> u64 {
        if self.structure { (self.engines.len() * self.horizons.len()) as u64 } else { 0 }
    }

    /// Turns that the timed runs take at most.
    pub fn turns(&self) -> u64 {
        (self.engines.len() * self.horizons.len()) as u64 * Effort::FULL.turns()
    }

    /// Runs everything; `interrupted` may be set from outside at any time.
    pub fn run(&self, truth: Option<&Truth>, interrupted: &AtomicBool, progress: &Progress) -> Results {
        let mut results = self.trace(truth, interrupted, progress);
        if !results.interrupted {
            results.interrupted = !self.time(&mut results.runs, interrupted, progress);
        }
        results
    }

    /// The traced runs alone, their positions compared with the truth where it is known, and what a few steps of each
    /// preserve.
    pub fn trace(&self, truth: Option<&Truth>, interrupted: &AtomicBool, progress: &Progress) -> Results {
        let cases: Vec<(&Spec, Horizon)> =
            self.engines.iter().flat_map(|spec| self.horizons.iter().map(move |h| (spec, *h))).collect();
        let &Comparison { system, budget, jobs, .. } = self;
        let batch = Batch { system, cases: cases.clone(), truth, budget, together: None, jobs };
        let found = batch.trace(interrupted, &progress.traced);
        let missing = found.iter().any(Option::is_none);
        let structures = self.examine_all(&cases, &Limits { budget, interrupted, taken: &progress.examined });
        let runs = found.into_iter().zip(structures);
        Results {
            runs: runs.filter_map(|(run, structure)| Some(Run { structure, ..run? })).collect(),
            interrupted: missing,
        }
    }

    /// Examines a few steps of every case, all from the same state.
    fn examine_all(&self, cases: &[(&Spec, Horizon)], limits: &Limits) -> Vec<Option<Structure>> {
        if !self.structure || limits.interrupted.load(Ordering::Relaxed) {
            return vec![None; cases.len()];
        }
        let shortest = cases.iter().map(|(_, horizon)| horizon.end).fold(f64::INFINITY, f64::min);
        let (state, at) = structure::examined_state(self.system, shortest);
        let order: Vec<usize> = (0..cases.len()).collect();
        threads::map(self.jobs, order.len(), &order, |i| {
            let (spec, horizon) = cases[i];
            let found = structure::examine(self.system, spec, horizon.step, (&state, at), limits);
            limits.taken.fetch_add(1, Ordering::Relaxed);
            found
        })
    }

    /// Times traced runs. False where interrupted.
    pub(super) fn time(&self, runs: &mut [Run], interrupted: &AtomicBool, progress: &Progress) -> bool {
        let mut runs: Vec<&mut Run> = runs.iter_mut().collect();
        batch::time(self.system, &mut runs, Effort::FULL, interrupted, &progress.timed)
    }
}
