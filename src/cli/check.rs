//! `check`: keeps the figures of runs within the bounds of their scenes.

use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::{CliError, input, interrupt, progress};
use crate::check::run::{self, Settings, Unit};
use crate::check::{
    CheckError, Finding, QUICK_STEPS, Requirement, Scope, baseline, controls, github, judge, junit, propose,
    requirements, scoped, summary, table,
};
use crate::mechanics::System;
use crate::model::{Scene, read_bounds};
use crate::report::Report;
use crate::report::charts::broken_bound::{self, Broken};
use crate::report::folder::files;

/// Hold the figures of runs to the bounds of their scenes.
///
/// Exit code 0 where every bound is kept, 1 where one is broken, 2 where a bound or a scene cannot be used. A run that
/// does not complete breaks its bounds.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scene .json files, or .urdf files with --bounds [default: models/*/scene.json].
    input: Vec<PathBuf>,
    /// File {"bounds": [...]} whose bounds replace those of every scene.
    #[arg(long, value_name = "FILE")]
    bounds: Option<PathBuf>,
    /// Only bounds on runs of at most 1e5 steps.
    #[arg(long)]
    quick: bool,
    /// JUnit XML to write.
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Markdown to write; within GitHub Actions the summary of the job gets it as well.
    #[arg(long, value_name = "FILE")]
    summary: Option<PathBuf>,
    /// Earlier report.json; may be given several times. What has become worse than there by more than a factor 2 (ratios
    /// of processor time 1.5) counts as broken.
    #[arg(long, value_name = "REPORT")]
    baseline: Vec<PathBuf>,
    /// Measure, and write bounds of the smallest of 1, 2, 5 x 10^k above twice each figure to bounds.json.
    #[arg(long, conflicts_with_all = ["junit", "summary", "baseline", "controls"])]
    propose: bool,
    /// Run bad integrators against the same bounds and tell which bounds catch none of them.
    #[arg(long)]
    controls: bool,
    /// Folder for reports and charts; a folder for each scene within [default: reports/<scene>/check].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Threads for runs that are not timed [default: one a core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
}

/// A scene with its bounds.
struct Task {
    path: PathBuf,
    /// Where the bounds stand.
    source: PathBuf,
    scene: Scene,
    system: System,
    requirements: Vec<Requirement>,
    left_out: usize,
    earlier: Vec<Report>,
    folder: PathBuf,
}

/// What is told of a scene.
struct Told {
    findings: Vec<Finding>,
    charts: Vec<String>,
    notes: Vec<String>,
    worse: Vec<baseline::Worse>,
}

pub fn run(args: &Args) -> Result<(), CliError> {
    let inputs = if args.input.is_empty() { input::shipped(Path::new("models"))? } else { args.input.clone() };
    let earlier = args.baseline.iter().map(|path| read_report(path)).collect::<Result<Vec<Report>, CliError>>()?;
    let tasks = inputs.iter().map(|path| task(args, &earlier, path)).collect::<Result<Vec<Task>, CliError>>()?;
    if let (Some(first), true) = (tasks.first(), tasks.iter().all(|t| !args.propose && is_idle(t))) {
        return Err(CheckError::NoBounds { input: first.path.clone() }.into());
    }
    for (i, task) in tasks.iter().enumerate() {
        if let Some(other) = tasks[..i].iter().find(|other| other.folder == task.folder) {
            let (first, second) = (other.path.clone(), task.path.clone());
            return Err(CliError::SameName { name: task.scene.name.clone(), first, second });
        }
        files::prepare(&task.folder)?;
    }
    for file in args.junit.iter().chain(&args.summary) {
        files::prepare_for(file)?;
    }
    let runner = Runner { jobs: jobs(args), interrupted: interrupt::flag() };
    if args.propose {
        return tasks.iter().try_for_each(|task| propose_bounds(task, &runner));
    }
    let told = tasks.iter().map(|task| check(args, task, &runner)).collect::<Result<Vec<Told>, CliError>>()?;
    write_junit(args, &tasks, &told)?;
    write_summary(args, &tasks, &told)?;
    conclude(&tasks, &told)
}

fn is_idle(task: &Task) -> bool {
    task.requirements.is_empty() && task.left_out == 0 && task.earlier.is_empty()
}

fn jobs(args: &Args) -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    args.jobs.map_or_else(cores, usize::from)
}

