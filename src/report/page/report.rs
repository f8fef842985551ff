//! `index.html`: one file without links to others, readable from a disk and without a network.

use maud::{Markup, html};

use super::document::{Picture, command_line, document, figure, finding_box, machine_list, version_list, words};

use crate::measure::cost::clock::Effort;
use crate::report::record::report::Report;
use crate::report::record::run::Run;
use crate::report::record::scene::SceneRecord;
use crate::report::record::{parity, reference, sweep};
use crate::report::words::expectation::sentence as expectation_sentence;
use crate::report::words::number::{duration, plain, short, written};
use crate::report::words::summary;
use crate::report::words::{finding, table};

/// The page of a report: the finding, the pictures, the table, what was simulated and ignored, machine, versions,
/// command.
pub fn html(report: &Report, pictures: &[Picture]) -> String {
    let description = &report.scene.description;
    let body = html! {
        @if !description.is_empty() { p.description { (description) } }
        @if report.interrupted {
            p.warning { "The comparison was interrupted: runs or their timings are missing." }
        }
        @if report.parity.as_ref().is_some_and(|parity| !parity.agrees) {
            p.warning { "Not all engines have the same mechanical system: see Parity." }
        }
        (finding_box(&finding::sentence(report)))
        @if let Some(sentence) = report.sweep.as_ref().and_then(summary::sentence) { (finding_box(&sentence)) }
        @for picture in pictures { (figure(picture)) }
        @if let Some(sweep) = &report.sweep { (costs(sweep)) }
        (runs(report))
        (structure(report))
        @if let Some(sweep) = &report.sweep { (convergence(sweep)) }
        @if let Some(reference) = &report.reference { (reference_of(reference)) }
        @if let Some(parity) = &report.parity { (parity_of(parity)) }
        (scene(&report.scene))
        (environment(report))
    };
    document(&report.scene.name, body)
}

fn runs(report: &Report) -> Markup {
    html! {
        h2 { "Runs" }
        (engine_table(report, &table::columns(report)))
        (notes(report, |run| run.outcome_detail.as_deref()))
        (notes(report, |run| run.warning.as_deref()))
        p.small {
            "Energy error: the energy of the engine's state minus that at the start, plus what dampers took out, over \
             the energy scale; the largest absolute value over all steps. Corrected: the same with the positions moved \
             back to the time of the velocities, for engines that return the two at different times. Position error: \
             the largest error of a joint position against the reference, as long as that is trusted. Joint error: the \
             largest displacement or rotation, over all joints and steps, that a joint does not allow. Verdict: how \
             the energy error grows over the run; a run of few swings can mislead, a longer one decides; one of fewer \
             than 2000 steps is not judged. CPU time: of the stepping alone, on one thread, median of the repeats; \
             long runs are timed over their first part."
            @if let Some(overhead) = report.timing.as_ref().and_then(|t| t.overhead_us_per_step) {
                " The loop around a step takes " (plain(1e3 * overhead, 2)) " ns of it."
            }
        }
    }
}

fn structure(report: &Report) -> Markup {
    let columns = table::structure_columns(report);
    let Some(first) = report.runs.iter().find_map(|run| run.structure.as_ref()) else { return html! {} };
    html! {
        h2 { "Structure of " (first.steps) " steps" }
        (engine_table(report, &columns))
        (notes(report, |run| run.structure.as_ref()?.detail.as_deref()))
        p.small {
            (first.steps) " steps from the state " (plain(first.at_s, 3)) " s into the motion, the same for all \
             engines, as one map of joint coordinates and conjugate momenta. Form: the largest entry of AᵀΩA − Ω \
             for the derivative A of the map, by differences; a defect below the differences' error cannot be told \
             from none. Reversal: the distance from the start after the steps, a reversal of all velocities, as many \
             steps and another reversal. Corrected: the same map in coordinates moved back to the time of the \
             velocities. Momentum: the largest change of a conserved component over its scale. An engine is made new \
             at every point, from the coordinates and velocities that belong to it. Memory: the distance between twice \
             the steps of one engine and the steps of two engines made new, which is what steps take from those before \
             them: joint errors, impulses kept for the next solve. Distances in rad, m, rad/s or m/s."
        }
    }
}

/// A line for each engine, and below it one for each of its runs.
fn engine_table(report: &Report, columns: &[&table::Column]) -> Markup {
    let class = |number: bool| if number { "number" } else { "word" };
    html! {
        div.wide {
            table {
                thead {
                    tr { @for c in columns { th class=(class(c.number)) { (c.heading) br; small { (c.unit) } } } }
                }
                tbody {
                    @for (i, run) in report.runs.iter().enumerate() {
                        @if i == 0 || report.runs[i - 1].engine != run.engine {
                            tr.engine { th.word colspan=(columns.len()) { (run.engine) } }
                        }
                        tr { @for c in columns { td class=(class(c.number)) { ((c.cell)(run)) } } }
                    }
                }
            }
        }
    }
}

