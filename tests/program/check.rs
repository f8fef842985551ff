//! `check` as a build server sees it: exit codes, messages, files.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::common;

const SCENE: &str = "models/damped_pendulum/scene.json";
const PENDULUM: &str = "models/pendulum/scene.json";

fn rattlebench(arguments: &[&str]) -> Command {
    let mut command = common::rattlebench(arguments);
    command.env_remove("GITHUB_ACTIONS").env_remove("GITHUB_STEP_SUMMARY");
    command
}

fn run(command: &mut Command, code: i32) -> (String, String) {
    let output = command.output().expect("runs");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    let (stdout, stderr) = (text(output.stdout), text(output.stderr));
    assert_eq!(output.status.code(), Some(code), "{stdout}\n{stderr}");
    (stdout, stderr)
}

/// A file of bounds; `more` follows engine, step and duration.
fn bounds(folder: &Path, engine: &str, more: &[&str]) -> String {
    let of = |more: &&str| format!(r#"{{"engine": "{engine}", "step": 0.01, "duration": 30.0, {more}}}"#);
    let file = folder.join("bounds.json");
    fs::write(&file, format!(r#"{{"bounds": [{}]}}"#, more.iter().map(of).collect::<Vec<_>>().join(", "))).unwrap();
    file.display().to_string()
}

fn checked(folder: &Path, file: &str, more: &[&str], code: i32) -> (String, String) {
    let out = folder.join("out").display().to_string();
    let mut arguments = vec!["check", PENDULUM, "--bounds", file, "--out", &out];
    arguments.extend(more);
    run(&mut rattlebench(&arguments), code)
}

const KEPT: &str = r#""metric": "energy.max_relative_error", "max": 0.01"#;
const BROKEN: &str = r#""metric": "energy.max_relative_error", "max": 1e-9"#;

#[test]
fn bounds_that_are_kept_end_with_0() {
    let folder = tempfile::tempdir().unwrap();
    let verdict = r#""metric": "energy.verdict", "max": "bounded""#;
    let (stdout, stderr) = checked(folder.path(), &bounds(folder.path(), "rattle", &[KEPT, verdict]), &[], 0);
    assert!(stdout.contains("≤ bounded") && stdout.ends_with("2 bounds kept\n"), "{stdout}");
    assert_eq!(stderr, "");
}

#[test]
fn a_broken_bound_ends_with_1_and_is_told_in_every_form() {
    let folder = tempfile::tempdir().unwrap();
    let name = |file: &str| folder.path().join(file).display().to_string();
    let (junit, summary, job) = (name("junit.xml"), name("summary.md"), name("job.md"));
    fs::write(&job, "before\n").unwrap();
    let file = bounds(folder.path(), "rattle", &[KEPT, BROKEN]);
    let out = name("out");
    let mut command = rattlebench(&["check", PENDULUM, "--bounds", &file, "--out", &out]);
    command.args(["--junit", &junit, "--summary", &summary]);
    command.env("GITHUB_ACTIONS", "true").env("GITHUB_STEP_SUMMARY", &job);
    let (stdout, stderr) = run(&mut command, 1);
    assert_eq!(stderr, "error: 1 of 2 bounds broken\n");
    assert!(stdout.contains("  BROKEN\n"), "{stdout}");
    let annotation = stdout.lines().find(|line| line.starts_with("::error file=")).expect("an annotation");
    assert!(annotation.contains("title=pendulum%3A energy.max_relative_error::rattle, 3000 steps"), "{annotation}");

    let xml = fs::read_to_string(&junit).unwrap();
    let xml = roxmltree::Document::parse(&xml).unwrap();
    let count = |tag: &str| xml.descendants().filter(|n| n.has_tag_name(tag)).count();
    assert_eq!((count("testsuite"), count("testcase"), count("failure")), (1, 2, 1));
    assert_eq!(xml.root_element().attribute("failures"), Some("1"));

    let text = fs::read_to_string(&summary).unwrap();
    assert!(text.contains("1 of 2 bounds broken") && text.contains("| ❌ | `rattle` | 0.01 | 3000 |"), "{text}");
    assert_eq!(fs::read_to_string(&job).unwrap(), format!("before\n{text}"));
    let chart = folder.path().join("out/pendulum/broken_1_energy_max_relative_error.png");
    assert!(fs::read(&chart).unwrap().starts_with(b"\x89PNG"), "{}", chart.display());
    assert!(text.contains("broken_1_energy_max_relative_error.png"), "{text}");

    let repaired = bounds(folder.path(), "rattle", &[KEPT]);
    checked(folder.path(), &repaired, &[], 0);
    assert!(!chart.exists(), "the chart of an earlier check is removed");
}

#[test]
fn malformed_bounds_end_with_2_and_list_what_exists() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |engine: &str, more: &str, expected: &str| {
        let (stdout, stderr) = checked(folder.path(), &bounds(folder.path(), engine, &[more]), &[], 2);
        assert_eq!(stdout, "");
        assert!(stderr.starts_with("error: ") && stderr.contains(expected), "{stderr}");
    };
    refused("ratle", KEPT, "bounds.json: bounds[0]: engine 'ratle' is not known; engines are: rattle, ");
    refused("rattle:order=5", KEPT, "bounds[0]: engine 'rattle': order=5 is not possible; order takes 2|4|6|8");
    let unknown = "bounds[0]: metric 'energy.max' is not known; metrics are: energy.max_relative_error, ";
    refused("rattle", r#""metric": "energy.max", "max": 1"#, unknown);
    let swapped = r#""metric": "energy.max_relative_error", "max": 1, "min": 2"#;
    refused("rattle", swapped, "min 2 is above max 1; swap them or remove one");
    refused("rattle", r#""metric": "energy.max_relative_error", "max": "NaN""#, "max is \"NaN\"; give a number");
    refused("rattle", r#""metric": "energy.max_relative_error", "max": NaN"#, "bounds.json:1:");
    refused("rattle", r#""metric": "energy.max_relative_error", "max": 1e999"#, "bounds.json:1:");
    refused("rattle", r#""metric": "energy.max_relative_error""#, "a bound needs \"max\", \"min\" or both");
    refused(
        "rattle",
        r#""metric": "energy.verdict", "max": "fine""#,
        "verdicts are: bounded, random_walk, drift, blow_up",
    );
    refused("rattle", r#""metric": "time.us_per_step_ratio", "max": 1"#, "needs \"against\"");
    refused("rattle", r#""metric": "energy.verdict", "maximum": 1"#, "maximum");
    let bare = "models/pendulum/pendulum.urdf";
    let (_, stderr) = run(&mut rattlebench(&["check", bare]), 2);
    assert!(
        stderr.contains("has no bounds to check; add \"bounds\" to the scene, give them by --bounds, or let check")
    );
}

#[test]
fn a_run_that_cannot_be_finished_breaks_its_bounds() {
    let folder = tempfile::tempdir().unwrap();
    // A step of 0.5 s is too long for the rotation rule.
    let text = r#"{"bounds": [{"engine": "rattle", "step": 0.5, "duration": 50.0, "metric": "energy.max_relative_error", "max": 10}]}"#;
    let file = folder.path().join("bounds.json");
    fs::write(&file, text).unwrap();
    let (stdout, _) = checked(folder.path(), &file.display().to_string(), &[], 1);
    assert!(stdout.contains("not converged: t = "), "{stdout}");
}

#[test]
fn a_verdict_on_a_short_run_is_not_had() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"{"bounds": [{"engine": "rattle", "step": 0.01, "duration": 1.0, "metric": "energy.verdict", "max": "drift"}]}"#;
    let file = folder.path().join("bounds.json");
    fs::write(&file, text).unwrap();
    let (stdout, _) = checked(folder.path(), &file.display().to_string(), &[], 1);
    assert!(stdout.contains("a run of 100 steps is too short to be judged; take 2000"), "{stdout}");
}

#[test]
fn what_is_proposed_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let file = bounds(folder.path(), "rattle", &[KEPT]);
    let (stdout, _) = checked(folder.path(), &file, &["--propose"], 0);
    let proposed = folder.path().join("out/pendulum/bounds.json");
    assert_eq!(fs::read_to_string(&proposed).unwrap(), stdout);
    assert!(stdout.matches("\"metric\"").count() >= 4 && stdout.contains("\"bounded\""), "{stdout}");
    let (stdout, _) = checked(folder.path(), &proposed.display().to_string(), &[], 0);
    assert!(stdout.contains("bounds kept"), "{stdout}");
}

#[test]
fn a_ratio_of_times_is_taken_within_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let more = r#""metric": "time.us_per_step_ratio", "against": "rattle:order=8", "max": 0.9"#;
    let (stdout, _) = checked(folder.path(), &bounds(folder.path(), "rattle", &[more]), &[], 0);
    assert!(stdout.contains("rattle / rattle:order=8"), "{stdout}");
}

#[test]
fn a_figure_that_worsened_against_a_baseline_ends_with_1() {
    let folder = tempfile::tempdir().unwrap();
    let file = bounds(folder.path(), "rattle", &[KEPT]);
    checked(folder.path(), &file, &[], 0);
    let report = folder.path().join("out/pendulum/report.json");
    let earlier = folder.path().join("earlier.json").display().to_string();
    fs::copy(&report, &earlier).unwrap();
    let (stdout, _) = checked(folder.path(), &file, &["--baseline", &earlier], 0);
    assert!(stdout.contains("baseline: 0 of "), "{stdout}");

    let mut json: serde_json::Value = serde_json::from_str(&fs::read_to_string(&earlier).unwrap()).unwrap();
    let error = json["runs"][0]["energy"]["max_relative_error"].as_f64().unwrap();
    json["runs"][0]["energy"]["max_relative_error"] = (error / 3.0).into();
    fs::write(&earlier, json.to_string()).unwrap();
    let (stdout, stderr) = checked(folder.path(), &file, &["--baseline", &earlier], 1);
    assert!(stdout.contains("worse than the baseline: rattle, 3000 steps of 0.01 s: energy.max_relative_error was"));
    assert_eq!(stderr, "error: 0 of 1 bounds broken, 1 figure worse than the baseline\n");
}

#[test]
fn quick_says_what_it_leaves_out() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display().to_string();
    let (stdout, _) = run(&mut rattlebench(&["check", SCENE, PENDULUM, "--quick", "--out", &out]), 0);
    assert!(stdout.contains("on runs of more than 100000 steps are left out by --quick"), "{stdout}");
}
