//! The command line as scripts see it: exit codes, messages, outputs.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use rattlebench::report::Report;
use rattlebench::report::record::run::Outcome;

use crate::common::rattlebench;

const PENDULUM: &str = "models/double_pendulum/scene.json";

/// Runs, checks the exit code, and returns stdout and stderr.
fn run(arguments: &[&str], code: i32) -> (String, String) {
    let output = rattlebench(arguments).output().expect("runs");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    let (stdout, stderr) = (text(output.stdout), text(output.stderr));
    assert_eq!(output.status.code(), Some(code), "{arguments:?}\n{stdout}\n{stderr}");
    (stdout, stderr)
}

/// Expects exit code 2, nothing on stdout, and exactly this on stderr.
fn refused(arguments: &[&str], message: &str) {
    assert_eq!(run(arguments, 2), (String::new(), format!("error: {message}\n")), "{arguments:?}");
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

/// A CSV's header and rows.
fn csv(text: &str) -> (Vec<&str>, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let header = lines.next().expect("a header").split(',').collect();
    let rows = lines.map(|line| line.split(',').map(|x| x.parse().expect("a number")).collect()).collect();
    (header, rows)
}

fn simulate<'a>(engine: &'a str, step: &'a str, duration: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["simulate", PENDULUM, "--engine", engine, "--step", step, "--duration", duration];
    arguments.extend(more);
    arguments
}

#[test]
fn numbers_that_cannot_be_are_refused_by_name() {
    refused(&simulate("rattle", "-0.01", "1", &[]), "--step must be > 0 s, got -0.01");
    refused(&simulate("rattle", "0.01", "0", &[]), "--duration must be > 0 s, got 0");
    refused(&simulate("rattle", "nan", "1", &[]), "--step must be > 0 s, got NaN");
    refused(&simulate("rattle", "0.01", "1", &["--sample", "-1"]), "--sample must be > 0 s, got -1");
    refused(&["compare", PENDULUM, "--step", "-0.01"], "--step must be > 0 s, got -0.01");
    refused(&["compare", PENDULUM, "--budget", "0"], "--budget must be > 0 s, got 0");
    refused(
        &simulate("rattle", "0.01", "0.035", &[]),
        "--duration 0.035 s is not a whole number of steps of 0.01 s; use --step 0.00875 or --step 0.0116666666667, or \
         --duration 0.03 or 0.04",
    );
    refused(
        &simulate("rattle", "0.01", "1", &["--sample", "0.025"]),
        "--sample 0.025 s is not a whole number of steps of 0.01 s; use 0.02 or 0.03",
    );
    let (_, stderr) = run(&simulate("rattle", "soon", "1", &[]), 2);
    assert!(stderr.starts_with("error: invalid value 'soon' for '--step <H>'"), "{stderr}");
}

#[test]
fn unknown_engines_keys_joints_and_files_are_refused_with_what_is_known() {
    let (_, stderr) = run(&simulate("ratle", "0.01", "1", &[]), 2);
    assert!(stderr.starts_with("error: --engine: engine 'ratle' is not known; engines are: rattle, "), "{stderr}");
    let (_, stderr) = run(&["compare", PENDULUM, "--engine", "rapier:joint=impulse"], 2);
    assert!(stderr.starts_with("error: --engine: engine 'rapier' has no key 'joint'; keys are: joints, "), "{stderr}");
    let set = |text: &str| run(&simulate("rattle", "0.01", "1", &["--set", text]), 2).1;
    assert_eq!(
        set("knee=1"),
        "error: --set knee=1: joint 'knee' is not a joint that moves; joints are: shoulder, elbow\n"
    );
    assert_eq!(set("elbow"), "error: --set elbow: is not of the form JOINT=POS[:VEL]\n");
    assert_eq!(set("elbow=a"), "error: --set elbow=a: 'a' is not a number\n");
    assert_eq!(set("elbow=1,2"), "error: --set elbow=1,2: joint 'elbow' has 1 coordinate, got 2\n");
    let (_, stderr) = run(&["compare", "models/none/scene.json"], 2);
    assert!(stderr.starts_with("error: models/none/scene.json: "), "{stderr}");
}

#[test]
fn a_bare_command_shows_its_usage() {
    let (_, stderr) = run(&[], 2);
    assert!(stderr.contains("Usage: rattlebench <COMMAND>"), "{stderr}");
    for command in ["inspect", "simulate", "compare", "cost", "generate", "chart", "list", "schema"] {
        assert!(stderr.contains(command), "{stderr}");
        let (stdout, _) = run(&[command, "--help"], 0);
        assert!(stdout.contains("Usage: rattlebench"), "{stdout}");
    }
}

