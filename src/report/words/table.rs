//! The table of runs, for the terminal and the page.

use super::number::{duration, plain, short};
use crate::report::record::report::Report;
use crate::report::record::run::Run;
use crate::report::record::structure::{CorrectedStructure, Structure};

/// A column: its heading, its unit or remark, and what stands in it.
pub struct Column {
    pub heading: &'static str,
    pub unit: &'static str,
    /// Right-aligned.
    pub number: bool,
    pub cell: fn(&Run) -> String,
}

const ABSENT: &str = "–";

fn or_absent(text: Option<String>) -> String {
    text.unwrap_or_else(|| ABSENT.to_string())
}

const COLUMNS: [Column; 11] = [
    Column { heading: "step", unit: "", number: true, cell: |r| duration(r.step_s) },
    Column { heading: "outcome", unit: "", number: false, cell: outcome },
    Column {
        heading: "energy error",
        unit: "of scale",
        number: true,
        cell: |r| or_absent(r.energy.as_ref().map(|e| short(e.max_relative_error))),
    },
    Column {
        heading: "corrected",
        unit: "time level",
        number: true,
        cell: |r| {
            or_absent(
                r.energy.as_ref().and_then(|e| e.time_level_corrected.as_ref()).map(|e| short(e.max_relative_error)),
            )
        },
    },
    Column {
        heading: "energy",
        unit: "verdict",
        number: false,
        cell: |r| or_absent(r.energy.as_ref().and_then(|e| e.verdict).map(|v| v.words().to_string())),
    },
    Column {
        heading: "position error",
        unit: "rad or m",
        number: true,
        cell: |r| or_absent(r.accuracy.as_ref().map(|a| short(a.max_joint_error))),
    },
    Column {
        heading: "joint error",
        unit: "m or rad",
        number: true,
        cell: |r| or_absent(r.constraint.as_ref().map(|c| short(c.max_position))),
    },
    Column {
        heading: "joint velocity",
        unit: "m/s or rad/s",
        number: true,
        cell: |r| or_absent(r.constraint.as_ref().map(|c| short(c.max_velocity))),
    },
    Column {
        heading: "momentum error",
        unit: "of scale",
        number: true,
        cell: |r| or_absent(r.momentum.as_ref().map(|m| short(m.max_relative_error))),
    },
    Column {
        heading: "CPU time",
        unit: "µs/step",
        number: true,
        cell: |r| or_absent(r.time.as_ref().map(|t| plain(t.us_per_step, 3))),
    },
    Column {
        heading: "CPU time",
        unit: "s/s simulated",
        number: true,
        cell: |r| or_absent(r.time.as_ref().map(|t| short(t.s_per_simulated_s))),
    },
];

fn outcome(run: &Run) -> String {
    match run.ended_at_s {
        Some(at) if at > 0.0 => format!("{} at {} s", run.outcome.words(), plain(at, 4)),
        _ => run.outcome.words().to_string(),
    }
}

/// What a few steps preserve, in a table of its own.
const STRUCTURE: [Column; 8] = [
    Column { heading: "step", unit: "", number: true, cell: |r| duration(r.step_s) },
    Column {
        heading: "form",
        unit: "defect",
        number: true,
        cell: |r| figure(structure(r).and_then(|s| Some(s.symplecticity.as_ref()?.defect))),
    },
    Column {
        heading: "differences",
        unit: "error",
        number: true,
        cell: |r| figure(structure(r).and_then(|s| Some(s.symplecticity.as_ref()?.differencing_error))),
    },
    Column {
        heading: "form",
        unit: "corrected",
        number: true,
        cell: |r| figure(corrected(r).and_then(|s| Some(s.symplecticity.as_ref()?.defect))),
    },
    Column {
        heading: "reversal",
        unit: "defect",
        number: true,
        cell: |r| figure(structure(r).and_then(|s| Some(s.reversibility.as_ref()?.defect))),
    },
    Column {
        heading: "reversal",
        unit: "corrected",
        number: true,
        cell: |r| figure(corrected(r).and_then(|s| Some(s.reversibility.as_ref()?.defect))),
    },
    Column {
        heading: "momentum",
        unit: "of scale",
        number: true,
        cell: |r| figure(structure(r).and_then(|s| Some(s.momentum_map.as_ref()?.defect))),
    },
    Column {
        heading: "memory",
        unit: "distance",
        number: true,
        cell: |r| figure(structure(r).and_then(|s| Some(s.memory.as_ref()?.distance))),
    },
];

