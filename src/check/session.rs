//! The check of several scenes, one after the other: runs, report and charts of each, and what is told of them.

use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::judge::{Finding, judge};
use super::requirement::Requirement;
use super::run::{self, Settings, Unit};
use super::scene::{CheckError, requirements};
use super::scope::{QUICK_STEPS, Scope, scoped};
use super::session_error::SessionError;
use super::{baseline, broken, controls, github, junit, propose, summary, table};
use crate::mechanics::System;
use crate::model::{Bound, Scene};
use crate::report::Report;
use crate::report::folder::files;

/// A scene with its bounds.
pub(crate) struct Task {
    pub path: PathBuf,
    pub scene: Scene,
    /// Folder for report and charts.
    pub folder: PathBuf,
    /// Where the bounds stand.
    source: PathBuf,
    system: System,
    requirements: Vec<Requirement>,
    left_out: usize,
    /// Reports that it is compared with.
    earlier: Vec<Report>,
}

impl Task {
    /// The scene read from `path` with the bounds that stand in `source`, as far as they are within a scope. Of the
    /// earlier reports those of other scenes are left out.
    ///
    /// # Errors
    /// A scene that cannot be compiled, a bound that cannot be held to.
    pub fn new(
        path: &Path,
        (scene, system): (Scene, System),
        (source, bounds): (PathBuf, &[Bound]),
        scope: Scope,
        earlier: &[Report],
        folder: PathBuf,
    ) -> Result<Task, CheckError> {
        let (requirements, left_out) = scoped(requirements(&source, bounds, &system)?, scope);
        let earlier = earlier.iter().filter(|r| r.scene.name == scene.name).cloned().collect();
        Ok(Task { path: path.to_path_buf(), scene, folder, source, system, requirements, left_out, earlier })
    }

    /// Whether there is nothing to check.
    pub(crate) fn is_idle(&self) -> bool {
        self.requirements.is_empty() && self.left_out == 0 && self.earlier.is_empty()
    }
}

/// What is told of a scene.
pub(crate) struct Told {
    /// For the terminal.
    pub text: String,
    findings: Vec<Finding>,
    charts: Vec<String>,
    notes: Vec<String>,
    worse: Vec<baseline::Worse>,
}

/// Bounds that were proposed.
pub(crate) struct Proposal {
    /// JSON.
    pub text: String,
    pub file: PathBuf,
    /// Engines whose runs did not reach their end, with the reason.
    pub unfinished: Vec<(String, String)>,
}

/// How all scenes came out.
pub(crate) struct Conclusion {
    pub bounds: usize,
    pub broken: usize,
    /// Figures that have become worse than in an earlier report.
    pub worse: usize,
    /// For GitHub Actions, where the session runs there.
    pub annotations: Vec<String>,
}

/// Shows how far runs are: does `work`, which counts its steps in `taken`.
pub(crate) type Progress<'a> = dyn Fn(&Stage, &mut dyn FnMut()) + 'a;

/// Runs of a scene that take so many steps together.
pub(crate) struct Stage<'a> {
    pub scene: &'a str,
    pub name: &'static str,
    pub steps: u64,
    pub taken: &'a AtomicU64,
}

/// How scenes are checked.
pub(crate) struct Session<'a> {
    pub scope: Scope,
    /// Run bad integrators against the same bounds.
    pub controls: bool,
    /// Threads for runs that are not timed.
    pub jobs: usize,
    /// May be set from outside at any time.
    pub interrupted: &'a AtomicBool,
    /// The command line, for reports.
    pub command: &'a str,
    pub progress: &'a Progress<'a>,
}