#[test]
fn places_that_cannot_be_written_are_found_before_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    fs::write(&file, "taken").expect("writable");
    let inside = file.join("out.csv");
    // A run of ten million steps would take longer than the test may.
    let (_, stderr) = run(&simulate("rattle", "1e-6", "10", &["--output", text(&inside)]), 2);
    assert!(stderr.starts_with(&format!("error: --output {}: ", inside.display())), "{stderr}");
    let (_, stderr) = run(&simulate("rattle", "1e-6", "10", &["--output", text(folder.path())]), 2);
    assert_eq!(stderr, format!("error: --output {}: is a directory\n", folder.path().display()));
    let (_, stderr) = run(&["compare", PENDULUM, "--step", "1e-6", "--out", text(&file)], 2);
    assert!(stderr.starts_with(&format!("error: {}: the folder cannot be made: ", file.display())), "{stderr}");
}

#[test]
fn a_simulation_starts_at_zero_ends_at_the_duration_and_reads_back() {
    let (stdout, stderr) = run(&simulate("rattle", "0.01", "1", &["--sample", "0.03", "--set", "elbow=7:0.5"]), 0);
    assert_eq!(stderr, "");
    let (header, rows) = csv(&stdout);
    assert_eq!(
        header,
        [
            "time_s",
            "position:shoulder",
            "velocity:shoulder",
            "position:elbow",
            "velocity:elbow",
            "kinetic_energy_J",
            "potential_energy_J",
            "energy_J",
            "constraint_position",
            "constraint_velocity"
        ]
    );
    // 0, 0.03, ..., 0.99, and the end.
    assert_eq!((rows.len(), rows[0][0], rows[1][0], rows[34][0]), (35, 0.0, 0.03, 1.0));
    assert!((rows[0][3] - 7.0).abs() < 1e-14 && rows[1][3] > 7.0, "angles are not wrapped: {:?}", &rows[..2]);
    for (line, row) in stdout.lines().skip(1).zip(&rows) {
        let again: Vec<String> = row.iter().map(|x| format!("{x:?}")).collect();
        assert_eq!(line, again.join(","));
        assert_eq!(row[5] + row[6], row[7]);
    }
}

#[test]
fn a_free_body_is_written_as_the_frame_of_its_root_link() {
    let arguments = ["simulate", "models/tumbling_body/scene.json", "--engine", "rattle", "--step", "0.01"];
    let (stdout, _) = run(&[&arguments[..], &["--duration", "0.5"]].concat(), 0);
    let (header, rows) = csv(&stdout);
    assert_eq!(header[1..4], ["position:base:x", "position:base:y", "position:base:z"]);
    assert_eq!(header[8], "velocity:base:vx");
    let (first, last) = (&rows[0], &rows[50]);
    // No force acts: the centre of mass, which is the frame's origin here, moves on a straight line.
    for axis in 1..4 {
        assert!((last[axis] - first[axis] - 0.5 * first[axis + 7]).abs() < 1e-13, "{first:?}\n{last:?}");
    }
}

#[test]
fn a_file_holds_what_stdout_would_show() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("run.csv");
    let (stdout, _) = run(&simulate("rapier", "0.01", "0.2", &[]), 0);
    let (nothing, _) = run(&simulate("rapier", "0.01", "0.2", &["--output", text(&file)]), 0);
    assert_eq!((nothing.as_str(), fs::read_to_string(&file).expect("written")), ("", stdout));
    assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 1, "no temporary file is left");
}

/// As root, a rename over `/dev/null` would take the device from everybody.
#[cfg(unix)]
#[test]
fn what_is_no_regular_file_is_written_into_and_stays_what_it_is() {
    use std::os::unix::fs::FileTypeExt;
    let folder = tempfile::tempdir().expect("a folder");
    let (stdout, _) = run(&simulate("rapier", "0.01", "0.2", &[]), 0);
    let (pipe, file, link) = (folder.path().join("pipe"), folder.path().join("run.csv"), folder.path().join("link"));
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("runs").success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read_to_string(pipe).expect("readable")
    });
    run(&simulate("rapier", "0.01", "0.2", &["--output", text(&pipe)]), 0);
    assert_eq!(reader.join().expect("read to its end"), stdout);
    assert!(fs::metadata(&pipe).expect("there").file_type().is_fifo());

    fs::write(&file, "before").expect("writable");
    std::os::unix::fs::symlink(&file, &link).expect("a link");
    run(&simulate("rapier", "0.01", "0.2", &["--output", text(&link)]), 0);
    assert_eq!(fs::read_to_string(&file).expect("written through the link"), stdout);
    assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
}