fn figure(x: Option<f64>) -> String {
    or_absent(x.map(short))
}

fn structure(run: &Run) -> Option<&Structure> {
    run.structure.as_ref()
}

fn corrected(run: &Run) -> Option<&CorrectedStructure> {
    run.structure.as_ref()?.time_level_corrected.as_ref()
}

/// The columns below the engine's name in which at least one run of the report has something to say.
pub fn columns(report: &Report) -> Vec<&'static Column> {
    used(&COLUMNS, report)
}

/// The columns of the structure of a few steps; empty where it was not examined.
pub(crate) fn structure_columns(report: &Report) -> Vec<&'static Column> {
    if report.runs.iter().any(|run| run.structure.is_some()) { used(&STRUCTURE, report) } else { Vec::new() }
}

fn used(columns: &'static [Column], report: &Report) -> Vec<&'static Column> {
    columns.iter().filter(|c| report.runs.iter().any(|run| (c.cell)(run) != ABSENT)).collect()
}

/// The table of runs as aligned text.
pub fn text(report: &Report) -> String {
    aligned(report, &columns(report))
}

/// Why runs did not complete, a line each; the steps of an engine that end in the same words share one.
pub(crate) fn endings(report: &Report) -> String {
    let mut found: Vec<(&str, &str, Vec<String>)> = Vec::new();
    for run in &report.runs {
        let Some(detail) = run.outcome_detail.as_deref() else { continue };
        match found.iter_mut().find(|(engine, words, _)| *engine == run.engine && *words == detail) {
            Some((.., steps)) => steps.push(duration(run.step_s)),
            None => found.push((&run.engine, detail, vec![duration(run.step_s)])),
        }
    }
    found.iter().map(|(engine, detail, steps)| format!("{engine} at {}: {detail}\n", steps.join(", "))).collect()
}

/// The table of the structure of a few steps as aligned text; `None` where it was not examined.
pub fn structure_text(report: &Report) -> Option<String> {
    let columns = structure_columns(report);
    (!columns.is_empty()).then(|| aligned(report, &columns))
}

/// A line for each engine and, indented below, one for each of its runs.
fn aligned(report: &Report, columns: &[&Column]) -> String {
    let cells: Vec<Vec<String>> =
        report.runs.iter().map(|run| columns.iter().map(|c| (c.cell)(run)).collect()).collect();
    let widths: Vec<usize> = columns
        .iter()
        .enumerate()
        .map(|(i, c)| {
            let head = c.heading.chars().count().max(c.unit.chars().count());
            cells.iter().map(|row| row[i].chars().count()).fold(head, usize::max)
        })
        .collect();
    let line = |cells: Vec<&str>| {
        let mut text = String::new();
        for ((cell, width), column) in cells.into_iter().zip(&widths).zip(columns) {
            text += "  ";
            text += &if column.number { format!("{cell:>width$}") } else { format!("{cell:<width$}") };
        }
        text.trim_end().to_string() + "\n"
    };
    let mut text = line(columns.iter().map(|c| c.heading).collect());
    text += &line(columns.iter().map(|c| c.unit).collect());
    for (i, row) in cells.iter().enumerate() {
        let engine = &report.runs[i].engine;
        if i == 0 || report.runs[i - 1].engine != *engine {
            text += &format!("{engine}\n");
        }
        text += &line(row.iter().map(String::as_str).collect());
    }
    text
}
