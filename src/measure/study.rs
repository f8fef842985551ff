//! A comparison with all that belongs to it: the truth, the parity of the engines, and a sweep of their settings.

use std::sync::atomic::{AtomicBool, Ordering};

use super::batch::{self, Batch};
use super::comparison::{Comparison, Progress, Results};
use super::cost::clock::{self, Effort};
use super::cost::ranking;
use super::cost::sweep::{self, Setting};
use super::parity::{Parity, parity};
use super::run::Run;
use super::truth;
use super::truth::trusted::Truth;
use crate::engines::{self, Spec};
use crate::mechanics::System;

/// What is studied.
#[derive(Debug)]
pub struct Study<'a> {
    pub comparison: Comparison<'a>,
    /// Settings that are tried beside the engines of the comparison; none are, where it is empty.
    pub sweep: &'a [Setting],
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Findings {
    pub results: Results,
    /// `None` where it was not known at any time, or interrupted.
    pub truth: Option<Truth>,
    pub parity: Vec<Parity>,
    pub sweep: Option<Sweep>,
    /// Processor time of the loop around a step, s.
    pub overhead: Option<f64>,
}

/// The runs of a sweep, of the engines that have the means for the scene.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Simulated time, s.
    pub until: f64,
    /// Largest estimated error of the truth until then.
    pub error_estimate: f64,
    pub runs: Vec<Run>,
}

impl Sweep {
    /// All runs in a few rounds, then those that decide ranks in many. False where interrupted.
    fn time(&mut self, system: &System, interrupted: &AtomicBool, progress: &Progress) -> bool {
        let mut all: Vec<&mut Run> = self.runs.iter_mut().collect();
        if !batch::time(system, &mut all, Effort::SWEEP, interrupted, &progress.timed) {
            return false;
        }
        let contested = ranking::contested(&self.runs, self.error_estimate);
        progress.to_rank.store(contested.len() as u64 * Effort::RANKING.turns(), Ordering::Relaxed);
        let is_contested = |(i, run): (usize, _)| contested.contains(&i).then_some(run);
        let mut runs: Vec<&mut Run> = self.runs.iter_mut().enumerate().filter_map(is_contested).collect();
        batch::time(system, &mut runs, Effort::RANKING, interrupted, &progress.ranked)
    }
}

impl Study<'_> {
    /// Steps that the traced runs take together, at most.
    pub fn steps(&self) -> u64 {
        self.comparison.steps() + self.sweep.iter().flat_map(|s| s.counts).sum::<u64>()
    }

    /// Turns that the timed runs take, at most.
    pub fn turns(&self) -> u64 {
        let swept = self.sweep.iter().map(|s| s.counts.len()).sum::<usize>();
        self.comparison.turns() + swept as u64 * Effort::SWEEP.turns()
    }

    /// Runs everything; `interrupted` may be set from outside at any time.
    pub fn run(&self, interrupted: &AtomicBool, progress: &Progress) -> Findings {
        let &Comparison { system, engines, horizons, budget, .. } = &self.comparison;
        let truth = truth::find(system, horizons, budget, interrupted).filter(|truth| !truth.times.is_empty());
        let parity = parity(system, system, &self.engines(engines));
        let mut results = self.comparison.trace(truth.as_ref(), interrupted, progress);
        let mut sweep = match &truth {
            Some(truth) if !results.interrupted => self.trace_sweep(truth, interrupted, progress),
            _ => None,
        };
        if !results.interrupted {
            let timed = self.comparison.time(&mut results.runs, interrupted, progress)
                && sweep.as_mut().is_none_or(|sweep| sweep.time(system, interrupted, progress));
            results.interrupted = !timed;
        }
        let overhead = if results.interrupted { None } else { clock::overhead() };
        Findings { results, truth, parity, sweep, overhead }
    }

    /// The engines of the comparison and of the sweep, each once.
    fn engines(&self, compared: &[Spec]) -> Vec<Spec> {
        let mut all: Vec<Spec> = Vec::new();
        for spec in compared.iter().chain(self.sweep.iter().map(|setting| &setting.engine)) {
            if !all.iter().any(|other| other.to_string() == spec.to_string()) {
                all.push(spec.clone());
            }
        }
        all
    }

    fn trace_sweep(&self, truth: &Truth, interrupted: &AtomicBool, progress: &Progress) -> Option<Sweep> {
        let &Comparison { system, horizons, budget, jobs, .. } = &self.comparison;
        let duration = horizons.iter().map(|h| h.end).fold(0.0, f64::max);
        let until = sweep::span(duration, truth.trusted_until)?;
        let truth = truth.at_multiples(until / sweep::SAMPLES as f64, until);
        let supported = |setting: &&Setting| engines::build(&setting.engine, system, until).is_ok();
        let cases = self
            .sweep
            .iter()
            .filter(supported)
            .flat_map(|setting| setting.counts.iter().map(|n| (&setting.engine, sweep::horizon(until, *n))))
            .collect();
        let batch = Batch { system, cases, truth: Some(&truth), budget, together: Some(budget), jobs };
        let runs: Vec<Run> = batch.trace(interrupted, &progress.traced).into_iter().flatten().collect();
        (!runs.is_empty() && !interrupted.load(Ordering::Relaxed)).then_some(Sweep {
            until,
            error_estimate: truth.error_estimate(),
            runs,
        })
    }
}
