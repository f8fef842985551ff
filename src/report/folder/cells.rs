//! Finished cells on disk while a suite runs: `suite.json` says which suite, `cells.jsonl` holds one line a cell.
//!
//! A line is written by one call and counts only with its newline, so a program that is killed at any moment leaves
//! whole lines and at most one piece of a line, which is dropped when the suite is resumed.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use super::files::{self, WriteError};
use crate::report::record::stability::{CellRecord, Key, StoredCell, SuiteRecord};

const SUITE: &str = "suite.json";
const CELLS: &str = "cells.jsonl";

/// Why the cells of a folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum StoreError {
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("{}: cannot be read: {error}", path.display())]
    Read { path: PathBuf, error: io::Error },
    #[error("{}: {error}", path.display())]
    Json { path: PathBuf, error: serde_json::Error },
    #[error("{}: holds another suite: {what}; use the same options, another --out, or leave out \
             --resume", path.display())]
    OtherSuite { path: PathBuf, what: String },
}

/// The file that grows with every finished cell.
#[derive(Debug)]
pub(crate) struct Store {
    path: PathBuf,
    file: Mutex<File>,
}

impl Store {
    /// Begins a suite in a folder, or goes on with the one that is there, and returns the cells that are finished.
    ///
    /// # Errors
    /// A folder that cannot be read or written, or that holds another suite.
    pub(crate) fn open(
        folder: &Path,
        suite: &SuiteRecord,
        resume: bool,
    ) -> Result<(Store, HashMap<Key, CellRecord>), StoreError> {
        let (head, path) = (folder.join(SUITE), folder.join(CELLS));
        files::prepare(folder)?;
        let finished = if resume && head.exists() { read(folder, Some(suite))?.1 } else { Vec::new() };
        let lines: Vec<String> = finished.iter().map(line).collect::<Result<_, _>>().map_err(|e| json(&path, e))?;
        // Emptied before the suite changes its name, so that no cell is ever taken for one of another suite.
        files::write_whole(&path, lines.concat().as_bytes())?;
        let text = serde_json::to_string(suite).map_err(|e| json(&head, e))? + "\n";
        files::write_whole(&head, text.as_bytes())?;
        let file = OpenOptions::new().append(true).open(&path);
        let file = file.map_err(|error| WriteError::File { path: path.clone(), error })?;
        let cells = finished.into_iter().map(|stored| (stored.key(), stored.cell)).collect();
        Ok((Store { path, file: Mutex::new(file) }, cells))
    }

    /// Adds a finished cell.
    ///
    /// # Errors
    /// A disk that is full or gone.
    pub(crate) fn add(&self, cell: &StoredCell) -> Result<(), StoreError> {
        let line = line(cell).map_err(|e| json(&self.path, e))?;
        let failed = |error| WriteError::File { path: self.path.clone(), error };
        let mut file = self.file.lock().map_err(|e| failed(io::Error::other(e.to_string())))?;
        file.write_all(line.as_bytes()).map_err(failed)?;
        Ok(())
    }
}

/// The suite and the finished cells of a folder.
///
/// # Errors
/// Files that are missing or are not what a suite leaves; another suite than the one expected.
pub(crate) fn read(
    folder: &Path,
    expected: Option<&SuiteRecord>,
) -> Result<(SuiteRecord, Vec<StoredCell>), StoreError> {
    let text =
        |path: &Path| fs::read_to_string(path).map_err(|error| StoreError::Read { path: path.to_path_buf(), error });
    let (head, path) = (folder.join(SUITE), folder.join(CELLS));
    let suite: SuiteRecord = serde_json::from_str(&text(&head)?).map_err(|e| json(&head, e))?;
    if let Some(what) = expected.and_then(|expected| difference(&suite, expected)) {
        return Err(StoreError::OtherSuite { path: folder.to_path_buf(), what });
    }
    let whole = text(&path)?;
    let lines = whole.split_inclusive('\n').filter(|line| line.ends_with('\n'));
    let cells = lines.map(serde_json::from_str).collect::<Result<_, _>>().map_err(|e| json(&path, e))?;
    Ok((suite, cells))
}

/// What of two suites differs first.
fn difference(there: &SuiteRecord, here: &SuiteRecord) -> Option<String> {
    let names = |list: &[String]| list.join(" ");
    let differ = |what: &str, a: String, b: String| (a != b).then(|| format!("{what} is '{a}' there and '{b}' here"));
    let kind = |quick| if quick { "quick" } else { "full" }.to_string();
    differ("schema", there.schema.clone(), here.schema.clone())
        .or_else(|| differ("the list of families", names(&there.families), names(&here.families)))
        .or_else(|| differ("the list of engines", names(&there.engines), names(&here.engines)))
        .or_else(|| differ("the use of explicit methods", there.explicit.to_string(), here.explicit.to_string()))
        .or_else(|| differ("the extent", kind(there.quick), kind(here.quick)))
        .or_else(|| {
            (there.versions != here.versions).then(|| "it was begun by another version of the program".to_string())
        })
}

fn line(cell: &StoredCell) -> serde_json::Result<String> {
    Ok(serde_json::to_string(cell)? + "\n")
}

fn json(path: &Path, error: serde_json::Error) -> StoreError {
    StoreError::Json { path: path.to_path_buf(), error }
}
