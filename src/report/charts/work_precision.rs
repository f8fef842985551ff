//! `work_precision.png`: joint position error against processor time for every setting that was tried, and the fronts
//! of the settings that no other of the same engine beats.

use super::axis::Axis;
use super::canvas::{self, ChartError};
use super::chart::Chart;
use super::panel::{Label, Panel, Words};
use super::{legend, style};
use crate::engines::{tolerance, tuned};
use crate::measure::cost::front::front;
use crate::report::record::report::Report;
use crate::report::record::run::{Run, family};
use crate::report::words::number::{duration, plain};

pub(crate) const CHART: Chart = Chart {
    file: "work_precision.png",
    caption: "Joint position error against processor time for every setting that was tried; lines join the settings of \
              an engine that no other of its settings beats; lower left is better",
    draw,
};

/// Smallest error shown, a power of ten.
const FLOOR: i32 = -16;

/// A line of the chart.
struct Line<'a> {
    name: &'a str,
    /// Whether it is that of the default settings of an engine whose best have one too.
    default: bool,
    /// What it joins.
    front: Vec<&'a Run>,
    /// All that was tried.
    all: Vec<&'a Run>,
}

fn draw(report: &Report) -> Result<Option<Vec<u8>>, ChartError> {
    let Some(sweep) = &report.sweep else { return Ok(None) };
    let known: Vec<&Run> = sweep.runs.iter().filter(|r| r.cost().is_some() && r.joint_error().is_some()).collect();
    let Some(x) = Axis::decades(known.iter().filter_map(|r| r.cost()), -9, 6) else { return Ok(None) };
    let Some(y) = Axis::decades(known.iter().filter_map(|r| r.joint_error()), FLOOR, 1) else { return Ok(None) };
    let lines = lines(&known);
    let looks = style::looks_of(lines.iter().map(|line| line.name));
    let title = format!("What accuracy costs: {}", report.scene.name);
    let subtitle = format!(
        "Largest error of a joint position over the first {} s against the reference. A dot is a setting at a step \
         size; a line joins those of an engine that no other beats. Lower left is better",
        plain(sweep.until_s, 4)
    );
    canvas::render(|area| {
        let area = legend::frame(area, &title, &subtitle, &looks, &notes(report))?;
        let words = Words {
            heading: "",
            x: "CPU seconds per simulated second, one thread",
            y: Some("largest joint position error, rad or m"),
        };
        let panel = Panel::new(&area, x, y, words)?;
        let mut drawn = Vec::new();
        for (line, (_, look)) in lines.iter().zip(&looks) {
            for point in points(&line.all) {
                panel.dot(point, *look)?;
            }
        }
        let mut labels = Vec::new();
        for (line, (_, look)) in lines.iter().zip(&looks).rev() {
            let joined = points(&line.front);
            panel.line(&joined, *look, 3, line.default)?;
            joined.iter().try_for_each(|point| panel.mark(*point, *look, false))?;
            labels.extend(settings(&line.front).into_iter().map(|(point, words)| Label { point, words, look: *look }));
            drawn.push(joined);
        }
        panel.labels(&labels, &drawn)
    })
    .map(Some)
}

/// A front for each engine, that of a tuned one under a name of its own beside the line of its default settings.
fn lines<'a>(runs: &[&'a Run]) -> Vec<Line<'a>> {
    let mut lines: Vec<Line> = Vec::new();
    for run in runs {
        let name = tuned(&run.engine).map_or(family(&run.engine), |tuned| tuned.best);
        match lines.iter_mut().find(|line| line.name == name) {
            Some(line) => line.all.push(run),
            None => lines.push(Line { name, default: false, front: Vec::new(), all: vec![run] }),
        }
    }
    for line in &mut lines {
        let known: Vec<&Run> = line.all.iter().copied().filter(|r| point(r).is_some()).collect();
        line.front = front(&points(&known)).into_iter().map(|i| known[i]).collect();
    }
    for name in tuned_defaults(runs.iter().copied()) {
        let front = runs.iter().copied().filter(|run| run.engine == name).collect();
        lines.push(Line { name, default: true, front, all: Vec::new() });
    }
    lines
}

/// Names of the tuned engines that ran with their default settings.
fn tuned_defaults<'a>(runs: impl Iterator<Item = &'a Run>) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for run in runs.filter(|run| run.engine == family(&run.engine) && tuned(&run.engine).is_some()) {
        if !names.contains(&run.engine.as_str()) {
            names.push(&run.engine);
        }
    }
    names
}

fn points(runs: &[&Run]) -> Vec<(f64, f64)> {
    runs.iter().filter_map(|r| point(r)).collect()
}

/// Cost and error.
fn point(run: &Run) -> Option<(f64, f64)> {
    Some((run.cost()?, run.joint_error()?))
}

/// Words at the points of a front where its settings change, and at its ends.
fn settings(front: &[&Run]) -> Vec<((f64, f64), String)> {
    let last = front.len().saturating_sub(1);
    let mut found = Vec::new();
    for (i, run) in front.iter().enumerate() {
        let changed = i == 0 || front[i - 1].engine != run.engine;
        let (Some(x), Some(y)) = (run.cost(), run.joint_error()) else { continue };
        let settings = run.engine.split_once(':').map(|(_, settings)| settings);
        match settings.filter(|words| changed && words.len() <= 16) {
            Some(words) => found.push(((x, y), labelled(run, words))),
            None if i == 0 || i == last => found.push(((x, y), duration(run.step_s))),
            None => {}
        }
    }
    found
}

/// Settings with the step of the run, but for an engine whose error a tolerance among them controls.
fn labelled(run: &Run, settings: &str) -> String {
    match tolerance(&run.engine) {
        Some((key, _)) => settings.replace(&format!("{key}="), "tol "),
        None => format!("{settings}, {}", duration(run.step_s)),
    }
}

fn notes(report: &Report) -> Vec<String> {
    let Some(sweep) = &report.sweep else { return Vec::new() };
    let lost = sweep.runs.iter().filter(|r| r.cost().is_none()).count();
    let mut notes = Vec::new();
    for name in tuned_defaults(sweep.runs.iter()) {
        notes.extend(tuned(name).map(|tuned| format!("{name}, dashed: {}.", tuned.default)));
    }
    if lost > 0 {
        notes.push(format!("{lost} of {} runs did not reach the end and are not shown.", sweep.runs.len()));
    }
    notes
}
