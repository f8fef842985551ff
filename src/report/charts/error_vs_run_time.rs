//! `error_vs_run_time.png`: energy error and joint error against processor time, over the step sizes.

use super::axis::Axis;
use super::canvas::{self, ChartError};
use super::chart::Chart;
use super::panel::{Label, Panel, Words};
use super::{legend, style};
use crate::report::record::report::Report;
use crate::report::record::run::{Outcome, Run};
use crate::report::words::number::duration;

pub(crate) const CHART: Chart = Chart {
    file: "error_vs_run_time.png",
    caption: "Energy error and joint error against processor time for every engine, one marker a step size; lower left \
              is better",
    draw,
};

/// One panel: its words and the error of a run, with a second figure drawn hollow.
struct Subject {
    heading: &'static str,
    y: &'static str,
    error: fn(&Run) -> Option<f64>,
    hollow: fn(&Run) -> Option<f64>,
}

const SUBJECTS: [Subject; 2] = [
    Subject {
        heading: "energy",
        y: "largest relative energy error",
        error: |run| run.energy.as_ref().map(|e| e.max_relative_error),
        hollow: |run| run.energy.as_ref()?.time_level_corrected.as_ref().map(|e| e.max_relative_error),
    },
    Subject {
        heading: "joints",
        y: "largest joint error, m or rad",
        error: |run| run.constraint.as_ref().map(|c| c.max_position),
        hollow: |_| None,
    },
];

fn cost(run: &Run) -> Option<f64> {
    run.time.as_ref().filter(|_| run.outcome == Outcome::Completed).map(|t| t.s_per_simulated_s)
}

fn draw(report: &Report) -> Result<Option<Vec<u8>>, ChartError> {
    let Some(x) = Axis::decades(report.runs.iter().filter_map(cost), -9, 6) else { return Ok(None) };
    let panels: Vec<(&Subject, Axis)> = SUBJECTS
        .iter()
        .filter_map(|subject| {
            let timed = report.runs.iter().filter(|r| cost(r).is_some());
            let values = timed.flat_map(|r| [(subject.error)(r), (subject.hollow)(r)]).flatten();
            Some((subject, Axis::decades(values, -18, 2)?))
        })
        .collect();
    if panels.is_empty() {
        return Ok(None);
    }
    let looks = style::looks(report);
    let title = format!("Error against run time: {}", report.scene.name);
    let subtitle = "One marker a step size; lower left is better. Largest error of the run; CPU time of the stepping \
                    alone, one thread";
    canvas::render(|area| {
        let area = legend::frame(area, &title, subtitle, &looks, &notes(report))?;
        let width = area.dim_in_pixel().0 / panels.len() as u32;
        let mut rest = area;
        for (subject, y) in &panels {
            let (panel_area, right) = rest.split_horizontally(width);
            let words = Words { heading: subject.heading, x: "CPU seconds per simulated second", y: Some(subject.y) };
            let panel = Panel::new(&panel_area, x, *y, words)?;
            let (mut labels, mut lines) = (Vec::new(), Vec::new());
            for (engine, look) in looks.iter().rev() {
                let runs: Vec<&Run> = report.runs.iter().filter(|r| r.engine == *engine && cost(r).is_some()).collect();
                lines.extend(engine_lines(&panel, &runs, *look, subject)?);
                labels.extend(ends(&runs, *look, subject));
            }
            panel.labels(&labels, &lines)?;
            rest = right;
        }
        Ok(())
    })
    .map(Some)
}

/// Draws an engine's lines and markers and returns the points that they go through.
fn engine_lines(
    panel: &Panel,
    runs: &[&Run],
    look: style::Look,
    subject: &Subject,
) -> Result<[Vec<(f64, f64)>; 2], ChartError> {
    let points = |error: fn(&Run) -> Option<f64>| -> Vec<(f64, f64)> {
        runs.iter().filter_map(|r| Some((cost(r)?, error(r)?))).collect()
    };
    let (solid, hollow) = (points(subject.error), points(subject.hollow));
    panel.line(&hollow, look, 2, true)?;
    for point in &hollow {
        panel.mark(*point, look, true)?;
    }
    panel.line(&solid, look, 3, false)?;
    for point in &solid {
        panel.mark(*point, look, false)?;
    }
    Ok([solid, hollow])
}

/// The step sizes at the two ends of an engine's line, which the others lie between.
fn ends(runs: &[&Run], look: style::Look, subject: &Subject) -> Vec<Label> {
    let labels: Vec<Label> = runs
        .iter()
        .filter_map(|r| Some(Label { point: (cost(r)?, (subject.error)(r)?), words: duration(r.step_s), look }))
        .collect();
    let last = labels.len().saturating_sub(1);
    labels.into_iter().enumerate().filter(|(i, _)| *i == 0 || *i == last).map(|(_, label)| label).collect()
}

fn notes(report: &Report) -> Vec<String> {
    let mut notes = Vec::new();
    if report.runs.iter().any(|r| cost(r).is_some() && (SUBJECTS[0].hollow)(r).is_some()) {
        notes.push(
            "Hollow, dashed: energy of the same runs with positions moved back to the time of the velocities."
                .to_string(),
        );
    }
    let missing: Vec<String> = report
        .runs
        .iter()
        .filter(|r| r.outcome != Outcome::Completed)
        .map(|r| format!("{} at {} ({})", r.engine, duration(r.step_s), r.outcome.words()))
        .collect();
    if !missing.is_empty() {
        notes.push(format!("Not shown: {}.", missing.join("; ")));
    }
    notes
}