#[test]
fn a_run_that_fails_keeps_its_rows_and_exits_with_3() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("run.csv");
    // Rods that fast leave the range of single precision after a few steps.
    let wild = ["--set", "elbow=0:1e19", "--output", text(&file)];
    let (_, stderr) = run(&simulate("rapier", "0.1", "100", &wild), 3);
    assert!(stderr.starts_with("error: rapier: "), "{stderr}");
    let written = fs::read_to_string(&file).expect("rows are kept");
    let (_, rows) = csv(&written);
    assert!(!rows.is_empty() && rows.len() < 1001 && rows.iter().flatten().all(|x| x.is_finite()), "{}", rows.len());
}

#[test]
fn a_reader_that_stops_early_is_no_error() {
    let mut child = rattlebench(&simulate("rattle", "0.0001", "10", &[]))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("ends");
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]));
}

#[test]
fn simulations_and_comparisons_warn_of_bodies_that_turn_far_in_a_step() {
    let top = "models/heavy_top/scene.json";
    let run_at = |engine: &str, step: &str| {
        run(&["simulate", top, "--engine", engine, "--step", step, "--duration", "0.1", "--output", "-"], 0).1
    };
    let warning =
        "body 'top' turns by 0.41 rad in a step; energy bounds are for less than about 0.3: take a step below";
    assert_eq!(run_at("rattle", "0.001"), "");
    let told = run_at("rattle", "0.01");
    assert!(told.starts_with("warning: rattle: ") && told.contains(warning), "{told}");
    assert_eq!(run_at("dop853", "0.01"), "", "it chooses its steps");
    let folder = tempfile::tempdir().expect("a folder");
    let engines =
        ["--engine", "rattle", "--engine", "dop853", "--step", "0.01", "--step", "0.001", "--duration", "0.5"];
    let arguments = [&["compare", top, "--out", text(folder.path())][..], &engines].concat();
    let (_, stderr) = run(&arguments, 0);
    assert!(stderr.starts_with("warning: rattle at 10 ms: ") && stderr.contains(warning), "{stderr}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    let warned: Vec<bool> = report(folder.path()).runs.iter().map(|run| run.warning.is_some()).collect();
    assert_eq!(warned.iter().filter(|warned| **warned).count(), 1, "{warned:?}");
    assert!(fs::read_to_string(folder.path().join("index.html")).expect("written").contains("energy bounds are for"));
}

#[test]
fn an_engine_that_does_not_take_the_scene_says_why_once_for_all_steps() {
    let folder = tempfile::tempdir().expect("a folder");
    let damped = "models/damped_pendulum/scene.json";
    let engines = ["--engine", "rattle", "--engine", "rattle:order=8", "--quick"];
    let (stdout, _) = run(&[&["compare", damped, "--out", text(folder.path())][..], &engines].concat(), 0);
    let reasons: Vec<&str> = stdout.lines().filter(|line| line.starts_with("rattle:order=8 at ")).collect();
    let report = report(folder.path());
    let detail = report.runs[2].outcome_detail.as_deref().expect("a reason");
    assert_eq!((report.runs[2].outcome, detail.is_empty()), (Outcome::Unsupported, false));
    assert_eq!(reasons, [format!("rattle:order=8 at 10 ms, 5 ms: {detail}")], "{stdout}");
}

/// A quick comparison into a fresh folder.
fn compare(more: &[&str]) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let (stdout, stderr) = run(&[&["compare", PENDULUM, "--quick", "--out", text(folder.path())], more].concat(), 0);
    assert_eq!(stderr, "", "neither a bar nor colours without a terminal");
    (folder, stdout)
}

fn report(folder: &Path) -> Report {
    Report::from_json(&fs::read_to_string(folder.join("report.json")).expect("written")).expect("a report")
}

