//! `index.html` of a suite: for each family the map and where each engine's border lies, then every cell that went
//! wrong.

use maud::{Markup, html};

use super::document::{Picture, document, figure, version_list};
use crate::measure::stability::Class;
use crate::measure::stability::class::{ACCURATE, BLOW_UP, BROKEN, MATERIAL};
use crate::report::record::stability::{CellRecord, FamilyRecord, ScanRecord, StabilityReport};
use crate::report::words::borders::{sentence, step_words};
use crate::report::words::number::{compact, written};

pub fn html(report: &StabilityReport, pictures: &[Picture]) -> String {
    let body = html! {
        p.description { "Where each engine stops being right, and how it fails: scenes along a parameter, against the \
                         step." }
        (totals(report))
        @for (family, picture) in report.results.iter().zip(pictures) {
            h2 { (family.title) ": " (family.question) }
            (figure(picture))
            @for scan in &family.scans { (borders(scan, &family.engines)) }
            (reasons(family, &family.engines))
        }
        (rules())
        (version_list(&report.suite.versions))
    };
    document("Stability on stiff and extreme scenes", body)
}

/// How many cells of each class an engine has.
fn totals(report: &StabilityReport) -> Markup {
    let count = |engine: &str, class: Class| {
        let cells = report.results.iter().flat_map(|f| &f.scans).flat_map(|s| &s.cells);
        cells.filter(|cell| cell.engine == engine && cell.class == class).count()
    };
    let mut engines: Vec<&str> = Vec::new();
    for engine in report.results.iter().flat_map(|family| &family.engines) {
        if !engines.contains(&engine.as_str()) {
            engines.push(engine);
        }
    }
    html! {
        h2 { "Cells of each class" }
        div.wide {
            table {
                thead { tr { th.word { "engine" } @for class in Class::ALL { th.number { (class.words()) } } } }
                tbody {
                    @for engine in &engines {
                        tr {
                            td.word { (engine) }
                            @for class in Class::ALL { td.number { (count(engine, class)) } }
                        }
                    }
                }
            }
        }
    }
}

fn borders(scan: &ScanRecord, engines: &[String]) -> Markup {
    html! {
        p { strong { (scan.title) } " (" (scan.parameter) ")" }
        ul { @for engine in engines { li { strong { (engine) } ": " (sentence(scan, engine)) "." } } }
        @if let Some(truth) = truth(scan) { p.small { "Measured against " (truth) "." } }
    }
}

/// How the truth was found: at which values of the parameter by which means.
fn truth(scan: &ScanRecord) -> Option<String> {
    let method = |value: f64| {
        let mut cells = scan.cells.iter().filter(|cell| cell.value == value);
        cells.find_map(|cell| cell.truth.clone()).unwrap_or_else(|| "nothing, the truth is not known".to_string())
    };
    let found: Vec<(f64, String)> = scan.values.iter().map(|&value| (value, method(value))).collect();
    let known = scan.cells.iter().any(|cell| cell.truth.is_some());
    let chunks = found.chunk_by(|a, b| a.1 == b.1).map(|chunk| match chunk {
        [(value, method)] => format!("{method} at {}", compact(*value)),
        [(from, method), .., (to, _)] => format!("{method} from {} to {}", compact(*from), compact(*to)),
        [] => String::new(),
    });
    known.then(|| chunks.collect::<Vec<_>>().join("; "))
}

/// The first reason or warning of each engine and scan that has one.
fn reasons(family: &FamilyRecord, engines: &[String]) -> Markup {
    let words = |cell: &'_ CellRecord| cell.reason.clone().or_else(|| cell.warning.clone());
    let first = |scan: &'_ ScanRecord, engine: &str| -> Option<(String, String)> {
        let cell: &CellRecord = scan.cells.iter().find(|c| c.engine == engine && words(c).is_some())?;
        let place =
            format!("{}, {engine} at {} and {}", scan.name, compact(cell.value), step_words(cell.step, &scan.clock));
        Some((place, words(cell)?))
    };
    let list: Vec<(String, String)> =
        family.scans.iter().flat_map(|scan| engines.iter().filter_map(move |engine| first(scan, engine))).collect();
    html! {
        @if !list.is_empty() {
            details {
                summary { "What the engines said, the first of each" }
                ul.notes { @for (place, reason) in &list { li { strong { (place) } ": " (reason) } } }
            }
        }
    }
}

fn rules() -> Markup {
    html! {
        h2 { "How cells are classified" }
        p {
            "In this order. " strong { "Over budget" } ": the run would cost too much by a formula of engine, bodies \
             and steps. "
            strong { "Refused" } ": the engine cannot, or ended with a named reason. "
            strong { "Blow-up" } ": a state that is not a number, or an energy error above "
            (BLOW_UP) " energy scales. "
            strong { "Joints apart" } ": by more than " (BROKEN) " of a link, or rad. "
            strong { "Accurate" } ": errors of pose, energy and joints all below " (ACCURATE) " of their scale, where \
             the truth is known: the reference at two tolerances that agree, or a fine run of the core that agrees \
             with one at half its step. "
            strong { "Bounded" } ": the energy error does not grow, comes back, or stays below "
            (written(MATERIAL)) " of its scale. "
            strong { "Drifting" } ", " strong { "gaining" } ", " strong { "dissipating" } ": it grows like a random \
             walk, upwards, downwards. In scenes with dampers the energy is the balance: what the dampers took out, by \
             the velocities in the engine's own states, is added to the energy that is left. "
            "An exclamation mark on a map is the program's own warning: bodies that turn too far in a step for energy \
             bounds, or a linkage that passes a singular configuration within a step."
        }
    }
}
