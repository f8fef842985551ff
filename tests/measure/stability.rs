//! The stability suite from outside: the same bytes however it is run, and reasons that are true.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use rattlebench::engines::Spec;
use rattlebench::measure::stability::{Case, Cell, Class, FAMILIES, Family, Finding, Scan};
use rattlebench::report::record::stability::StabilityReport;

use crate::common::rattlebench;

/// A small suite: two families, two engines.
const SUITE: [&str; 8] =
    ["stability", "start", "geometry", "--quick", "--engine", "rattle", "--engine", "rapier:preset=strong"];

fn command(more: &[&str], out: &Path) -> Command {
    let mut command = rattlebench(&SUITE);
    command.args(more).arg("--out").arg(out).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

fn run(more: &[&str], out: &Path) {
    assert!(command(more, out).status().expect("runs").success(), "{more:?}");
}

/// What readers see: everything but the cells' own file, whose lines are in the order in which they were finished.
fn outputs(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<(String, Vec<u8>)> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("readable").path())
        .filter(|path| path.file_name().is_some_and(|name| name != "cells.jsonl"))
        .map(|path| {
            (path.file_name().expect("a name").to_string_lossy().into_owned(), fs::read(path).expect("readable"))
        })
        .collect();
    files.sort();
    files
}

fn report(folder: &Path) -> StabilityReport {
    serde_json::from_str(&fs::read_to_string(folder.join("stability.json")).expect("readable")).expect("a report")
}

#[test]
fn a_suite_that_is_killed_ten_times_and_resumed_ends_with_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let (whole, killed) = (folder.path().join("whole"), folder.path().join("killed"));
    run(&["--jobs", "1"], &whole);
    // Moments from a few milliseconds to about a second, the same in every run of the test.
    let mut seed = 12345u64;
    for _ in 0..10 {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mut child = command(&["--jobs", "2", "--resume"], &killed).spawn().expect("starts");
        std::thread::sleep(Duration::from_millis(5 + (seed >> 33) % 900));
        child.kill().expect("SIGKILL");
        child.wait().expect("ends");
    }
    run(&["--jobs", "2", "--resume"], &killed);
    assert_eq!(outputs(&killed), outputs(&whole));
    assert!(report(&whole).results.iter().all(|family| family.scans.iter().all(|scan| !scan.cells.is_empty())));
}

#[test]
fn a_piece_of_a_line_is_dropped_and_its_cell_run_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let (whole, cut) = (folder.path().join("whole"), folder.path().join("cut"));
    run(&[], &whole);
    fs::create_dir(&cut).expect("a folder");
    fs::copy(whole.join("suite.json"), cut.join("suite.json")).expect("copied");
    let cells = fs::read(whole.join("cells.jsonl")).expect("readable");
    let half = cells.len() / 2;
    assert_ne!(cells[half - 1], b'\n', "the cut is within a line");
    fs::write(cut.join("cells.jsonl"), &cells[..half]).expect("written");
    run(&["--resume"], &cut);
    assert_eq!(outputs(&cut), outputs(&whole));
    let lines = |folder: &Path| fs::read_to_string(folder.join("cells.jsonl")).expect("readable").lines().count();
    assert_eq!(lines(&cut), lines(&whole));
}

#[test]
fn shards_merge_to_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    run(&[], &at("whole"));
    for i in 1..=3 {
        run(&["--shard", &format!("{i}/3")], &at(&format!("shard_{i}")));
    }
    let merge = |names: &[&str]| {
        let mut command = rattlebench(&["merge"]);
        command.args(names.iter().map(|name| at(name))).arg("--out").arg(at("merged"));
        command.output().expect("runs")
    };
    let incomplete = merge(&["shard_1", "shard_3"]);
    let message = String::from_utf8_lossy(&incomplete.stderr);
    assert_eq!(incomplete.status.code(), Some(2), "{message}");
    assert!(message.contains(" cells are missing, the first is geometry/size at "), "{message}");
    assert!(merge(&["shard_2", "shard_1", "shard_3"]).status.success());
    assert_eq!(outputs(&at("merged")), outputs(&at("whole")));
}

