//! The finding of a report in a few words, with figures.

use super::number::{duration, plain, written};
use crate::report::record::report::Report;
use crate::report::record::run::{Energy, Outcome, Run};

/// The step size, s, that a comparison in one sentence is made at: the one nearest to 1 ms at which the most engines
/// completed their run.
pub(crate) fn common_step(report: &Report) -> Option<f64> {
    let completed =
        |step: f64| report.runs.iter().filter(|r| r.step_s == step && completed_energy(r).is_some()).count();
    let far = |step: f64| (step / 1e-3).ln().abs();
    report
        .runs
        .iter()
        .map(|r| r.step_s)
        .filter(|&step| completed(step) > 0)
        .min_by(|&a, &b| completed(b).cmp(&completed(a)).then(far(a).total_cmp(&far(b))))
}

/// Compares the run with the smallest energy error with the best one of another engine (another setting where there is
/// no other engine), at one step size, by the states as the engines return them. Where an engine has a smaller
/// time-level-corrected error it is told beside.
pub fn sentence(report: &Report) -> String {
    let Some(step) = common_step(report) else {
        return "No engine completed a run of this scene.".to_string();
    };
    let mut runs: Vec<(&Run, &Energy)> = report
        .runs
        .iter()
        .filter(|r| r.step_s == step)
        .filter_map(|run| completed_energy(run).map(|energy| (run, energy)))
        .collect();
    runs.sort_by(|a, b| a.1.max_relative_error.total_cmp(&b.1.max_relative_error));
    let Some(((best, energy), others)) = runs.split_first() else {
        return "No engine completed a run of this scene.".to_string();
    };
    let mut text = format!(
        "At a step of {} over {} s, {} keeps the energy to {} of its scale{}",
        duration(step),
        plain(best.duration_s, 4),
        best.engine,
        written(energy.max_relative_error),
        corrected(energy)
    );
    if let Some(joints) = &best.constraint {
        text += &format!(" and the joints to {} m or rad", written(joints.max_position));
    }
    text += &cost(best);
    let other = others.iter().find(|(run, _)| engine(run) != engine(best));
    if let Some((next, energy)) = other.or(others.first()) {
        let rank = if other.is_none() {
            format!("the next best, {},", next.engine)
        } else if engine(next) == next.engine {
            next.engine.clone()
        } else {
            format!("the best of {}, {},", engine(next), next.engine)
        };
        text += &format!("; {rank} errs by {}{}", written(energy.max_relative_error), corrected(energy));
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

/// The engine's name without its settings.
fn engine(run: &Run) -> &str {
    run.engine.split(':').next().unwrap_or_default()
}

fn cost(run: &Run) -> String {
    run.time.as_ref().map(|t| format!(", at {} µs a step", plain(t.us_per_step, 2))).unwrap_or_default()
}

/// The error with positions moved back to the time of the velocities, where that makes it less than half.
fn corrected(energy: &Energy) -> String {
    match &energy.time_level_corrected {
        Some(corrected) if corrected.max_relative_error < 0.5 * energy.max_relative_error => format!(
            " ({} with its positions moved back to the time of its velocities)",
            written(corrected.max_relative_error)
        ),
        _ => String::new(),
    }
}

/// The energy errors of a completed run.
fn completed_energy(run: &Run) -> Option<&Energy> {
    run.energy.as_ref().filter(|_| run.outcome == Outcome::Completed)
}
