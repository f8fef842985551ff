//! The folder of the theory: JSON, Markdown and pictures of each topic, and one page of all topics that are there.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::files::{WriteError, prepare, write_whole};
use crate::measure::theory::{TOPICS, Topic};
use crate::report::charts::ChartError;
use crate::report::page::theory;
use crate::report::record::environment;
use crate::report::record::theory::{Data, FILE_SCHEMA, TheoryFile};

/// Why the folder of the theory could not be read or written.
#[derive(Debug, thiserror::Error)]
pub(crate) enum TheoryError {
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("{path}: cannot be read: {error}", path = path.display())]
    Read { path: PathBuf, error: io::Error },
    #[error(
        "{path}: not a file of `theory`: {error}; write it again with: rattlebench theory TOPIC",
        path = path.display()
    )]
    Json { path: PathBuf, error: serde_json::Error },
    #[error("{path}: \"schema\" is \"{schema}\"; this program reads \"{FILE_SCHEMA}\"", path = path.display())]
    Schema { path: PathBuf, schema: String },
    #[error(
        "{path}: the data are not those of topic \"{topic}\"; write it again with: rattlebench theory TOPIC",
        path = path.display()
    )]
    Topic { path: PathBuf, topic: String },
}

impl From<ChartError> for TheoryError {
    fn from(error: ChartError) -> TheoryError {
        TheoryError::Write(error.into())
    }
}

/// # Errors
/// A chart of the topic that cannot be drawn: words and pictures of a topic are made together.
fn file_of(topic: &Topic, data: Data, command: &str) -> Result<TheoryFile, ChartError> {
    let section = theory::section(&data, topic.name)?;
    Ok(TheoryFile {
        schema: FILE_SCHEMA.to_string(),
        topic: topic.name.to_string(),
        title: section.title.to_string(),
        finding: section.finding,
        versions: environment::versions(),
        command: command.to_string(),
        data,
    })
}

/// Reads a topic.
///
/// # Errors
/// A file that cannot be read, is not of `theory`, or holds the data of another topic than it says.
pub(crate) fn read(path: &Path) -> Result<TheoryFile, TheoryError> {
    let text = fs::read_to_string(path).map_err(|error| TheoryError::Read { path: path.to_path_buf(), error })?;
    let json = |error| TheoryError::Json { path: path.to_path_buf(), error };
    let head: Head = serde_json::from_str(&text).map_err(json)?;
    if head.schema != FILE_SCHEMA {
        return Err(TheoryError::Schema { path: path.to_path_buf(), schema: head.schema });
    }
    let file: TheoryFile = serde_json::from_str(&text).map_err(json)?;
    if file.data.belongs_to(&file.topic) {
        Ok(file)
    } else {
        Err(TheoryError::Topic { path: path.to_path_buf(), topic: file.topic })
    }
}

#[derive(Deserialize)]
struct Head {
    schema: String,
}

/// Writes `<topic>.json` of the topics given and draws all topics of the folder. Returns the files written and the
/// page's path.
///
/// # Errors
/// A chart that cannot be drawn, a file that cannot be written, a file of an earlier run that cannot be read.
pub(crate) fn write(
    topics: Vec<(&Topic, Data)>,
    command: &str,
    folder: &Path,
) -> Result<(Vec<TheoryFile>, PathBuf), TheoryError> {
    prepare(folder)?;
    let mut written = Vec::new();
    for (topic, data) in topics {
        let file = file_of(topic, data, command)?;
        let json = serde_json::to_string(&file).map_err(WriteError::from)? + "\n";
        write_whole(&json_path(folder, topic.name), json.as_bytes())?;
        written.push(file);
    }
    Ok((written, draw_folder(folder)?))
}

fn json_path(folder: &Path, topic: &str) -> PathBuf {
    folder.join(format!("{topic}.json"))
}

/// Draws every topic whose JSON is in the folder. Returns the page's path.
///
/// # Errors
/// Those of [`read`] and [`draw`].
pub(crate) fn draw_folder(folder: &Path) -> Result<PathBuf, TheoryError> {
    let paths = TOPICS.iter().map(|topic| json_path(folder, topic.name)).filter(|path| path.exists());
    let files = paths.map(|path| read(&path)).collect::<Result<Vec<_>, _>>()?;
    draw(&files, folder)
}

/// Writes pictures, `<topic>.md` where a topic has tables, and `index.html` with the topics given, in their own order.
/// Returns the page's path.
///
/// # Errors
/// A chart that cannot be drawn, a file that cannot be written.
pub(crate) fn draw(files: &[TheoryFile], folder: &Path) -> Result<PathBuf, TheoryError> {
    prepare(folder)?;
    let place = |file: &TheoryFile| TOPICS.iter().position(|topic| topic.name == file.topic);
    let mut files: Vec<&TheoryFile> = files.iter().collect();
    files.sort_by_key(|file| place(file));
    let mut sections = Vec::new();
    for file in files {
        let section = theory::section(&file.data, &file.topic)?;
        if !section.tables.is_empty() {
            write_whole(&folder.join(format!("{}.md", file.topic)), theory::markdown(&section).as_bytes())?;
        }
        for (name, picture) in &section.charts {
            write_whole(&folder.join(name), &picture.png).map_err(TheoryError::Write)?;
        }
        sections.push((file, section));
    }
    let index = folder.join("index.html");
    write_whole(&index, theory::html(&sections, folder).as_bytes())?;
    Ok(index)
}
