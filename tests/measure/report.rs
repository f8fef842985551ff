//! Reports of real comparisons: what they hold, and what they leave out.

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use nalgebra::Vector3;
use rattlebench::engines::{self, Spec};
use rattlebench::measure::Horizon;
use rattlebench::measure::comparison::{Comparison, Progress};
use rattlebench::mechanics::{System, energy};
use rattlebench::model::Scene;
use rattlebench::report::Report;
use rattlebench::report::charts::CHARTS;
use rattlebench::report::page::report as page;
use rattlebench::report::record::metrics::METRICS;
use rattlebench::report::words::{finding, table};

use crate::common::*;

fn compared(scene: &Scene, engines: &[&str], steps: &[f64], duration: f64) -> Report {
    report(scene, engines, steps, duration, false)
}

fn report(scene: &Scene, engines: &[&str], steps: &[f64], duration: f64, structure: bool) -> Report {
    let system: System = compile(scene);
    let engines: Vec<Spec> = engines.iter().map(|text| Spec::parse(text).expect("a spec")).collect();
    let horizons: Vec<Horizon> = steps.iter().map(|h| Horizon::nearest(*h, duration).expect("a run")).collect();
    let comparison = Comparison {
        system: &system,
        engines: &engines,
        horizons: &horizons,
        budget: Duration::from_secs(60),
        jobs: 1,
        structure,
    };
    let results = comparison.run(None, &AtomicBool::new(false), &Progress::default());
    Report::new(scene, &system, &results, "rattlebench compare".to_string())
}

fn charts(report: &Report) -> Vec<(&'static str, Vec<u8>)> {
    CHARTS.iter().filter_map(|c| Some((c.file, (c.draw)(report).expect("drawn")?))).collect()
}

#[test]
fn a_report_survives_being_written_and_read() {
    let report = report(&alternating(2), &["rattle", "rapier"], &[0.01, 0.005], 1.0, true);
    let json = report.to_json().expect("JSON");
    assert_eq!(Report::from_json(&json).expect("a report"), report);
    assert!(!json.contains("null") && !json.contains("NaN"));
    let schema = serde_json::to_value(schemars::schema_for!(Report)).expect("JSON");
    let fields = schema["$defs"]["Run"]["properties"].as_object().expect("fields");
    let value: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    for key in value["runs"][0].as_object().expect("a run").keys() {
        assert!(fields.contains_key(key), "{key} is in the schema");
    }
}

#[test]
fn every_metric_is_the_figure_at_its_path() {
    let report = report(&alternating(1), &["rapier"], &[0.01], 1.0, true);
    let run = serde_json::to_value(&report.runs[0]).expect("JSON");
    for metric in &METRICS {
        let at_path = metric.name.split('.').fold(&run, |value, key| &value[key]).as_f64();
        assert_eq!((metric.value)(&report.runs[0]), at_path, "{}", metric.name);
    }
    assert!(METRICS.iter().filter(|m| (m.value)(&report.runs[0]).is_some()).count() >= 10);
}

/// A dissipating scene is judged by its balance: what is left of the energy and what the dampers took.
#[test]
fn the_energy_balance_of_a_damped_chain_is_judged_and_not_its_loss() {
    let mut scene = alternating(2);
    scene.model.joints.iter_mut().for_each(|joint| joint.damping = 0.05);
    let report = compared(&scene, &["rattle"], &[2e-3, 1e-3], 5.0);
    let errors: Vec<f64> = report.runs.iter().map(|r| r.energy.as_ref().expect("energy").max_relative_error).collect();
    // measured 4.1e-5 and 1.0e-5
    assert!(errors[1] < 2.5e-5, "{errors:?}");
    assert!((errors[0] / errors[1]).log2() > 1.8, "order two: {errors:?}");
    // The energy itself is a thousand times further from where it began.
    let system = compile(&scene);
    let mut engine = engines::build(&Spec::parse("rattle").expect("a spec"), &system, 1e-3).expect("supported");
    let mut state = system.initial.clone();
    (0..5000).for_each(|_| engine.step().expect("a step"));
    engine.write_state(&mut state);
    let lost = energy::energy(&system, &system.initial).total() - energy::energy(&system, &state).total();
    assert!(lost / system.energy_scale > 0.1, "{}", lost / system.energy_scale);
}