#[test]
fn another_suite_is_not_resumed() {
    let folder = tempfile::tempdir().expect("a folder");
    run(&["--shard", "1/9"], folder.path());
    let output = command(&["--resume", "--engine", "rapier"], folder.path()).stderr(Stdio::piped()).output();
    let output = output.expect("runs");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        message.contains("holds another suite: the list of engines is 'rattle rapier:preset=strong' there"),
        "{message}"
    );
}

#[test]
fn charts_are_drawn_again_from_the_json() {
    let folder = tempfile::tempdir().expect("a folder");
    let (first, again) = (folder.path().join("first"), folder.path().join("again"));
    run(&[], &first);
    let mut command = rattlebench(&["chart"]);
    let status = command.arg(first.join("stability.json")).arg("--out").arg(&again).status();
    assert!(status.expect("runs").success());
    for name in ["stability_start.png", "stability_geometry.png", "index.html"] {
        assert_eq!(fs::read(first.join(name)).expect("drawn"), fs::read(again.join(name)).expect("drawn"), "{name}");
    }
}

fn scan(name: &str) -> (&'static Family, &'static Scan) {
    let all = FAMILIES.into_iter().flat_map(|family| family.scans.iter().map(move |scan| (family, scan)));
    all.into_iter().find(|(family, scan)| scan.id(family) == name).expect("a scan")
}

/// The classes of `rattle` at a value of a scan, from a step (units of the clock) down by halves until it is accurate.
fn halved(name: &str, value: f64, step: f64) -> Vec<Finding> {
    let (family, scan) = scan(name);
    let (case, engine) = (Case::new(family, scan, value), Spec::parse("rattle").expect("a spec"));
    let running = AtomicBool::new(false);
    let truth = case.truth(&running).expect("not interrupted");
    let mut findings: Vec<Finding> = Vec::new();
    while findings.len() < 12 && findings.last().is_none_or(|last| last.class != Class::Accurate) {
        let step = step / f64::from(1 << findings.len());
        let cell = Cell { case: &case, engine: &engine, step };
        findings.push(cell.run(&truth, &running).expect("not interrupted"));
    }
    findings
}

/// Cells of the suite that are not right at a coarse step, for each reason that there is, with the words of the coarsest.
#[test]
fn what_is_refused_or_wrong_at_a_coarse_step_is_accurate_at_a_finer_one() {
    let turns = "which the step does not resolve";
    let cells = [
        // A body that turns far in a step: warned of, or refused.
        ("spin/top", 300.0, "energy bounds are for less than about 0.3"),
        ("spin/needle", 300.0, "energy bounds are for less than about 0.3"),
        ("spin/rod", 300.0, turns),
        ("geometry/gimbal", 1e-2, turns),
        // Links that sway under a tension.
        ("mass_ratio/snap", 1e3, "the forces in the joints make body 'link_1' sway with h omega = "),
        ("length/hanging", 500.0, "the forces in the joints make body 'link_"),
        // A linkage that passes its flat position in less than a step.
        ("geometry/four_bar", 1e-4, "as where a linkage passes a singular configuration"),
    ];
    for (name, value, words) in cells {
        let findings = halved(name, value, 0.01);
        let story: Vec<(f64, Class, Option<&String>)> =
            findings.iter().map(|f| (f.step, f.class, f.reason.as_ref().or(f.warning.as_ref()))).collect();
        println!("{name} at {value}: {story:#?}");
        assert_eq!(story.last().map(|last| last.1), Some(Class::Accurate), "{name} at {value}: {story:#?}");
        assert!(story[0].2.is_some_and(|reason| reason.contains(words)), "{name} at {value}: {story:#?}");
        for (step, class, reason) in &story {
            assert!(class.is_sound() || reason.is_some(), "{name} at {value}, {step} s: {class:?} without a word");
        }
    }
}

