//! `chart`: draws the charts and the page of saved reports again, without simulating.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::CliError;
use crate::report::Report;
use crate::report::folder;
use crate::report::folder::theory;
use crate::report::record::cost::{self, Cost};
use crate::report::record::report::ReadError;
use crate::report::record::stability::{self, StabilityReport};
use crate::report::record::theory::{FILE_SCHEMA, TheoryFile};

/// Draw the charts and the page of saved reports, of saved costs and of saved topics of `theory`, again.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// report.json, stability.json and cost.json files, and JSON files that `theory` wrote.
    #[arg(required = true, value_name = "REPORT.json")]
    report: Vec<PathBuf>,
    /// Folder for the charts and the page; with several reports, for one folder each [default: where the report is].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// What a JSON file holds.
enum Saved {
    Report(Box<Report>),
    Stability(Box<StabilityReport>),
    Cost(Box<Cost>),
    Theory(Box<TheoryFile>),
}

pub fn run(args: &Args) -> Result<(), CliError> {
    let saved = args.report.iter().map(|path| Ok((path, read(path)?))).collect::<Result<Vec<_>, CliError>>()?;
    let (mut pages, mut topics) = (Vec::new(), Vec::new());
    let folder = |path: &Path, name: &str| match &args.out {
        Some(out) if args.report.len() == 1 => out.clone(),
        Some(out) => out.join(name),
        None => beside(path),
    };
    for (path, file) in saved {
        match file {
            Saved::Report(report) => pages.push(folder::report::draw(&report, &folder(path, &report.scene.name))?),
            Saved::Stability(report) => pages.push(folder::stability::draw(&report, &folder(path, "stability"))?),
            Saved::Cost(cost) => pages.push(folder::cost::draw(&cost, &folder(path, "cost"))?),
            Saved::Theory(topic) => topics.push((path, *topic)),
        }
    }
    pages.extend(draw_topics(topics, args.out.as_deref())?);
    let mut out = std::io::stdout().lock();
    pages.iter().try_for_each(|page| writeln!(out, "{}", page.display()))?;
    Ok(())
}

/// One page for all topics of a folder, or for the topics given where there is a folder for them.
fn draw_topics(topics: Vec<(&PathBuf, TheoryFile)>, out: Option<&Path>) -> Result<Vec<PathBuf>, CliError> {
    match out {
        _ if topics.is_empty() => Ok(Vec::new()),
        Some(out) => {
            let files: Vec<TheoryFile> = topics.into_iter().map(|(_, file)| file).collect();
            Ok(vec![theory::draw(&files, out)?])
        }
        None => {
            let mut folders: Vec<PathBuf> = topics.iter().map(|(path, _)| beside(path)).collect();
            folders.sort();
            folders.dedup();
            folders.iter().map(|folder| Ok(theory::draw_folder(folder)?)).collect()
        }
    }
}

fn beside(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_path_buf()
}

fn read(path: &Path) -> Result<Saved, CliError> {
    #[derive(Deserialize)]
    struct Head {
        schema: Option<String>,
    }
    let text = std::fs::read_to_string(path).map_err(|error| CliError::Read { path: path.to_path_buf(), error })?;
    let head: Option<Head> = serde_json::from_str(&text).ok();
    let failed = |error| CliError::Report { path: path.to_path_buf(), error };
    match head.and_then(|head| head.schema).as_deref() {
        Some(FILE_SCHEMA) => return Ok(Saved::Theory(Box::new(theory::read(path)?))),
        Some(stability::SCHEMA) => {
            let report = serde_json::from_str(&text).map_err(|error| failed(ReadError::Json(error)))?;
            return Ok(Saved::Stability(Box::new(report)));
        }
        Some(cost::SCHEMA) => {
            let cost = serde_json::from_str(&text).map_err(|error| failed(ReadError::Json(error)))?;
            return Ok(Saved::Cost(Box::new(cost)));
        }
        _ => {}
    }
    let report = Report::from_json(&text).map_err(failed)?;
    Ok(Saved::Report(Box::new(report)))
}
