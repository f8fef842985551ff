//! `check` with the shipped bounds: it passes, and every planted fault makes it fail.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64};
use std::time::Duration;

use rattlebench::check::run::TRUTH_BUDGET;
use rattlebench::check::{Finding, QUICK_STEPS, Requirement, Scope, check, judge, requirements, scoped};
use rattlebench::engines::{self, Engine, Spec, Unsupported};
use rattlebench::measure::Run;
use rattlebench::measure::comparison::Results;
use rattlebench::measure::outcome::Limits;
use rattlebench::measure::trace::trace_against;
use rattlebench::measure::{Horizon, truth};
use rattlebench::mechanics::System;
use rattlebench::model::Scene;
use rattlebench::report::Report;
use rattlebench::variational::Fault;

use crate::common::{compile, shipped_scenes};

const DAMPED: &str = "models/damped_pendulum/scene.json";

fn scene_file(name: &str) -> String {
    format!("models/{name}/scene.json")
}

type Build<'a> = dyn Fn(&Spec, &System, f64) -> Result<Box<dyn Engine>, Unsupported> + 'a;

/// The findings on the bounds of a scene that `choose` picks, with engines that `build` makes.
fn findings(path: &str, choose: impl Fn(&Requirement) -> bool, build: &Build) -> Vec<Finding> {
    let scene = Scene::load(path).unwrap();
    let system = System::compile(&scene).unwrap();
    let mut chosen = requirements(path.as_ref(), &scene.bounds, &system).unwrap();
    chosen.retain(|r| r.engine.entry().name == "rattle" && choose(r));
    assert!(!chosen.is_empty(), "{path} has no such bounds");
    let limits = Limits { budget: Duration::MAX, interrupted: &AtomicBool::new(false), taken: &AtomicU64::new(0) };
    let compared: Vec<Horizon> = chosen.iter().filter(|r| r.need().compared).map(|r| r.horizon).collect();
    let truth = truth::find(&system, &compared, TRUTH_BUDGET, limits.interrupted).filter(|_| !compared.is_empty());
    let mut runs: Vec<Run> = Vec::new();
    for r in &chosen {
        let taken = |run: &Run| run.engine.to_string() == r.engine.to_string() && run.horizon == r.horizon;
        if !runs.iter().any(taken) {
            let mut engine = build(&r.engine, &system, r.horizon.step).unwrap();
            let trace = trace_against(truth.as_ref(), &system, engine.as_mut(), r.horizon, &limits).unwrap();
            runs.push(Run { engine: r.engine.clone(), horizon: r.horizon, trace, structure: None, timing: None });
        }
    }
    let results = Results { runs, interrupted: false };
    judge(&chosen, &Report::new(&scene, &system, &results, String::new()))
}

fn broken(findings: &[Finding]) -> Vec<String> {
    findings.iter().filter(|f| !f.passed).map(Finding::sentence).collect()
}

fn quick(r: &Requirement) -> bool {
    r.horizon.steps <= QUICK_STEPS
}

/// What a fault breaks of the quick bounds of a scene; asserts that it breaks something and that the sound engine does not.
fn caught(path: &str, fault: Fault) -> Vec<String> {
    let sound = broken(&findings(path, quick, &|spec, system, step| engines::build(spec, system, step)));
    assert!(sound.is_empty(), "{path}: {sound:#?}");
    let found = broken(&findings(path, quick, &|spec, system, step| engines::faulty(spec, system, step, fault)));
    println!("{path} {fault:?}: {found:#?}");
    assert!(!found.is_empty(), "{path}: {fault:?} breaks no bound");
    found
}

#[test]
fn a_constraint_iteration_that_ends_early_breaks_bounds() {
    for name in ["double_pendulum", "chain_10"] {
        caught(&scene_file(name), Fault::LooseTolerance);
    }
}

