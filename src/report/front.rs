//! Error and cost of runs, and which of them no other run beats in both.

use super::record::{Outcome, Run};

/// The engine of a spec without its settings.
pub fn family(engine: &str) -> &str {
    engine.split(':').next().unwrap_or_default()
}

/// Runs by engine without settings, in the order of the runs.
pub fn families(runs: &[Run]) -> Vec<(&str, Vec<&Run>)> {
    let mut found: Vec<(&str, Vec<&Run>)> = Vec::new();
    for run in runs {
        let name = family(&run.engine);
        match found.iter_mut().find(|(family, _)| *family == name) {
            Some((_, members)) => members.push(run),
            None => found.push((name, vec![run])),
        }
    }
    found
}

/// Largest joint position error of a completed run, rad or m.
pub fn error(run: &Run) -> Option<f64> {
    run.accuracy.as_ref().filter(|_| run.outcome == Outcome::Completed).map(|a| a.max_joint_error)
}

/// Processor seconds a simulated second of a completed run.
pub fn cost(run: &Run) -> Option<f64> {
    run.time.as_ref().filter(|_| run.outcome == Outcome::Completed).map(|t| t.s_per_simulated_s)
}

/// The runs that no other is both as cheap as and more accurate than, the cheapest first.
pub fn front<'a>(runs: &[&'a Run]) -> Vec<&'a Run> {
    let mut known: Vec<(&Run, f64, f64)> =
        runs.iter().filter_map(|r| Some((*r, cost(r)?, error(r)?))).collect();
    known.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.2.total_cmp(&b.2)));
    let mut best = f64::INFINITY;
    known
        .into_iter()
        .filter(|(_, _, error)| {
            let better = *error < best;
            best = best.min(*error);
            better
        })
        .map(|(run, ..)| run)
        .collect()
}