/// What is to be said of single runs.
fn notes(report: &Report, of: fn(&Run) -> Option<&str>) -> Markup {
    let name = |r: &Run| format!("{} at {}", r.engine, duration(r.step_s));
    let notes: Vec<(String, &str)> = report.runs.iter().filter_map(|r| Some((name(r), of(r)?))).collect();
    html! {
        @if !notes.is_empty() {
            ul.notes { @for (run, detail) in &notes { li { strong { (run) } ": " (detail) } } }
        }
    }
}

fn costs(sweep: &sweep::Sweep) -> Markup {
    html! {
        @if let Some(targets) = summary::targets(sweep) {
            h2 { "What accuracy costs" }
            (words(&targets))
            p.small {
                "CPU seconds a simulated second of the cheapest setting of each engine whose largest joint position \
                 error (rad or m) over the first " (plain(sweep.until_s, 4)) " s stays below the head of the column, \
                 and that setting; from the lower decile over the rounds, of which settings that decide an order of \
                 engines have "
                (Effort::RANKING.rounds) ". The reference is known to " (written(sweep.reference_error)) "."
            }
            @if !sweep.expectations.is_empty() {
                ul { @for expectation in &sweep.expectations { li { (expectation_sentence(expectation)) } } }
            }
        }
    }
}

fn convergence(sweep: &sweep::Sweep) -> Markup {
    html! {
        @if let Some(table) = summary::convergence(sweep) {
            h2 { "Convergence" }
            (words(&table))
            p.small {
                "The order is the slope of the joint position error over the step size at the finest steps whose \
                 errors are above the floor, roundoff and what the reference leaves uncertain; the floor is the \
                 smallest error, where shorter steps no longer reduce it. A floor at roundoff is no defect; one far \
                 above it comes from single precision, clamps, or constraints that are solved only in part."
            }
        }
    }
}

fn reference_of(reference: &reference::Reference) -> Markup {
    html! {
        h2 { "Reference" }
        dl {
            dt { "Method" } dd { (reference.method) }
            dt { "Trusted until" } dd { (plain(reference.trusted_until_s, 4)) " s" }
            dt { "Estimated error" }
            dd { (written(reference.error_estimate)) ", of positions over the reach, of attitudes in rad" }
        }
    }
}

const PARITY_HEADS: [&str; 8] =
    ["mass", "inertia", "centre of mass, m", "energy", "linear momentum", "angular momentum", "acceleration", "solved"];

fn parity_of(parity: &parity::Parity) -> Markup {
    let absent = |x: Option<f64>| x.map_or("–".to_string(), short);
    html! {
        h2 { "Parity" }
        div.wide {
            table {
                thead {
                    tr {
                        th.word { "engine" }
                        th.word { "agrees" }
                        @for head in PARITY_HEADS { th.number { (head) } }
                    }
                }
                tbody {
                    @for e in &parity.engines {
                        tr {
                            td.word { (e.engine) }
                            td.word { @if e.agrees { "yes" } @else { "no" } }
                            @for x in [e.mass, e.inertia, e.com_m, Some(e.energy), Some(e.linear_momentum),
                                       Some(e.angular_momentum), e.acceleration, e.acceleration_solved] {
                                td.number { (absent(x)) }
                            }
                        }
                    }
                }
            }
        }
        p.small {
            "Relative differences at t = 0 between what an engine has and the system. Masses, inertias and centres of \
             mass are read back from engines that keep their own. Accelerations are those of the joints, from the \
             first steps of the engine, against the reference; solved: the same with the constraints solved to the \
             end, where the settings of the engine leave them half solved. They are told and not judged where the \
             steps do not resolve the motion, and in single precision with impulse joints or where roundoff hides \
             them; what is read back is judged."
        }
    }
}

fn scene(scene: &SceneRecord) -> Markup {
    let [x, y, z] = scene.gravity;
    html! {
        h2 { "What was simulated" }
        dl {
            dt { "Moving bodies" } dd { (scene.bodies) ", " (plain(scene.mass_kg, 4)) " kg together" }
            dt { "Joints" } dd { (scene.joints) " with " (scene.degrees_of_freedom) " degrees of freedom" }
            @if scene.loops > 0 { dt { "Loops" } dd { (scene.loops) } }
            dt { "Gravity" } dd { "(" (x) ", " (y) ", " (z) ") m/s²" }
            dt { "Energy scale" } dd { (written(scene.energy_scale_j)) " J" }
            @if !scene.needs.is_empty() { dt { "Needs" } dd { (scene.needs.join(", ")) } }
        }
        @if !scene.remarks.is_empty() {
            h2 { "Remarks" }
            ul { @for remark in &scene.remarks { li { (remark) } } }
        }
        h2 { "What was ignored" }
        @if scene.ignored.is_empty() {
            p { "Nothing: all that the files hold was simulated." }
        } @else {
            table {
                thead { tr { th.word { "element" } th.word { "what" } th.word { "as read" } } }
                tbody {
                    @for i in &scene.ignored {
                        tr { td.word { (i.element) } td.word { (i.what) } td.word { (i.value) } }
                    }
                }
            }
        }
    }
}

fn environment(report: &Report) -> Markup {
    let versions = &report.versions;
    html! {
        (machine_list(&report.machine))
        (version_list(versions))
        @if versions.profile != "release" {
            p.warning { "This was not a release build: its timings say little about any engine." }
        }
        (command_line(&report.command))
    }
}