#[test]
fn a_comparison_leaves_a_report_that_needs_no_network() {
    let (folder, stdout) = compare(&[]);
    let report = report(folder.path());
    assert_eq!(report.runs.len(), 14, "seven engines at the two largest steps");
    assert!(report.runs.iter().all(|r| r.outcome == Outcome::Completed && r.duration_s == 2.0));
    for run in &report.runs {
        let (energy, time) = (run.energy.as_ref().expect("energy"), run.time.as_ref().expect("time"));
        assert!(energy.max_relative_error > 0.0 && time.us_per_step > 0.0 && time.repeats >= 5, "{}", run.engine);
        assert_eq!(energy.time_level_corrected.is_some(), run.engine.starts_with("rapier"));
    }
    let page = fs::read_to_string(folder.path().join("index.html")).expect("written");
    assert!(!page.contains("http") && !page.contains("<script") && !page.contains("<link"));
    assert_eq!(page.matches("src=\"data:image/png;base64,").count(), 5);
    assert_eq!(page.matches("src=").count(), 5);
    let sweep = report.sweep.as_ref().expect("a sweep");
    assert!(sweep.runs.iter().all(|r| r.series.is_none() && r.accuracy.is_some() && r.time.is_some()));
    assert_eq!(sweep.targets.len(), 4, "the reference is good enough for every target");
    assert!(report.parity.as_ref().is_some_and(|parity| parity.agrees && parity.engines.len() >= 5));
    assert!(stdout.contains("\nFor joint positions to 10"), "{stdout}");
    assert!(stdout.starts_with("double_pendulum\nAt a step of "), "{stdout}");
    assert!(stdout.contains("rapier:joints=multibody,precision=f64\n"), "{stdout}");
    assert!(stdout.ends_with(&format!("{}\n\n", folder.path().join("index.html").display())), "{stdout}");
}

#[test]
fn the_cost_of_a_step_is_told_for_every_engine_and_length() {
    let folder = tempfile::tempdir().expect("a folder");
    let chains = ["--links", "2", "--links", "1", "--out", text(folder.path())];
    let (stdout, _) = run(&[&["cost", "--engine", "rattle", "--engine", "rapier"], &chains[..]].concat(), 0);
    let json = fs::read_to_string(folder.path().join("cost.json")).expect("written");
    let cost: rattlebench::report::record::cost::Cost = serde_json::from_str(&json).expect("a record");
    let points: Vec<(&str, usize)> = cost.points.iter().map(|p| (p.engine.as_str(), p.links)).collect();
    assert_eq!(points, [("rattle", 1), ("rattle", 2), ("rapier", 1), ("rapier", 2)]);
    assert!(cost.points.iter().all(|p| p.us_per_step > 0.0 && p.us_per_step_min <= p.us_per_step_max), "{json}");
    assert!(fs::read(folder.path().join("cost.png")).expect("written").starts_with(b"\x89PNG"));
    assert!(stdout.starts_with("µs a step, links:") && stdout.contains("\nrattle "), "{stdout}");
    refused(&["cost", "--step", "-1"], "--step must be > 0 s, got -1");
}

/// Everything of a report but what the machine and the clock say.
fn timeless(mut report: Report) -> String {
    report.runs.iter_mut().for_each(|run| run.time = None);
    report.timing = None;
    if let Some(sweep) = &mut report.sweep {
        sweep.runs.iter_mut().for_each(|run| run.time = None);
        sweep.targets.clear();
        sweep.expectations.clear();
    }
    report.command = String::new();
    report.to_json().expect("JSON")
}

#[test]
fn two_comparisons_differ_only_in_their_timing() {
    let ((first, _), (second, _)) = (compare(&["--jobs", "2"]), compare(&["--jobs", "1"]));
    assert_eq!(timeless(report(first.path())), timeless(report(second.path())));
    for chart in ["convergence.png", "energy_drift.png", "constraint_violation.png"] {
        let bytes = |folder: &Path| fs::read(folder.join(chart)).expect("written");
        assert!(bytes(first.path()) == bytes(second.path()), "{chart}");
        assert!(bytes(first.path()).starts_with(b"\x89PNG"));
    }
    // The comparison can tell reports apart.
    let mut other = report(second.path());
    other.runs[0].energy.as_mut().expect("energy").max_relative_error *= 1.0 + 1e-15;
    assert_ne!(timeless(report(first.path())), timeless(other));
}

#[test]
fn charts_drawn_again_are_the_same_bytes() {
    let (folder, _) = compare(&["--engine", "rattle"]);
    let again = tempfile::tempdir().expect("a folder");
    let saved = folder.path().join("report.json");
    let (stdout, _) = run(&["chart", text(&saved), "--out", text(again.path())], 0);
    assert_eq!(stdout, format!("{}\n", again.path().join("index.html").display()));
    for file in [
        "work_precision.png",
        "convergence.png",
        "energy_drift.png",
        "constraint_violation.png",
        "error_vs_run_time.png",
        "index.html",
    ] {
        let bytes = |folder: &Path| fs::read(folder.join(file)).expect("written");
        assert!(bytes(folder.path()) == bytes(again.path()), "{file}");
    }
    assert!(!again.path().join("report.json").exists());
}

