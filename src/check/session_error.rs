//! Why a session could not do its work.

use std::io;
use std::path::PathBuf;

use super::propose::ProposeError;
use crate::report::folder::files::WriteError;

#[derive(Debug, thiserror::Error)]
pub(crate) enum SessionError {
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error(transparent)]
    Propose(#[from] ProposeError),
    #[error("cannot write JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error("the JUnit file cannot be made: {0}")]
    Junit(#[from] quick_junit::SerializeError),
    #[error("GITHUB_STEP_SUMMARY {path}: {error}", path = path.display())]
    Summary { path: PathBuf, error: io::Error },
    #[error("{path}: charts of an earlier check cannot be removed: {error}", path = path.display())]
    Folder { path: PathBuf, error: io::Error },
    #[error("interrupted")]
    Interrupted,
}
