//! `compare`: several engines at several step sizes on each scene, and a report of each.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::{CliError, input, interrupt, progress};
use crate::engines::{self, Role, Spec};
use crate::measure::Horizon;
use crate::measure::comparison::{Comparison, Progress};
use crate::measure::cost::sweep::{self, Setting};
use crate::measure::study::Study;
use crate::measure::threads;
use crate::mechanics::System;
use crate::model::Scene;
use crate::report::Report;
use crate::report::folder::{files, report as folder};
use crate::report::words::number::duration;
use crate::report::words::{expectation, finding, summary, table};

/// With `--quick`: no run is longer, s, and no more steps than this are compared, the largest ones.
const QUICK_DURATION: f64 = 2.0;
const QUICK_STEPS: usize = 2;

/// Run several engines at several step sizes on each scene and write a report of each.
///
/// An engine that diverges or does not converge is a result; the other runs go on.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// .urdf files or scene .json files.
    #[arg(required = true)]
    input: Vec<PathBuf>,
    #[arg(long, value_name = "SPEC", help = input::engine_help(Role::Compare))]
    engine: Vec<String>,
    /// Step size, s; may be given several times [default: those of the scene].
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    step: Vec<f64>,
    /// Simulated time, s [default: that of the scene].
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Folder for the report; with several scenes, for one folder each [default: reports/<scene>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Threads for the runs that are measured; those that are timed never share the machine [default: one a core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Wall-clock time that one run may take, and the sweep of settings together, s.
    #[arg(long, value_name = "S", default_value_t = 30.0, allow_negative_numbers = true)]
    budget: f64,
    /// Only the two largest steps, over at most 2 s of simulated time, and a short list of settings.
    #[arg(long)]
    quick: bool,
    /// Examine eight steps of each run too: how far they are from symplectic, reversible and momentum conserving.
    #[arg(long)]
    structure: bool,
}

/// A scene with what is to be run on it.
struct Task {
    path: PathBuf,
    scene: Scene,
    system: System,
    engines: Vec<Spec>,
    horizons: Vec<Horizon>,
    /// Settings that are tried beside them.
    sweep: Vec<Setting>,
    folder: PathBuf,
}

pub fn run(args: &Args) -> Result<(), CliError> {
    let named = input::specs(&args.engine)?;
    let budget = Duration::try_from_secs_f64(input::positive("--budget", args.budget)?).unwrap_or(Duration::MAX);
    let jobs = args.jobs.map_or_else(threads::cores, usize::from);
    // Everything that can be wrong is found before the first run starts.
    let tasks = args.input.iter().map(|path| task(args, &named, path)).collect::<Result<Vec<Task>, CliError>>()?;
    for (i, task) in tasks.iter().enumerate() {
        if let Some(other) = tasks[..i].iter().find(|other| other.folder == task.folder) {
            let (first, second) = (other.path.clone(), task.path.clone());
            return Err(CliError::SameName { name: task.scene.name.clone(), first, second });
        }
    }
    for task in &tasks {
        files::prepare(&task.folder)?;
    }
    let interrupted = interrupt::flag();
    for task in &tasks {
        let comparison = Comparison {
            system: &task.system,
            engines: &task.engines,
            horizons: &task.horizons,
            budget,
            jobs,
            structure: args.structure,
        };
        compare(task, Study { comparison, sweep: &task.sweep }, interrupted)?;
    }
    Ok(())
}

/// The default engines that support a system.
fn default_engines(system: &System, step: f64) -> Result<Vec<Spec>, CliError> {
    let mut specs = input::specs(&engines::line_up(Role::Compare))?;
    specs.retain(|spec| engines::build(spec, system, step).is_ok());
    Ok(specs)
}

fn task(args: &Args, named: &[Spec], path: &Path) -> Result<Task, CliError> {
    let scene = input::scene(path)?;
    let system = input::system(path, &scene)?;
    let asked = args.duration.unwrap_or(scene.duration);
    let duration = if args.quick { asked.min(QUICK_DURATION) } else { asked };
    let mut steps = if args.step.is_empty() { scene.steps.clone() } else { args.step.clone() };
    steps.sort_by(|a, b| b.total_cmp(a));
    steps.dedup();
    if args.quick {
        steps.truncate(QUICK_STEPS);
    }
    let horizons = steps.iter().map(|&step| Horizon::nearest(step, duration)).collect::<Result<Vec<Horizon>, _>>()?;
    let engines = match steps.first() {
        Some(&step) if named.is_empty() => default_engines(&system, step)?,
        _ => named.to_vec(),
    };
    let sweep = if named.is_empty() { sweep::settings(args.quick)? } else { sweep::settings_of(named, args.quick) };
    let folder = match &args.out {
        Some(out) if args.input.len() == 1 => out.clone(),
        Some(out) => out.join(&scene.name),
        None => Path::new("reports").join(&scene.name),
    };
    Ok(Task { path: path.to_path_buf(), scene, system, engines, horizons, sweep, folder })
}

/// Runs one comparison, writes its report and prints its table. What was finished before an interruption is kept.
fn compare(task: &Task, study: Study, interrupted: &AtomicBool) -> Result<(), CliError> {
    for remark in &task.scene.model.remarks {
        eprintln!("remark: {}: {remark}", task.path.display());
    }
    let counters = Progress::default();
    let stages = [
        progress::Stage::new("measuring", study.steps(), &counters.traced),
        progress::Stage::new("examining", study.comparison.examinations(), &counters.examined),
        progress::Stage::new("timing", study.turns(), &counters.timed),
        progress::Stage::later("ranking", &counters.to_rank, &counters.ranked),
    ];
    let findings = progress::during(&task.scene.name, &stages, || study.run(interrupted, &counters));
    if findings.results.runs.is_empty() {
        return Err(CliError::Interrupted);
    }
    let report = Report::of_study(&task.scene, &task.system, &findings, input::command_line());
    for run in &report.runs {
        if let Some(warning) = &run.warning {
            eprintln!("warning: {} at {}: {warning}", run.engine, duration(run.step_s));
        }
    }
    let page = folder::write(&report, &task.folder)?;
    print(&report, &page)?;
    if interrupted.load(Ordering::Relaxed) { Err(CliError::Interrupted) } else { Ok(()) }
}

/// Finding, runs, and what accuracy costs.
fn print(report: &Report, page: &Path) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}\n{}\n", report.scene.name, finding::sentence(report))?;
    writeln!(out, "{}", table::text(report))?;
    let endings = table::endings(report);
    if !endings.is_empty() {
        writeln!(out, "{endings}")?;
    }
    if let Some(structure) = table::structure_text(report) {
        writeln!(out, "structure of {} steps\n{structure}", crate::measure::structure::STEPS)?;
    }
    if let Some(sweep) = &report.sweep {
        if let Some(targets) = summary::targets(sweep) {
            let until = sweep.until_s;
            writeln!(out, "CPU s/s simulated for joint positions to this error (rad or m) over the first {until} s")?;
            writeln!(out, "{}", targets.text())?;
        }
        if let Some(sentence) = summary::sentence(sweep) {
            writeln!(out, "{sentence}\n")?;
        }
        for expectation in &sweep.expectations {
            writeln!(out, "{}\n", expectation::sentence(expectation))?;
        }
    }
    if report.parity.as_ref().is_some_and(|parity| !parity.agrees) {
        writeln!(out, "Not all engines have the same mechanical system: see Parity in the report.\n")?;
    }
    writeln!(out, "{}\n", page.display())
}