#[test]
fn what_a_scene_has_not_is_left_out() {
    let mut scene = chain(&[(rattlebench::model::JointKind::Floating, Vector3::x())]);
    scene.gravity = Vector3::zeros();
    scene.initial[0].velocity = vec![0.1, 0.0, 0.0, 0.3, 2.0, 0.1];
    let report = compared(&scene, &["rattle", "rapier"], &[0.01], 1.0);
    for run in &report.runs {
        assert!(run.constraint.is_none() && run.momentum.is_some());
        assert!(run.energy.as_ref().is_some_and(|e| e.time_level_corrected.is_none()));
    }
    let names: Vec<&str> = charts(&report).iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["energy_drift.png", "error_vs_run_time.png"]);
    let text = table::text(&report);
    assert!(!text.contains("joint error") && text.contains("momentum error"), "{text}");

    let chain = compared(&alternating(2), &["rattle"], &[0.01], 1.0);
    assert!(chain.runs[0].constraint.is_some() && chain.runs[0].momentum.is_none());
    assert!(table::text(&chain).contains("joint error"));
}

#[test]
fn the_structure_of_a_step_is_reported_where_it_is_asked_for() {
    let engines = ["rattle", "rapier:joints=multibody,precision=f64"];
    let mut scene = alternating(2);
    scene.initial[1].velocity = vec![2.0];
    let report = report(&scene, &engines, &[0.01], 1.0, true);
    let found: Vec<_> = report.runs.iter().map(|r| r.structure.as_ref().expect("examined")).collect();
    assert!(found.iter().all(|s| s.at_s == 0.5 && s.detail.is_none() && s.momentum_map.is_none()), "{found:?}");
    let forms: Vec<_> = found.iter().map(|s| s.symplecticity.as_ref().expect("measured")).collect();
    assert!(forms[0].defect <= forms[0].differencing_error, "{forms:?}");
    assert!(forms[1].defect >= 100.0 * forms[1].differencing_error, "{forms:?}");
    assert!(found[0].time_level_corrected.is_none() && found[1].time_level_corrected.is_some());
    let text = table::structure_text(&report).expect("a table");
    assert!(text.contains("differences") && text.contains("corrected") && !text.contains("momentum"), "{text}");
    assert!(charts(&report).iter().any(|(name, _)| *name == "structure.png"));
    assert!(page::html(&report, &[]).contains("<h2>Structure of 8 steps</h2>"));

    let without = compared(&alternating(2), &["rattle"], &[0.01], 1.0);
    assert!(without.runs[0].structure.is_none() && table::structure_text(&without).is_none());
    assert!(charts(&without).iter().all(|(name, _)| *name != "structure.png"));
    assert!(!page::html(&without, &[]).contains("Structure of "));
}

#[test]
fn a_scene_without_a_finished_run_still_has_a_page() {
    let mut report = compared(&alternating(1), &["rattle"], &[0.01], 0.5);
    let run = &mut report.runs[0];
    run.outcome = rattlebench::report::record::run::Outcome::Unsupported;
    run.outcome_detail = Some("loops".to_string());
    (run.energy, run.constraint, run.time, run.series) = (None, None, None, None);
    assert!(charts(&report).is_empty());
    assert_eq!(finding::sentence(&report), "No engine completed a run of this scene.");
    assert!(page::html(&report, &[]).contains("rattle at 10 ms</strong>: loops"));
}

#[test]
fn words_from_files_are_escaped() {
    let mut scene = alternating(1);
    scene.name = "<script>alert(1)</script>".to_string();
    scene.description = "a & b".to_string();
    let report = compared(&scene, &["rattle"], &[0.01], 0.5);
    let page = page::html(&report, &[]);
    assert!(!page.contains("<script>") && page.contains("&lt;script&gt;") && page.contains("a &amp; b"));
}

#[test]
fn the_finding_names_the_engine_that_errs_least_whichever_it_is() {
    let mut report = compared(&alternating(2), &["rattle", "rapier"], &[0.01], 1.0);
    assert!(finding::sentence(&report).starts_with("At a step of 10 ms over 1 s, rattle keeps the energy to "));
    report.runs[0].energy.as_mut().expect("energy").max_relative_error = 5.0;
    assert!(finding::sentence(&report).starts_with("At a step of 10 ms over 1 s, rapier keeps the energy to "));
}
