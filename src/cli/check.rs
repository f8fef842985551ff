//! `check`: keeps the figures of runs within the bounds of their scenes.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::{CliError, input, interrupt, progress};
use crate::check::session::{self, Session, Stage, Task, Told};
use crate::check::{CheckError, Scope};
use crate::measure::threads;
use crate::model::read_bounds;
use crate::report::Report;
use crate::report::folder::files;

/// Hold the figures of runs to the bounds of their scenes.
///
/// Exit code 0 where every bound is kept, 1 where one is broken, 2 where a bound or a scene cannot be used. A run that
/// does not complete breaks its bounds.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
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
    /// Earlier report.json; may be given several times. What has become worse than there by more than a factor 2
    /// (ratios of processor time 1.5) counts as broken.
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

pub fn run(args: &Args) -> Result<(), CliError> {
    let inputs = if args.input.is_empty() { input::shipped(Path::new("models"))? } else { args.input.clone() };
    let earlier = args.baseline.iter().map(|path| read_report(path)).collect::<Result<Vec<Report>, CliError>>()?;
    let tasks = inputs.iter().map(|path| task(args, &earlier, path)).collect::<Result<Vec<Task>, CliError>>()?;
    if let (Some(first), true) = (tasks.first(), tasks.iter().all(|t| !args.propose && t.is_idle())) {
        return Err(CheckError::NoBounds { input: first.path.clone() }.into());
    }
    prepare(args, &tasks)?;
    let session = Session {
        scope: scope(args),
        controls: args.controls,
        jobs: args.jobs.map_or_else(threads::cores, usize::from),
        interrupted: interrupt::flag(),
        command: &input::command_line(),
        progress: &|stage: &Stage, work: &mut dyn FnMut()| {
            progress::during(stage.scene, &[progress::Stage::new(stage.name, stage.steps, stage.taken)], work);
        },
    };
    if args.propose {
        return tasks.iter().try_for_each(|task| propose(task, &session));
    }
    let told = tasks.iter().map(|task| check(task, &session)).collect::<Result<Vec<Told>, CliError>>()?;
    if let Some(file) = &args.junit {
        session::write_junit(file, &tasks, &told)?;
    }
    session::write_summary(args.summary.as_deref(), &tasks, &told)?;
    conclude(&tasks, &told)
}

fn scope(args: &Args) -> Scope {
    if args.quick { Scope::Quick } else { Scope::All }
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
    let folder = match &args.out {
        Some(out) => out.join(&scene.name),
        None => Path::new("reports").join(&scene.name).join("check"),
    };
    Ok(Task::new(path, (scene, system), (source, &bounds), scope(args), earlier, folder)?)
}

/// Finds bad paths before the long runs.
fn prepare(args: &Args, tasks: &[Task]) -> Result<(), CliError> {
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
    Ok(())
}

fn propose(task: &Task, session: &Session) -> Result<(), CliError> {
    let proposal = session.propose(task)?;
    eprintln!("remark: {}: proposed bounds are in {}", task.path.display(), proposal.file.display());
    for (engine, detail) in &proposal.unfinished {
        eprintln!("remark: {}: {engine}: {detail}", task.path.display());
    }
    write!(std::io::stdout().lock(), "{}", proposal.text)?;
    Ok(())
}

fn check(task: &Task, session: &Session) -> Result<Told, CliError> {
    let told = session.check(task)?;
    writeln!(std::io::stdout().lock(), "{}", told.text)?;
    Ok(told)
}

fn conclude(tasks: &[Task], told: &[Told]) -> Result<(), CliError> {
    let found = session::conclude(tasks, told);
    let mut out = std::io::stdout().lock();
    for annotation in &found.annotations {
        writeln!(out, "{annotation}")?;
    }
    if found.broken + found.worse > 0 {
        return Err(CliError::Broken { broken: found.broken, bounds: found.bounds, worse: found.worse });
    }
    writeln!(out, "{} bounds kept", found.bounds)?;
    Ok(())
}