fn read_report(path: &Path) -> Result<Report, CliError> {
    let text = std::fs::read_to_string(path).map_err(|error| CliError::Read { path: path.to_path_buf(), error })?;
    Report::from_json(&text).map_err(|error| CliError::Report { path: path.to_path_buf(), error })
}

fn task(args: &Args, earlier: &[Report], path: &Path) -> Result<Task, CliError> {
    let scene = input::scene(path)?;
    let system = input::system(path, &scene)?;
    let (source, bounds) = match &args.bounds {
        Some(file) => (file.clone(), read_bounds(file)?),
        None => (path.to_path_buf(), scene.bounds.clone()),
    };
    let all = requirements(&source, &bounds, &system)?;
    let (requirements, left_out) = scoped(all, if args.quick { Scope::Quick } else { Scope::All });
    let folder = match &args.out {
        Some(out) => out.join(&scene.name),
        None => Path::new("reports").join(&scene.name).join("check"),
    };
    let earlier = earlier.iter().filter(|r| r.scene.name == scene.name).cloned().collect();
    Ok(Task { path: path.to_path_buf(), source, scene, system, requirements, left_out, earlier, folder })
}

/// Takes runs with a progress bar.
struct Runner {
    jobs: usize,
    interrupted: &'static AtomicBool,
}

impl Runner {
    fn take(&self, task: &Task, name: &'static str, units: &[Unit]) -> Result<Report, CliError> {
        let taken = AtomicU64::new(0);
        let settings = Settings { jobs: self.jobs, interrupted: self.interrupted, taken: &taken };
        let stages = [progress::Stage::new(name, run::steps(units), &taken)];
        let found = progress::during(&task.scene.name, &stages, || run::run(&task.system, units, &settings));
        if self.interrupted.load(Ordering::Relaxed) {
            return Err(CliError::Interrupted);
        }
        Ok(Report::of_study(&task.scene, &task.system, &found, input::command_line()))
    }
}

fn propose_bounds(task: &Task, runner: &Runner) -> Result<(), CliError> {
    let wanted = run::units(&task.requirements);
    let units = if wanted.is_empty() { propose::default_units(&task.scene)? } else { wanted };
    let report = runner.take(task, "measuring", &units)?;
    let text = propose::json(&propose::bounds(&report))?;
    let file = task.folder.join("bounds.json");
    files::write_whole(&file, text.as_bytes())?;
    eprintln!("remark: {}: proposed bounds are in {}", task.path.display(), file.display());
    let unfinished = report.runs.iter().filter_map(|r| r.outcome_detail.as_ref().map(|d| (&r.engine, d)));
    unfinished.for_each(|(engine, detail)| eprintln!("remark: {}: {engine}: {detail}", task.path.display()));
    write!(std::io::stdout().lock(), "{text}")?;
    Ok(())
}

fn check(args: &Args, task: &Task, runner: &Runner) -> Result<Told, CliError> {
    let mut units = run::units(&task.requirements);
    let mut notes = Vec::new();
    let longest = if args.quick { QUICK_STEPS } else { u64::MAX };
    for earlier in &task.earlier {
        let (more, lost) = baseline::units(earlier, &task.system, longest);
        for unit in &more {
            unit.engines.iter().for_each(|spec| run::add(&mut units, spec, unit.horizon, unit.need));
        }
        notes.extend(lost.into_iter().map(|l| format!("not compared with the baseline: {l}")));
    }
    let report = runner.take(task, "checking", &units)?;
    files::write_whole(&task.folder.join("report.json"), report.to_json()?.as_bytes())?;
    let findings = judge(&task.requirements, &report);
    let mut worse = Vec::new();
    for earlier in &task.earlier {
        let (compared, found) = baseline::compare(earlier, &report);
        notes.push(format!("baseline: {} of {compared} figures have become worse", found.len()));
        worse.extend(found);
    }
    notes.extend(worse.iter().map(|w| format!("worse than the baseline: {}", w.sentence)));
    if task.left_out > 0 {
        notes
            .push(format!("{} bounds on runs of more than {QUICK_STEPS} steps are left out by --quick", task.left_out));
    }
    let charts = draw(task, &report, &findings)?;
    let mut text = match (findings.is_empty(), is_idle(task)) {
        (false, _) => table::text(&task.scene.name, &findings),
        (true, true) => format!("{}\n  no bounds: nothing is checked\n", task.scene.name),
        (true, false) => format!("{}\n", task.scene.name),
    };
    notes.iter().for_each(|note| text += &format!("  {note}\n"));
    charts.iter().for_each(|chart| text += &format!("  {chart}\n"));
    if args.controls {
        text += &control(task, runner)?;
    }
    writeln!(std::io::stdout().lock(), "{text}")?;
    Ok(Told { findings, charts, notes, worse })
}

