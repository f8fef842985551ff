//! The finding of a report in a few words, with figures.

use super::number::{duration, plain, written};
use super::record::{Outcome, Report, Run};

/// The step size, s, that a comparison in one sentence is made at: the one nearest to 1 ms at which the most engines
/// completed their run.
pub fn common_step(report: &Report) -> Option<f64> {
    let completed = |step: f64| report.runs.iter().filter(|r| r.step_s == step && energy_error(r).is_some()).count();
    let far = |step: f64| (step / 1e-3).ln().abs();
    report
        .runs
        .iter()
        .map(|r| r.step_s)
        .filter(|&step| completed(step) > 0)
        .min_by(|&a, &b| completed(b).cmp(&completed(a)).then(far(a).total_cmp(&far(b))))
}

/// Compares the engine with the smallest energy error with the next best one, at one step size. Where an engine has a
/// time-level-corrected error, the smaller of the two counts.
pub fn sentence(report: &Report) -> String {
    let Some(step) = common_step(report) else {
        return "No engine completed a run of this scene.".to_string();
    };
    let mut runs: Vec<(&Run, f64)> = report
        .runs
        .iter()
        .filter(|r| r.step_s == step)
        .filter_map(|run| energy_error(run).map(|error| (run, error)))
        .collect();
    runs.sort_by(|a, b| a.1.total_cmp(&b.1));
    let Some(((best, error), others)) = runs.split_first() else {
        return "No engine completed a run of this scene.".to_string();
    };
    let mut text = format!(
        "At a step of {} over {} s, {} keeps the energy to {} of its scale",
        duration(step),
        plain(best.duration_s, 4),
        best.engine,
        written(*error)
    );
    if let Some(joints) = &best.constraint {
        text += &format!(" and the joints to {} m or rad", written(joints.max_position));
    }
    text += &cost(best);
    if let Some((next, next_error)) = others.first() {
        text += &format!("; the next best, {}, errs by {}", next.engine, written(*next_error));
        if let Some(joints) = &next.constraint {
            text += &format!(" and {}", written(joints.max_position));
        }
        text += &cost(next);
    }
    text += ".";
    let unfinished: Vec<String> = report
        .runs
        .iter()
        .filter(|r| r.step_s == step && r.outcome != Outcome::Completed)
        .map(|r| format!("{} ({})", r.engine, r.outcome.words()))
        .collect();
    if !unfinished.is_empty() {
        text += &format!(" Not finished at this step: {}.", unfinished.join(", "));
    }
    text
}

fn cost(run: &Run) -> String {
    run.time.as_ref().map(|t| format!(", at {} µs a step", plain(t.us_per_step, 2))).unwrap_or_default()
}

/// The smaller of the raw and the time-level-corrected error of a completed run.
fn energy_error(run: &Run) -> Option<f64> {
    let energy = run.energy.as_ref().filter(|_| run.outcome == Outcome::Completed)?;
    let corrected = energy.time_level_corrected.as_ref().map_or(f64::INFINITY, |e| e.max_relative_error);
    Some(energy.max_relative_error.min(corrected))
}