/// What was refused or wrong before the reason was removed: a light body's energy was left out of the energy of a step, a damper
/// far faster than the step left its error in the velocity along the joint, a slider's rail had leverage.
#[test]
fn point_masses_stiff_dampers_and_far_rails_are_right() {
    for (name, value, step) in [
        ("mass_ratio/point_mass", 0.0, 0.01),
        ("mass_ratio/point_mass", 1e-6, 0.01),
        ("mass_ratio/point_mass", 1e-6, 1.0 / 240.0),
        ("mass_ratio/middle_of_3", 0.0, 0.01),
        ("mass_ratio/cart", 0.0, 0.01),
        ("stiffness/joint_damper", 1e6, 0.01),
        ("stiffness/joint_damper", 1e12, 0.01),
        ("stiffness/joint_damper", 1e12, 1e-3),
        ("start/angle", 1e6, 0.01),
        ("mass_ratio/tip_of_2", 1e7, 0.01),
        ("geometry/offset", 1e6, 1e-4),
    ] {
        let finding = &halved(name, value, step)[0];
        println!("{name} at {value}, {step} s: {:?} {:?} {:?}", finding.class, finding.energy, finding.pose_error);
        assert!(finding.class.is_sound(), "{name} at {value}, {step} s: {finding:?}");
        // A damper's balance was wrong by 0.02 (1e4 N m s/rad, 10 ms) to 1e6 scales; measured 9.3e-4.
        let balance = finding.energy.map_or(f64::INFINITY, |error| error.max);
        assert!(!name.ends_with("damper") || balance <= 2e-3, "{finding:?}");
        // A rail 1e6 m away turned the box by 0.2 rad; measured 1.9e-5.
        let pose_error = finding.pose_error.unwrap_or(f64::INFINITY);
        assert!(!name.ends_with("offset") || pose_error <= 5e-5, "{finding:?}");
    }
}

/// Every figure of accuracy stands against coordinates and code of another kind wherever these can follow the motion.
#[test]
fn the_truth_is_the_reference_s_unless_that_cannot_follow() {
    let method = |name: &str, value: f64| {
        let (family, scan) = scan(name);
        let known = Case::new(family, scan, value).truth(&AtomicBool::new(false)).expect("not interrupted");
        assert_eq!(known.part(), 1.0, "{name} at {value}");
        known.method
    };
    for (name, value) in [
        ("geometry/ladder", 5.0),
        ("geometry/four_bar", 1e-6),
        ("mass_ratio/tip_of_5", 10.0),
        ("mass_ratio/middle_of_3", 0.0),
        ("mass_ratio/point_mass", 0.0),
        ("spin/top", 1000.0),
        ("stiffness/joint_spring", 1e4),
    ] {
        assert_eq!(method(name, value), "reference", "{name} at {value}");
    }
    assert!(method("stiffness/joint_spring", 1e12).starts_with("rattle at "));
    assert!(method("length/hanging", 200.0).starts_with("rattle:order=4 at "));
}

/// A slack chain that a heavy tip pulls taut moves on in times far below the step.
#[test]
fn a_chain_that_snaps_taut_is_right_at_fine_steps_and_never_wrong_without_a_word() {
    let findings = halved("mass_ratio/snap", 1e3, 0.01);
    assert_eq!(findings.last().map(|last| last.class), Some(Class::Accurate));
    let silent = findings.iter().find(|f| !f.class.is_sound() && f.reason.is_none() && f.warning.is_none());
    assert_eq!(silent.map(|f| (f.step, f.class)), None);
}

#[test]
fn a_state_that_is_impossible_is_refused_at_every_step_and_says_why() {
    for (name, value, words) in [
        ("start/open_loop", 1e-3, "loop 'loop_3_ground' cannot be closed"),
        ("start/velocity", 1.0, "the initial velocities open loop 'loop_3_ground'"),
    ] {
        for finding in halved(name, value, 0.01) {
            assert_eq!(finding.class, Class::Refused, "{finding:?}");
            assert!(finding.reason.as_ref().is_some_and(|reason| reason.contains(words)), "{finding:?}");
        }
        // The same scene without what is impossible.
        assert_eq!(halved(name, 0.0, 0.01).last().map(|f| f.class), Some(Class::Accurate), "{name}");
    }
}
