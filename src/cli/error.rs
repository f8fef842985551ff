//! What ends a subcommand before its time, and the exit code that goes with it.

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use crate::check::{CheckError, SessionError};
use crate::discrete::solve::SolveError;
use crate::engines::{SpecError, Unsupported};
use crate::measure::HorizonError;
use crate::mechanics::CompileError;
use crate::model::{ModelError, SceneError, SceneProblem};
use crate::report::folder::cells::StoreError;
use crate::report::folder::files::WriteError;
use crate::report::folder::theory::TheoryError;
use crate::report::record::report::ReadError;
use crate::report::record::stability::IncompleteError;

/// Why a subcommand could not do its work.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Option(#[from] SceneProblem),
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error("{input}: {error}", input = input.display())]
    Compile { input: PathBuf, error: CompileError },
    #[error("--engine: {0}")]
    Spec(#[from] SpecError),
    #[error("--engine: {0}")]
    Unsupported(#[from] Unsupported),
    #[error(transparent)]
    Horizon(#[from] HorizonError),
    #[error("{option} must be > 0 s, got {value}")]
    NotPositive { option: &'static str, value: f64 },
    #[error("--sample {sample} s is not a whole number of steps of {step} s; use {below} or {above}")]
    Sample { sample: f64, step: f64, below: f64, above: f64 },
    #[error("--set {text}: {problem}")]
    Set { text: String, problem: String },
    #[error("{first} and {second} are both named '{name}' and would write the same report; run them one by one")]
    SameName { name: String, first: PathBuf, second: PathBuf },
    #[error("{path}: {error}", path = path.display())]
    Report { path: PathBuf, error: ReadError },
    #[error("{path}: cannot be read: {error}", path = path.display())]
    Read { path: PathBuf, error: io::Error },
    #[error("--output {path}: {error}", path = path.display())]
    Output { path: PathBuf, error: io::Error },
    #[error(transparent)]
    TheoryFile(#[from] TheoryError),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("cannot write JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error("cannot write to stdout: {0}")]
    Stdout(#[from] io::Error),
    #[error("{engine}: {detail}")]
    RunFailed { engine: String, detail: String },
    #[error("{topic}: {error}")]
    Theory { topic: &'static str, error: SolveError },
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(transparent)]
    Incomplete(#[from] IncompleteError),
    #[error("{path}: {cell} has another result than in a folder before it", path = path.display())]
    TwoResults { path: PathBuf, cell: String },
    #[error(transparent)]
    Check(#[from] CheckError),
    #[error(transparent)]
    Session(SessionError),
    #[error("{broken} of {bounds} bounds broken{}", worse_text(*.worse))]
    Broken { broken: usize, bounds: usize, worse: usize },
    #[error("interrupted")]
    Interrupted,
}

impl From<SessionError> for CliError {
    fn from(error: SessionError) -> CliError {
        match error {
            SessionError::Interrupted => CliError::Interrupted,
            error => CliError::Session(error),
        }
    }
}

impl CliError {
    /// 1 for broken bounds; 2 for bad usage, bad input and files that cannot be written; 3 for a run that could not be
    /// finished; 130 for an interruption. A reader of our output that stops early, as `head` does, is no error.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            CliError::Stdout(error) if error.kind() == io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
            CliError::Broken { .. } => ExitCode::from(1),
            CliError::RunFailed { .. } | CliError::Theory { .. } => ExitCode::from(3),
            CliError::Interrupted => ExitCode::from(130),
            _ => ExitCode::from(2),
        }
    }

    /// Whether there is something to tell.
    pub(crate) fn is_silent(&self) -> bool {
        matches!(self, CliError::Stdout(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }
}

fn worse_text(count: usize) -> String {
    match count {
        0 => String::new(),
        1 => ", 1 figure worse than the baseline".to_string(),
        n => format!(", {n} figures worse than the baseline"),
    }
}