fn control(task: &Task, runner: &Runner) -> Result<String, CliError> {
    let controlled = controls::requirements(&task.requirements, &controls::available(), &task.system);
    let report = runner.take(task, "controls", &run::units(&controlled))?;
    let results = controls::results(&task.requirements, &controlled, &report);
    Ok(controls::text(&task.scene.name, &results))
}

/// A chart of every broken bound; charts of an earlier check are removed.
fn draw(task: &Task, report: &Report, findings: &[Finding]) -> Result<Vec<String>, CliError> {
    for old in std::fs::read_dir(&task.folder)?.flatten() {
        if old.file_name().to_string_lossy().starts_with("broken_") {
            std::fs::remove_file(old.path())?;
        }
    }
    let mut paths = Vec::new();
    for finding in findings.iter().filter(|f| !f.passed) {
        let r = &finding.requirement;
        let of = |run: &&crate::report::record::run::Run| {
            run.engine == r.engine.to_string() && run.step_s == r.horizon.step && run.steps == r.horizon.steps
        };
        let Some(run) = report.runs.iter().find(of) else { continue };
        let broken = Broken {
            scene: &task.scene.name,
            metric: r.metric.name,
            unit: r.metric.unit,
            measured: &finding.measured_text(),
            required: &r.limits(),
            figure: finding.measured,
            max: r.max,
            min: r.min,
        };
        let number: String = r.key.chars().filter(char::is_ascii_digit).collect();
        let path = task.folder.join(format!("broken_{number}_{}.png", r.metric.name.replace('.', "_")));
        files::write_whole(&path, &broken_bound::draw(run, &broken).map_err(files::WriteError::from)?)?;
        paths.push(path.display().to_string());
    }
    Ok(paths)
}

fn write_junit(args: &Args, tasks: &[Task], told: &[Told]) -> Result<(), CliError> {
    let Some(file) = &args.junit else { return Ok(()) };
    let scenes: Vec<(&str, &[Finding])> =
        tasks.iter().zip(told).map(|(task, told)| (task.scene.name.as_str(), &told.findings[..])).collect();
    Ok(files::write_whole(file, junit::xml(&scenes)?.as_bytes())?)
}

fn write_summary(args: &Args, tasks: &[Task], told: &[Told]) -> Result<(), CliError> {
    let parts: Vec<summary::Part> = tasks
        .iter()
        .zip(told)
        .map(|(task, told)| summary::Part {
            scene: &task.scene.name,
            findings: &told.findings,
            charts: &told.charts,
            notes: &told.notes,
        })
        .collect();
    let text = summary::markdown(&parts);
    if let Some(file) = &args.summary {
        files::write_whole(file, text.as_bytes())?;
    }
    // The job's summary is added to, since other steps write into it too.
    if let Some(path) = std::env::var_os(github::STEP_SUMMARY).filter(|p| !p.is_empty()).map(PathBuf::from) {
        let added =
            OpenOptions::new().create(true).append(true).open(&path).and_then(|mut f| f.write_all(text.as_bytes()));
        added.map_err(|error| CliError::Summary { path, error })?;
    }
    Ok(())
}

fn conclude(tasks: &[Task], told: &[Told]) -> Result<(), CliError> {
    let count = |f: &dyn Fn(&Told) -> usize| told.iter().map(f).sum::<usize>();
    let broken = count(&|t| t.findings.iter().filter(|f| !f.passed).count());
    let (bounds, worse) = (count(&|t| t.findings.len()), count(&|t| t.worse.len()));
    let mut out = std::io::stdout().lock();
    if std::env::var(github::ACTIONS).is_ok_and(|v| v == "true") {
        for (task, told) in tasks.iter().zip(told) {
            let (scene, file) = (&task.scene.name, task.source.display().to_string());
            for finding in told.findings.iter().filter(|f| !f.passed) {
                writeln!(out, "{}", github::annotation(&file, scene, finding))?;
            }
            for worse in &told.worse {
                writeln!(out, "{}", github::error(&file, &format!("{scene}: {}", worse.metric), &worse.sentence))?;
            }
        }
    }
    if broken + worse > 0 {
        return Err(CliError::Broken { broken, bounds, worse });
    }
    writeln!(out, "{bounds} bounds kept")?;
    Ok(())
}
