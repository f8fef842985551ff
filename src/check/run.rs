//! The runs that bounds need, each taken once.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

use super::Requirement;
use crate::engines::Spec;
use crate::measure::Horizon;
use crate::measure::comparison::{Comparison, Progress, Results};
use crate::mechanics::System;

/// Engines that run over the same horizon and, where they are timed, take turns.
#[derive(Clone, Debug)]
pub struct Unit {
    pub engines: Vec<Spec>,
    pub horizon: Horizon,
    pub timed: bool,
}

/// How the runs are taken.
#[derive(Debug)]
pub struct Settings<'a> {
    /// Threads for runs that are not timed.
    pub jobs: usize,
    /// May be set from outside at any time.
    pub interrupted: &'a AtomicBool,
    /// Counts steps, for a progress bar.
    pub taken: &'a AtomicU64,
}

/// The fewest runs that have every figure that is required.
pub fn units(requirements: &[Requirement]) -> Vec<Unit> {
    let mut units: Vec<Unit> = Vec::new();
    for required in requirements.iter().filter(|r| r.timed()) {
        required.engines().for_each(|spec| add(&mut units, spec, required.horizon, true));
    }
    for required in requirements.iter().filter(|r| !r.timed()) {
        add(&mut units, &required.engine, required.horizon, false);
    }
    units
}

/// Adds a run unless there is one already. Timed engines over one horizon make up one unit.
pub fn add(units: &mut Vec<Unit>, spec: &Spec, horizon: Horizon, timed: bool) {
    let has = |unit: &Unit| unit.engines.iter().any(|e| e.to_string() == spec.to_string());
    if units.iter().any(|u| u.horizon == horizon && (u.timed || !timed) && has(u)) {
        return;
    }
    match units.iter_mut().find(|u| timed && u.timed && u.horizon == horizon) {
        Some(unit) => unit.engines.push(spec.clone()),
        None => units.push(Unit { engines: vec![spec.clone()], horizon, timed }),
    }
}

/// Steps that the units take together.
pub fn steps(units: &[Unit]) -> u64 {
    units.iter().map(|u| u.engines.len() as u64 * u.horizon.steps).sum()
}

/// Takes the runs, those that are not timed on several threads.
pub fn run(system: &System, units: &[Unit], settings: &Settings) -> Results {
    let take = |unit: &Unit| {
        let progress = Progress::default();
        let comparison = Comparison {
            system,
            engines: &unit.engines,
            horizons: &[unit.horizon],
            budget: Duration::MAX,
            jobs: 1,
            structure: false,
        };
        let results = match unit.timed {
            true => comparison.run(settings.interrupted, &progress),
            false => comparison.trace(None, settings.interrupted, &progress),
        };
        settings.taken.fetch_add(unit.engines.len() as u64 * unit.horizon.steps, Ordering::Relaxed);
        results
    };
    let mut order: Vec<usize> = (0..units.len()).filter(|&i| !units[i].timed).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(units[i].horizon.steps));
    let next = AtomicUsize::new(0);
    let found: Vec<Mutex<Option<Results>>> = units.iter().map(|_| Mutex::new(None)).collect();
    std::thread::scope(|scope| {
        for _ in 0..settings.jobs.clamp(1, order.len().max(1)) {
            scope.spawn(|| {
                while let Some(&i) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let results = take(&units[i]);
                    if let Ok(mut slot) = found[i].lock() {
                        *slot = Some(results);
                    }
                }
            });
        }
    });
    let mut all = Results { runs: Vec::new(), interrupted: false };
    for (unit, slot) in units.iter().zip(found) {
        let taken = slot.into_inner().ok().flatten();
        let results = if unit.timed { Some(take(unit)) } else { taken };
        all.interrupted |= results.as_ref().is_none_or(|r| r.interrupted);
        all.runs.extend(results.into_iter().flat_map(|r| r.runs));
    }
    all
}
