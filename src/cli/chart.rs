//! `chart`: draws the charts and the page of saved reports again, without simulating.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::CliError;
use crate::report::record::ReadError;
use crate::report::stability::{self, StabilityReport};
use crate::report::{Report, files};

/// Draw the charts and the page of saved reports again.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// report.json and stability.json files.
    #[arg(required = true, value_name = "REPORT.json")]
    report: Vec<PathBuf>,
    /// Folder for the charts and the page; with several reports, for one folder each [default: where the report is].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// What a file holds.
enum Saved {
    Comparison(Box<Report>),
    Stability(StabilityReport),
}

pub fn run(args: &Args) -> Result<(), CliError> {
    let saved = args.report.iter().map(|path| Ok((path, read(path)?))).collect::<Result<Vec<_>, CliError>>()?;
    for (path, saved) in &saved {
        let name = match saved {
            Saved::Comparison(report) => &report.scene.name,
            Saved::Stability(_) => "stability",
        };
        let folder = match &args.out {
            Some(out) if args.report.len() == 1 => out.clone(),
            Some(out) => out.join(name),
            None => path.parent().unwrap_or(Path::new("")).to_path_buf(),
        };
        let page = match saved {
            Saved::Comparison(report) => files::draw(report, &folder)?,
            Saved::Stability(report) => stability::draw(report, &folder)?,
        };
        writeln!(std::io::stdout().lock(), "{}", page.display())?;
    }
    Ok(())
}

fn read(path: &Path) -> Result<Saved, CliError> {
    let text = std::fs::read_to_string(path).map_err(|error| CliError::Read { path: path.to_path_buf(), error })?;
    let saved = match Report::from_json(&text) {
        Err(ReadError::Schema { schema }) if schema == stability::record::SCHEMA => {
            serde_json::from_str(&text).map(Saved::Stability).map_err(ReadError::Json)
        }
        report => report.map(|report| Saved::Comparison(Box::new(report))),
    };
    saved.map_err(|error| CliError::Report { path: path.to_path_buf(), error })
}
