//! The truth that a cell is measured against: the reference at two tolerances that agree or, where that does not come
//! far, a fine run of the core that agrees with one at half its step.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use super::budget;
use super::scan::{FineRun, Scan};
use super::watch::{SAMPLES, Watched};
use crate::engines::{self, Spec, reference};
use crate::measure::Horizon;
use crate::measure::outcome::{Limits, Outcome};
use crate::measure::scales::LinkLengths;
use crate::measure::trace::trace;
use crate::measure::truth::trusted::disagreement;
use crate::mechanics::{State, System};
use crate::numeric::larger;

/// Two runs that differ by less than this are taken for the truth: a tenth of what [`super::class::ACCURATE`] allows.
pub(crate) const AGREE: f64 = 1e-4;

/// The truth must be known over at least this part of a run, or nothing in the scene is called accurate.
pub(crate) const LEAST_KNOWN: f64 = 0.25;

/// What each tolerance of the reference may cost, nominal s: stiff springs, long chains and fast spins are beyond it.
const REFERENCE: f64 = 2.0;

/// States of a scene at the sample times, as far as they are known.
#[derive(Clone, Debug)]
pub struct TrueSamples {
    /// At `t = k T / SAMPLES` for `k = 1, 2, ...`; as many as can be trusted.
    states: Vec<State>,
    /// What positions are divided by, m.
    length: f64,
    /// How far the two runs differ over the states that are trusted.
    pub disagreement: f64,
    /// How it was found, in words.
    pub method: String,
}

impl TrueSamples {
    /// No truth to be had.
    pub fn nothing() -> TrueSamples {
        TrueSamples { states: Vec::new(), length: 1.0, disagreement: 0.0, method: String::new() }
    }

    /// The part of the run over which the truth is known.
    pub fn part(&self) -> f64 {
        self.states.len() as f64 / SAMPLES as f64
    }

    /// The largest difference of a run's samples from the truth. `None` where the truth is not known for long enough or
    /// the run did not come that far.
    pub fn error(&self, samples: &[(u64, State)]) -> Option<f64> {
        let known = self.states.len() as u64;
        let judged: Vec<f64> = samples
            .iter()
            .filter(|(k, _)| *k <= known)
            .map(|(k, state)| disagreement(state, &self.states[*k as usize - 1], self.length))
            .collect();
        let enough = self.part() >= LEAST_KNOWN && !judged.is_empty();
        enough.then(|| judged.into_iter().fold(0.0, larger))
    }
}

/// Finds the truth of a scene at a value of its scan: that of the reference, whose coordinates and whose code are not
/// those of the engines that are judged, unless a fine run comes further. `None` where it was interrupted; a truth
/// without states where there is none to be had.
pub fn find(scan: &Scan, value: f64, system: &System, interrupted: &AtomicBool) -> Option<TrueSamples> {
    let Some((spec, steps)) = plan(scan, value) else { return Some(TrueSamples::nothing()) };
    let duration = scan.duration(value, 1.0);
    let (independent, ended) = by_reference(system, duration, interrupted);
    if interrupted.load(Ordering::Relaxed) {
        return None;
    }
    if ended && independent.part() >= LEAST_KNOWN {
        return Some(independent);
    }
    let length = LinkLengths::of(system).longest_path;
    let run = |steps: u64| fine_run(&spec, system, duration, steps, interrupted);
    let (coarse, fine) = (run(steps)?, run(2 * steps)?);
    let differences: Vec<f64> = coarse.iter().zip(&fine).map(|(a, b)| disagreement(&a.1, &b.1, length)).collect();
    let known = differences.iter().take_while(|d| **d <= AGREE).count();
    let disagreement = differences[..known].iter().copied().fold(0.0, f64::max);
    let method = format!("{spec} at {:.1e} s and half of that", duration / steps as f64);
    let states = fine.into_iter().take(known).map(|(_, state)| state).collect();
    let ours = TrueSamples { states, length, disagreement, method };
    let longer = independent.part() >= LEAST_KNOWN && independent.part() >= ours.part();
    Some(if longer { independent } else { ours })
}

/// The samples of the reference as far as its two tolerances agree, within the cost [`REFERENCE`]; and whether they end
/// at the end of the run or where the two part, and not where the means were spent.
fn by_reference(system: &System, duration: f64, interrupted: &AtomicBool) -> (TrueSamples, bool) {
    let length = LinkLengths::of(system).longest_path;
    let times: Vec<f64> = (1..=SAMPLES).map(|k| k as f64 * duration / SAMPLES as f64).collect();
    let mut differences = Vec::new();
    let mut agree = |a: &State, b: &State| {
        let apart = disagreement(a, b, length);
        differences.push(apart);
        apart <= AGREE && !interrupted.load(Ordering::Relaxed)
    };
    let found = reference::trajectory_within(system, &times, reference_steps(system), &mut agree);
    let mut states = found.map(|trajectory| trajectory.states).unwrap_or_default();
    let known = differences.iter().take_while(|d| **d <= AGREE).count();
    states.truncate(known);
    let disagreement = differences[..known].iter().copied().fold(0.0, f64::max);
    let ended = known as u64 == SAMPLES || known < differences.len();
    (TrueSamples { states, length, disagreement, method: "reference".to_string() }, ended)
}

/// Steps of either tolerance that the reference may try.
fn reference_steps(system: &System) -> u64 {
    (REFERENCE / budget::reference_step_seconds(system)) as u64
}

/// The engine of the truth of a case, and the number of steps of its coarser run.
fn plan(scan: &Scan, value: f64) -> Option<(Spec, u64)> {
    let FineRun { engine, step } = scan.truth?;
    let part = scan.duration(value, 1.0) / SAMPLES as f64;
    let per_part = (part / (step(value) * (scan.clock)(value)) * (1.0 - 1e-9)).ceil().max(1.0) as u64;
    Some((Spec::parse(engine).ok()?, per_part * SAMPLES))
}

/// What the truth of a case costs, nominal s: a quarter of what the two tolerances of the reference may, which is more
/// than the mean over all cases, and the fine runs.
#[cfg(test)]
pub fn cost(scan: &Scan, value: f64, bodies: usize) -> f64 {
    plan(scan, value).map_or(0.0, |(spec, steps)| 0.5 * REFERENCE + budget::seconds(&spec, bodies, 3 * steps))
}

/// The samples of a run, as far as it came.
fn fine_run(
    spec: &Spec,
    system: &System,
    duration: f64,
    steps: u64,
    interrupted: &AtomicBool,
) -> Option<Vec<(u64, State)>> {
    let horizon = Horizon { step: duration / steps as f64, steps, end: duration };
    let Ok(engine) = engines::build(spec, system, horizon.step) else { return Some(Vec::new()) };
    let mut watched = Watched::new(engine, system, horizon);
    let limits = Limits { budget: Duration::MAX, interrupted, taken: &AtomicU64::new(0) };
    let trace = trace(system, &mut watched, horizon, &limits)?;
    let lost = matches!(trace.outcome, Outcome::Diverged { .. });
    Some(if lost { Vec::new() } else { watched.samples })
}