#[test]
fn a_warm_start_from_body_impulses_breaks_bounds() {
    caught(&scene_file("double_pendulum"), Fault::WarmBodyImpulses);
}

#[test]
fn a_dropped_multiplier_breaks_bounds() {
    caught(&scene_file("double_pendulum"), Fault::DroppedMultiplier);
}

#[test]
fn dampers_that_push_break_bounds() {
    caught(DAMPED, Fault::DampingSign);
}

/// The engine is built from a system with one moment of inertia 1 % too large; the figures are taken with the right one.
#[test]
fn an_inertia_off_by_one_percent_breaks_bounds() {
    for name in ["double_pendulum", "arm_6", "heavy_top"] {
        let wrong = |spec: &Spec, system: &System, step: f64| {
            let mut system = system.clone();
            system.bodies[0].inertia *= 1.01;
            engines::build(spec, &system, step)
        };
        let found = broken(&findings(&scene_file(name), quick, &wrong));
        println!("{name}: {found:#?}");
        assert!(!found.is_empty(), "{name}");
    }
}

/// Nightly: `cargo test --release --test measure -- --ignored`.
#[test]
#[ignore = "takes minutes"]
fn plain_sums_over_ten_million_steps_break_bounds() {
    let path = scene_file("double_pendulum");
    let long = |r: &Requirement| r.horizon.steps > QUICK_STEPS && r.engine.to_string() == "rattle:order=8";
    let sound = broken(&findings(&path, long, &|spec, system, step| engines::build(spec, system, step)));
    assert!(sound.is_empty(), "{sound:#?}");
    let plain = |spec: &Spec, system: &System, step: f64| engines::faulty(spec, system, step, Fault::PlainSums);
    let found = broken(&findings(&path, long, &plain));
    println!("{found:#?}");
    assert!(!found.is_empty(), "plain sums break no bound");
}

/// Every shipped scene has bounds on a quick run, and all but one on one of 1e7 steps: it does not come through so many.
#[test]
fn every_shipped_scene_has_bounds() {
    let mut without_long = Vec::new();
    for scene in shipped_scenes() {
        let path = scene_file(&scene.name);
        let all = requirements(path.as_ref(), &scene.bounds, &compile(&scene)).unwrap();
        if all.iter().all(|r| r.horizon.steps < 10_000_000) {
            without_long.push(scene.name);
        }
        let (quick, _) = scoped(all, Scope::Quick);
        let what = "let `rattlebench check --propose` measure some";
        assert!(!quick.is_empty(), "{path}: no bounds on quick runs; {what}");
    }
    assert_eq!(without_long, ["ladder"]);
}

/// The damped pendulum with short runs in the place of the long ones and another bound on its energy.
fn short_copy(folder: &Path, energy: &str) -> PathBuf {
    std::fs::copy("models/damped_pendulum/damped_pendulum.urdf", folder.join("damped_pendulum.urdf")).unwrap();
    let path = folder.join("scene.json");
    let text = std::fs::read_to_string(DAMPED).unwrap().replace("10000.0", "1000.0").replace("5e-6", energy);
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn the_macro_checks_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    rattlebench::check!(short_copy(folder.path(), "5e-6"));
    rattlebench::check!(scene_file("tumbling_body"), quick);
}

#[test]
fn a_scene_that_breaks_a_bound_says_which() {
    let folder = tempfile::tempdir().unwrap();
    let checked = check(short_copy(folder.path(), "1e-9"), Scope::All).unwrap();
    let broken: Vec<&Finding> = checked.findings.iter().filter(|f| !f.passed).collect();
    // That over 100 s and that over 1000 s.
    assert_eq!(broken.len(), 2, "{broken:?}");
    let found = broken[0];
    assert!(found.measured.is_some_and(|x| x > 1e-9 && x < 5e-6), "{found:?}");
    assert!(found.sentence().starts_with("rattle, 100000 steps of 0.001 s: energy.max_relative_error is "));
}
