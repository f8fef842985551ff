//! The runs that bounds need, each taken once.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use super::need::Need;
use super::requirement::Requirement;
use crate::engines::Spec;
use crate::measure::Horizon;
use crate::measure::comparison::{Comparison, Progress, Results};
use crate::measure::study::Findings;
use crate::measure::threads;
use crate::measure::truth;
use crate::measure::truth::trusted::Truth;
use crate::mechanics::System;

/// Wall-clock time that the search for the truth of a scene may take.
pub const TRUTH_BUDGET: Duration = Duration::from_secs(60);

/// Engines that run over the same horizon and, where they are timed, take turns.
#[derive(Clone, Debug)]
pub(crate) struct Unit {
    pub engines: Vec<Spec>,
    pub horizon: Horizon,
    pub need: Need,
}

/// How the runs are taken.
#[derive(Debug)]
pub(crate) struct Settings<'a> {
    /// Threads for runs that are not timed.
    pub jobs: usize,
    /// May be set from outside at any time.
    pub interrupted: &'a AtomicBool,
    /// Counts steps, for a progress bar.
    pub taken: &'a AtomicU64,
}

/// The fewest runs that have every figure that is required.
pub(crate) fn units(requirements: &[Requirement]) -> Vec<Unit> {
    let mut units: Vec<Unit> = Vec::new();
    let mut order: Vec<&Requirement> = requirements.iter().collect();
    order.sort_by_key(|required| !required.need().timed);
    for required in order {
        required.engines().for_each(|spec| add(&mut units, spec, required.horizon, required.need()));
    }
    units
}

/// Adds a run, or a need to the one that there is. Timed engines over one horizon make up one unit.
pub(crate) fn add(units: &mut Vec<Unit>, spec: &Spec, horizon: Horizon, need: Need) {
    let has = |unit: &Unit| unit.engines.iter().any(|e| e.to_string() == spec.to_string());
    let there = units.iter_mut().find(|u| u.horizon == horizon && (u.need.timed || !need.timed) && has(u));
    if let Some(unit) = there {
        unit.need = unit.need.or(need);
        return;
    }
    match units.iter_mut().find(|u| need.timed && u.need.timed && u.horizon == horizon) {
        Some(unit) => {
            unit.engines.push(spec.clone());
            unit.need = unit.need.or(need);
        }
        None => units.push(Unit { engines: vec![spec.clone()], horizon, need }),
    }
}

/// Steps that the units take together.
pub(crate) fn steps(units: &[Unit]) -> u64 {
    units.iter().map(|u| u.engines.len() as u64 * u.horizon.steps).sum()
}

/// Takes the runs, those that are not timed on several threads, after the truth where one of them is compared with it.
pub(crate) fn run(system: &System, units: &[Unit], settings: &Settings) -> Findings {
    let compared: Vec<Horizon> = units.iter().filter(|u| u.need.compared).map(|u| u.horizon).collect();
    let truth = match compared.is_empty() {
        true => None,
        false => truth::find(system, &compared, TRUTH_BUDGET, settings.interrupted).filter(|t| !t.times.is_empty()),
    };
    let results = take_all(system, units, truth.as_ref(), settings);
    Findings { results, truth, parity: Vec::new(), sweep: None, overhead: None }
}

fn take_all(system: &System, units: &[Unit], truth: Option<&Truth>, settings: &Settings) -> Results {
    let take = |unit: &Unit| {
        let progress = Progress::default();
        let comparison = Comparison {
            system,
            engines: &unit.engines,
            horizons: &[unit.horizon],
            budget: Duration::MAX,
            jobs: 1,
            structure: unit.need.examined,
        };
        let truth = truth.filter(|_| unit.need.compared);
        let results = match unit.need.timed {
            true => comparison.run(truth, settings.interrupted, &progress),
            false => comparison.trace(truth, settings.interrupted, &progress),
        };
        settings.taken.fetch_add(unit.engines.len() as u64 * unit.horizon.steps, Ordering::Relaxed);
        results
    };
    let mut order: Vec<usize> = (0..units.len()).filter(|&i| !units[i].need.timed).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(units[i].horizon.steps));
    let found = threads::map(settings.jobs, units.len(), &order, |i| Some(take(&units[i])));
    let mut all = Results { runs: Vec::new(), interrupted: false };
    for (unit, taken) in units.iter().zip(found) {
        let results = if unit.need.timed { Some(take(unit)) } else { taken };
        all.interrupted |= results.as_ref().is_none_or(|r| r.interrupted);
        all.runs.extend(results.into_iter().flat_map(|r| r.runs));
    }
    all
}
