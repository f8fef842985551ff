//! A quantity against time for every engine: one panel for each of a few step sizes, from coarse to fine, side by side.

use super::axis::Axis;
use super::canvas::{self, ChartError};
use super::panel::{Panel, Words};
use super::{legend, style};
use crate::report::record::report::Report;
use crate::report::record::run::{Outcome, Run};
use crate::report::record::series::Series;
use crate::report::words::number::{duration, plain};

/// Smallest value shown, a power of ten: below the roundoff of doubles.
const FLOOR: i32 = -18;

/// A run is drawn by its largest value in each of so many intervals of equal length. An error that swings through zero
/// would fill a logarithmic axis with spikes that say nothing.
pub(crate) const INTERVALS: usize = 40;

/// What is drawn.
pub(crate) struct Subject<'a> {
    pub title: String,
    pub subtitle: String,
    pub y: &'a str,
    /// Largest value shown, a power of ten; a line that goes beyond runs along the edge.
    pub ceiling: i32,
    /// The values of a run, one for each block of its series.
    pub values: fn(&Series) -> Vec<f64>,
    /// A second line, dashed, where the run has one, and the note that explains it.
    pub dashed: Option<(fn(&Series) -> Option<&Vec<f64>>, &'a str)>,
}

/// `None` where no run has a positive value.
pub fn draw(report: &Report, subject: &Subject) -> Result<Option<Vec<u8>>, ChartError> {
    let steps = shown_steps(report);
    let shown: Vec<&Run> = report.runs.iter().filter(|r| steps.contains(&r.step_s)).collect();
    let Some(y) = y_axis(&shown, subject) else { return Ok(None) };
    let x = Axis::Linear { from: 0.0, to: shown.iter().map(|r| r.duration_s).fold(0.0, f64::max) };
    let looks = style::looks(report);
    let mut notes = ended_early(&shown);
    if let Some((values, note)) = subject.dashed
        && shown.iter().any(|r| r.series.as_ref().is_some_and(|s| values(s).is_some()))
    {
        notes.insert(0, note.to_string());
    }
    canvas::render(|area| {
        let area = legend::frame(area, &subject.title, &subject.subtitle, &looks, &notes)?;
        let (first, last) = (style::px(42), style::px(0));
        let width = (area.dim_in_pixel().0 - first - last) / steps.len() as u32;
        let mut rest = area;
        for (i, step) in steps.iter().enumerate() {
            let (panel_area, right) = rest.split_horizontally(width + if i == 0 { first } else { 0 });
            let heading = format!("step {}", duration(*step));
            let words = Words { heading: &heading, x: "time, s", y: (i == 0).then_some(subject.y) };
            let panel = Panel::new(&panel_area, x, y, words)?;
            for (turn, (engine, look)) in looks.iter().enumerate().rev() {
                for run in shown.iter().filter(|r| r.engine == *engine && r.step_s == *step) {
                    curve(&panel, run, *look, subject, turn)?;
                }
            }
            rest = right;
        }
        Ok(())
    })
    .map(Some)
}

fn curve(panel: &Panel, run: &Run, look: style::Look, subject: &Subject, turn: usize) -> Result<(), ChartError> {
    let Some(series) = &run.series else { return Ok(()) };
    let against_time = |values: &[f64]| largest_in_intervals(&series.time_s, values, run.duration_s);
    if let Some(values) = subject.dashed.and_then(|(values, _)| values(series)) {
        panel.line(&against_time(values), look, 2, true)?;
    }
    let points = against_time(&(subject.values)(series));
    panel.line(&points, look, 2, false)?;
    // A few markers, at other times for every engine, tell lines apart without colour.
    for k in 0..4 {
        let index = points.len() * (10 * k + 3 + 2 * (turn % 5)) / 42;
        if let Some(point) = points.get(index) {
            panel.mark(*point, look, false)?;
        }
    }
    if run.outcome != Outcome::Completed
        && let (Some((_, value)), Some(time)) = (points.last(), run.ended_at_s)
    {
        panel.cross((time, *value), look)?;
    }
    Ok(())
}

/// The largest value in each interval of the run, at the middle of the times that it is from.
pub(crate) fn largest_in_intervals(times: &[f64], values: &[f64], duration: f64) -> Vec<(f64, f64)> {
    let interval = |time: f64| (time / duration * INTERVALS as f64) as usize;
    let samples: Vec<(f64, f64)> = times.iter().copied().zip(values.iter().copied()).collect();
    samples
        .chunk_by(|a, b| interval(a.0) == interval(b.0))
        .map(|chunk| {
            let middle = 0.5 * (chunk[0].0 + chunk[chunk.len() - 1].0);
            (middle, chunk.iter().map(|sample| sample.1).fold(10f64.powi(FLOOR), f64::max))
        })
        .collect()
}

/// The coarsest step, the finest, and one between.
fn shown_steps(report: &Report) -> Vec<f64> {
    let mut steps: Vec<f64> = report.runs.iter().map(|r| r.step_s).collect();
    steps.sort_by(|a, b| b.total_cmp(a));
    steps.dedup();
    match steps.len() {
        0..=3 => steps,
        n => vec![steps[0], steps[n / 2], steps[n - 1]],
    }
}

/// Decades of all values; the first interval of a run, where errors rise from zero, does not stretch the axis.
fn y_axis(runs: &[&Run], subject: &Subject) -> Option<Axis> {
    let mut shown = Vec::new();
    for run in runs {
        let Some(series) = &run.series else { continue };
        let solid = (subject.values)(series);
        let dashed = subject.dashed.and_then(|(values, _)| values(series)).cloned().unwrap_or_default();
        for values in [solid, dashed] {
            let points = largest_in_intervals(&series.time_s, &values, run.duration_s);
            let skipped = usize::from(points.len() > 1);
            shown.extend(points.into_iter().skip(skipped).map(|point| point.1));
        }
    }
    Axis::decades(shown.into_iter().filter(|x| *x > 10f64.powi(FLOOR)), FLOOR, subject.ceiling)
}

/// One note that names every run that did not reach its end.
fn ended_early(runs: &[&Run]) -> Vec<String> {
    let ended: Vec<String> = runs
        .iter()
        .filter(|r| r.outcome != Outcome::Completed)
        .map(|r| match r.ended_at_s {
            Some(at) if at > 0.0 => {
                format!("{} at {}: {} at {} s", r.engine, duration(r.step_s), r.outcome.words(), plain(at, 3))
            }
            _ => format!("{} at {}: {}", r.engine, duration(r.step_s), r.outcome.words()),
        })
        .collect();
    if ended.is_empty() { Vec::new() } else { vec![format!("× ends early: {}", ended.join("; "))] }
}
