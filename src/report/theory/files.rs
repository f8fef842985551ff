//! The folder of the theory: JSON, Markdown and pictures of each topic, and one page of all topics that are there.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use maud::{Markup, html};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::charts::ChartError;
use super::{Data, Section, TOPICS, Topic};
use crate::report::folder::files::{WriteError, prepare, write_whole};
use crate::report::page::document as page;
use crate::report::record::environment;
use crate::report::record::environment::Versions;

/// Name and version of the JSON files.
pub const FILE_SCHEMA: &str = "rattlebench/theory/1";

/// One topic as JSON. It holds no timing and is the same whenever the same program writes it by the same command.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TheoryFile {
    /// Always `rattlebench/theory/1`.
    pub schema: String,
    /// Name of the topic, as on the command line.
    pub topic: String,
    pub title: String,
    /// One sentence with figures.
    pub finding: String,
    pub versions: Versions,
    /// The command line that wrote this file.
    pub command: String,
    pub data: Data,
}

/// Why the folder of the theory could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum TheoryError {
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("{path}: cannot be read: {error}", path = path.display())]
    Read { path: PathBuf, error: io::Error },
    #[error("{path}: not a file of `theory`: {error}; write it again with: rattlebench theory TOPIC", path = path.display())]
    Json { path: PathBuf, error: serde_json::Error },
    #[error("{path}: \"schema\" is \"{schema}\"; this program reads \"{FILE_SCHEMA}\"", path = path.display())]
    Schema { path: PathBuf, schema: String },
    #[error("{path}: the data are not those of topic \"{topic}\"; write it again with: rattlebench theory TOPIC", path = path.display())]
    Topic { path: PathBuf, topic: String },
}

impl From<ChartError> for TheoryError {
    fn from(error: ChartError) -> TheoryError {
        TheoryError::Write(error.into())
    }
}

impl TheoryFile {
    /// # Errors
    /// A chart of the topic that cannot be drawn: words and pictures of a topic are made together.
    fn new(topic: &Topic, data: Data, command: &str) -> Result<TheoryFile, ChartError> {
        let section = data.section(topic.name)?;
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
    pub fn read(path: &Path) -> Result<TheoryFile, TheoryError> {
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
}

#[derive(Deserialize)]
struct Head {
    schema: String,
}

/// Writes `<topic>.json` of the topics given and draws all topics of the folder. Returns the files written and the page's
/// path.
///
/// # Errors
/// A chart that cannot be drawn, a file that cannot be written, a file of an earlier run that cannot be read.
pub fn write(
    topics: Vec<(&Topic, Data)>,
    command: &str,
    folder: &Path,
) -> Result<(Vec<TheoryFile>, PathBuf), TheoryError> {
    prepare(folder)?;
    let mut written = Vec::new();
    for (topic, data) in topics {
        let file = TheoryFile::new(topic, data, command)?;
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
/// Those of [`TheoryFile::read`] and [`draw`].
pub fn draw_folder(folder: &Path) -> Result<PathBuf, TheoryError> {
    let paths = TOPICS.iter().map(|topic| json_path(folder, topic.name)).filter(|path| path.exists());
    let files = paths.map(|path| TheoryFile::read(&path)).collect::<Result<Vec<_>, _>>()?;
    draw(&files, folder)
}

/// Writes pictures, `<topic>.md` where a topic has tables, and `index.html` with the topics given, in their own order.
/// Returns the page's path.
///
/// # Errors
/// A chart that cannot be drawn, a file that cannot be written.
pub fn draw(files: &[TheoryFile], folder: &Path) -> Result<PathBuf, TheoryError> {
    prepare(folder)?;
    let place = |file: &TheoryFile| TOPICS.iter().position(|topic| topic.name == file.topic);
    let mut files: Vec<&TheoryFile> = files.iter().collect();
    files.sort_by_key(|file| place(file));
    let mut sections = Vec::new();
    for file in files {
        let section = file.data.section(&file.topic)?;
        if !section.tables.is_empty() {
            write_whole(&folder.join(format!("{}.md", file.topic)), markdown(&section).as_bytes())?;
        }
        for (name, picture) in &section.charts {
            write_whole(&folder.join(name), &picture.png).map_err(TheoryError::Write)?;
        }
        sections.push((file, section));
    }
    let index = folder.join("index.html");
    write_whole(&index, html(&sections, folder).as_bytes())?;
    Ok(index)
}

fn markdown(section: &Section) -> String {
    let mut text = format!("# {}\n\n{}\n\n{}\n", section.title, section.finding, section.explanation);
    for table in &section.tables {
        text += "\n";
        text += &table.markdown();
    }
    text
}

fn html(sections: &[(&TheoryFile, Section)], folder: &Path) -> String {
    let body = html! {
        p.description {
            "The claims of J. E. Marsden and M. West, “Discrete mechanics and variational integrators”, Acta Numerica 10 \
             (2001), and of G. W. Patrick and C. Cuell, “Error analysis of variational integrators of unconstrained \
             Lagrangian systems” (2008/09), as computed here."
        }
        @if sections.len() > 1 {
            ul { @for (file, section) in sections { li { a href={ "#" (file.topic) } { (section.title) } } } }
        }
        @for (file, section) in sections {
            h2 id=(file.topic) { (section.title) }
            (page::finding_box(&section.finding))
            p { (section.explanation) }
            @for (_, picture) in &section.charts { (page::figure(picture)) }
            @for table in &section.tables { (table.html()) }
            (links(file, section, folder))
        }
        (origin(sections))
    };
    page::document("Discrete mechanics", body)
}

/// The files of a topic that stand beside the page.
fn links(file: &TheoryFile, section: &Section, folder: &Path) -> Markup {
    let json = format!("{}.json", file.topic);
    let text = format!("{}.md", file.topic);
    html! {
        p.small {
            @if folder.join(&json).exists() { "Data: " a href=(json) { (json) } ". " }
            @if !section.tables.is_empty() { "Tables: " a href=(text) { (text) } "." }
        }
    }
}

/// Versions and command lines that the topics come from, each once.
fn origin(sections: &[(&TheoryFile, Section)]) -> Markup {
    let mut versions: Vec<&Versions> = Vec::new();
    let mut commands: Vec<&str> = Vec::new();
    for (file, _) in sections {
        if !versions.contains(&&file.versions) {
            versions.push(&file.versions);
        }
        if !commands.contains(&file.command.as_str()) {
            commands.push(&file.command);
        }
    }
    html! {
        @for versions in versions { (page::version_list(versions)) }
        (page::command_line(&commands.join("\n")))
    }
}
