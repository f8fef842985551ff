//! `error_vs_run_time.png`: energy error and joint error against processor time, over the step sizes.

use super::super::number::duration;
use super::super::record::{Outcome, Report, Run};
use super::axis::Axis;
use super::canvas::{self, ChartError};
use super::panel::{Panel, Words};
use super::{Chart, legend, style};

pub const CHART: Chart = Chart {
    file: "error_vs_run_time.png",
    caption: "Energy error and joint error against processor time for every engine, one marker a step size; lower left is \
              better",
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
    let subtitle = "One marker a step size; lower left is better. Largest errors over the run; processor time of the stepping \
                    alone, one thread, median of several repeats";
    canvas::render(|area| {
        let area = legend::frame(area, &title, subtitle, &looks, &notes(report))?;
        let width = area.dim_in_pixel().0 / panels.len() as u32;
        let mut rest = area;
        for (subject, y) in &panels {
            let (panel_area, right) = rest.split_horizontally(width);
            let words = Words { heading: subject.heading, x: "CPU seconds per simulated second", y: Some(subject.y) };
            let panel = Panel::new(&panel_area, x, *y, words)?;
            for (engine, look) in looks.iter().rev() {
                let runs: Vec<&Run> = report.runs.iter().filter(|r| r.engine == *engine).collect();
                engine_line(&panel, &runs, *look, subject)?;
            }
            rest = right;
        }
        Ok(())
    })
    .map(Some)
}

fn engine_line(panel: &Panel, runs: &[&Run], look: style::Look, subject: &Subject) -> Result<(), ChartError> {
    let points = |error: fn(&Run) -> Option<f64>| -> Vec<(f64, f64)> {
        runs.iter().filter_map(|r| Some((cost(r)?, error(r)?))).collect()
    };
    let hollow = points(subject.hollow);
    panel.line(&hollow, look, 2, true)?;
    for point in &hollow {
        panel.mark(*point, look, true)?;
    }
    let solid = points(subject.error);
    panel.line(&solid, look, 3, false)?;
    for point in &solid {
        panel.mark(*point, look, false)?;
    }
    // The two ends of the line say which steps the others lie between.
    let timed: Vec<&&Run> = runs.iter().filter(|r| cost(r).is_some() && (subject.error)(r).is_some()).collect();
    for (run, point) in timed.iter().zip(&solid) {
        let end = run.step_s == timed[0].step_s || run.step_s == timed[timed.len() - 1].step_s;
        if end {
            panel.label(*point, &duration(run.step_s), look)?;
        }
    }
    Ok(())
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