impl Session<'_> {
    fn take(&self, task: &Task, name: &'static str, units: &[Unit]) -> Result<Report, SessionError> {
        let taken = AtomicU64::new(0);
        let settings = Settings { jobs: self.jobs, interrupted: self.interrupted, taken: &taken };
        let stage = Stage { scene: &task.scene.name, name, steps: run::steps(units), taken: &taken };
        let mut found = None;
        (self.progress)(&stage, &mut || found = Some(run::run(&task.system, units, &settings)));
        match found {
            Some(found) if !self.interrupted.load(Ordering::Relaxed) => {
                Ok(Report::of_study(&task.scene, &task.system, &found, self.command.to_string()))
            }
            Some(_) | None => Err(SessionError::Interrupted),
        }
    }

    /// Measures the figures of a scene and writes bounds for them.
    ///
    /// # Errors
    /// An interruption, a file that cannot be written.
    pub fn propose(&self, task: &Task) -> Result<Proposal, SessionError> {
        let wanted = run::units(&task.requirements);
        let units = if wanted.is_empty() { propose::default_units(&task.scene)? } else { wanted };
        let report = self.take(task, "measuring", &units)?;
        let text = propose::json(&propose::bounds(&report))?;
        let file = task.folder.join("bounds.json");
        files::write_whole(&file, text.as_bytes())?;
        let unfinished = report.runs.into_iter().filter_map(|r| Some((r.engine, r.outcome_detail?)));
        Ok(Proposal { text, file, unfinished: unfinished.collect() })
    }

    /// Takes the runs of a scene, judges them and writes its report and the charts of broken bounds.
    ///
    /// # Errors
    /// An interruption, a file that cannot be written.
    pub fn check(&self, task: &Task) -> Result<Told, SessionError> {
        let (units, mut notes) = self.units(task);
        let report = self.take(task, "checking", &units)?;
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
            let left_out = task.left_out;
            notes.push(format!("{left_out} bounds on runs of more than {QUICK_STEPS} steps are left out by --quick"));
        }
        let charts = broken::draw(&task.scene.name, &task.folder, &report, &findings)?;
        let mut text = match (findings.is_empty(), task.is_idle()) {
            (false, _) => table::text(&task.scene.name, &findings),
            (true, true) => format!("{}\n  no bounds: nothing is checked\n", task.scene.name),
            (true, false) => format!("{}\n", task.scene.name),
        };
        notes.iter().for_each(|note| text += &format!("  {note}\n"));
        charts.iter().for_each(|chart| text += &format!("  {chart}\n"));
        if self.controls {
            text += &self.control(task)?;
        }
        Ok(Told { text, findings, charts, notes, worse })
    }

    /// The runs that the bounds and the earlier reports of a scene need, and what of the latter cannot be compared.
    fn units(&self, task: &Task) -> (Vec<Unit>, Vec<String>) {
        let mut units = run::units(&task.requirements);
        let mut notes = Vec::new();
        let longest = match self.scope {
            Scope::Quick => QUICK_STEPS,
            Scope::All => u64::MAX,
        };
        for earlier in &task.earlier {
            let (more, lost) = baseline::units(earlier, &task.system, longest);
            for unit in &more {
                unit.engines.iter().for_each(|spec| run::add(&mut units, spec, unit.horizon, unit.need));
            }
            notes.extend(lost.into_iter().map(|l| format!("not compared with the baseline: {l}")));
        }
        (units, notes)
    }

    fn control(&self, task: &Task) -> Result<String, SessionError> {
        let controlled = controls::requirements(&task.requirements, &controls::available(), &task.system);
        let report = self.take(task, "controls", &run::units(&controlled))?;
        let results = controls::results(&task.requirements, &controlled, &report);
        Ok(controls::text(&task.scene.name, &results))
    }
}

/// Writes the findings of all scenes as JUnit XML.
///
/// # Errors
/// A file that cannot be made or written.
pub(crate) fn write_junit(file: &Path, tasks: &[Task], told: &[Told]) -> Result<(), SessionError> {
    let scenes: Vec<(&str, &[Finding])> =
        tasks.iter().zip(told).map(|(task, told)| (task.scene.name.as_str(), &told.findings[..])).collect();
    Ok(files::write_whole(file, junit::xml(&scenes)?.as_bytes())?)
}

/// Writes what is told of all scenes as Markdown, within GitHub Actions into the summary of the job as well.
///
/// # Errors
/// A file that cannot be written.
pub(crate) fn write_summary(file: Option<&Path>, tasks: &[Task], told: &[Told]) -> Result<(), SessionError> {
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
    if let Some(file) = file {
        files::write_whole(file, text.as_bytes())?;
    }
    // The job's summary is added to, since other steps write into it too.
    if let Some(path) = std::env::var_os(github::STEP_SUMMARY).filter(|p| !p.is_empty()).map(PathBuf::from) {
        let added =
            OpenOptions::new().create(true).append(true).open(&path).and_then(|mut f| f.write_all(text.as_bytes()));
        added.map_err(|error| SessionError::Summary { path, error })?;
    }
    Ok(())
}

/// What became of all bounds.
pub(crate) fn conclude(tasks: &[Task], told: &[Told]) -> Conclusion {
    let count = |f: &dyn Fn(&Told) -> usize| told.iter().map(f).sum::<usize>();
    let broken = count(&|t| t.findings.iter().filter(|f| !f.passed).count());
    let (bounds, worse) = (count(&|t| t.findings.len()), count(&|t| t.worse.len()));
    let mut annotations = Vec::new();
    if std::env::var(github::ACTIONS).is_ok_and(|v| v == "true") {
        for (task, told) in tasks.iter().zip(told) {
            let (scene, file) = (&task.scene.name, task.source.display().to_string());
            let failed = told.findings.iter().filter(|f| !f.passed);
            annotations.extend(failed.map(|finding| github::annotation(&file, scene, finding)));
            let title = |worse: &baseline::Worse| format!("{scene}: {}", worse.metric);
            annotations.extend(told.worse.iter().map(|worse| github::error(&file, &title(worse), &worse.sentence)));
        }
    }
    Conclusion { bounds, broken, worse, annotations }
}