#[test]
fn what_is_no_report_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("report.json");
    fs::write(&file, r#"{"schema": "rattlebench/report/0"}"#).expect("writable");
    refused(
        &["chart", text(&file)],
        &format!(
            "{}: \"schema\" is \"rattlebench/report/0\"; this program reads \"rattlebench/report/1\"",
            file.display()
        ),
    );
    let missing: PathBuf = folder.path().join("none.json");
    let (_, stderr) = run(&["chart", text(&missing)], 2);
    assert!(stderr.starts_with(&format!("error: {}: cannot be read: ", missing.display())), "{stderr}");
}

#[test]
fn scenes_of_one_name_do_not_overwrite_each_other() {
    refused(
        &["compare", PENDULUM, "models/double_pendulum/double_pendulum.urdf", "--quick"],
        "models/double_pendulum/scene.json and models/double_pendulum/double_pendulum.urdf are both named \
         'double_pendulum' and would write the same report; run them one by one",
    );
}

#[test]
fn an_engine_over_its_budget_is_a_result_and_the_others_go_on() {
    let folder = tempfile::tempdir().expect("a folder");
    // A thousand steps are a hundredth of the budget, a hundred million a hundred budgets.
    let arguments = ["compare", PENDULUM, "--engine", "rattle", "--step", "0.01", "--step", "1e-7", "--budget", "1"];
    run(&[&arguments[..], &["--out", text(folder.path())]].concat(), 0);
    let report = report(folder.path());
    assert_eq!(report.runs[0].outcome, Outcome::Completed);
    let over = &report.runs[1];
    assert_eq!((over.outcome, over.step_s), (Outcome::OverBudget, 1e-7));
    assert!(over.ended_at_s.is_some_and(|t| t > 0.0 && t < 10.0) && over.time.is_some(), "{:?}", over.ended_at_s);
}

/// `compare` of a short run and of one that would take minutes, interrupted after `wait`: the exit code and, where it was
/// far enough to leave one, the report.
#[cfg(unix)]
fn interrupted_after(wait: std::time::Duration, folder: &Path) -> (Option<i32>, Option<Report>) {
    let arguments = ["compare", PENDULUM, "--engine", "rattle", "--step", "0.01", "--step", "1e-7", "--jobs", "2"];
    let child = rattlebench(&arguments)
        .args(["--budget", "1000", "--out", text(folder)])
        .stdout(Stdio::null())
        .spawn()
        .expect("starts");
    std::thread::sleep(wait);
    let id = child.id().to_string();
    Command::new("kill").args(["-INT", &id]).status().expect("kill");
    let status = child.wait_with_output().expect("ends").status;
    (status.code(), folder.join("report.json").exists().then(|| report(folder)))
}

/// How long the short run takes is the machine's business: the waits grow until it is in the report.
#[cfg(unix)]
#[test]
fn an_interrupted_comparison_keeps_what_is_finished() {
    for wait in [1, 2, 4, 8, 16, 32].map(std::time::Duration::from_secs) {
        let folder = tempfile::tempdir().expect("a folder");
        let (code, report) = interrupted_after(wait, folder.path());
        let Some(report) = report.filter(|report| !report.runs.is_empty()) else { continue };
        assert_eq!(code, Some(130));
        assert!(report.interrupted);
        assert_eq!(report.runs.iter().map(|r| (r.step_s, r.outcome)).collect::<Vec<_>>(), [(0.01, Outcome::Completed)]);
        assert!(folder.path().join("index.html").exists());
        return;
    }
    panic!("the short run was never finished");
}

#[test]
fn lists_and_schemas_can_be_read_by_machines() {
    for what in ["engines", "methods", "scenes", "metrics"] {
        let (json, _) = run(&["list", what, "--json"], 0);
        let items: Vec<serde_json::Value> = serde_json::from_str(&json).expect("JSON");
        let (lines, _) = run(&["list", what], 0);
        assert!(!items.is_empty());
        for item in &items {
            let name = item["name"].as_str().expect("a name");
            assert!(lines.lines().any(|line| line.starts_with(name)), "{what}: {name}");
        }
    }
    let (cost, _) = run(&["schema", "cost"], 0);
    let cost: serde_json::Value = serde_json::from_str(&cost).expect("JSON");
    assert!(cost["properties"]["points"].is_object());
    let (schema, _) = run(&["schema", "report"], 0);
    let schema: serde_json::Value = serde_json::from_str(&schema).expect("JSON");
    assert!(schema["properties"]["runs"].is_object() && schema["$defs"]["Energy"].is_object());
}
