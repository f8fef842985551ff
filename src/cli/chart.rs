//! `chart`: draws the charts and the page of saved reports again, without simulating.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::CliError;
use crate::report::{Report, files};

/// Draw the charts and the page of saved reports again.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// report.json files.
    #[arg(required = true, value_name = "REPORT.json")]
    report: Vec<PathBuf>,
    /// Folder for the charts and the page; with several reports, for one folder each [default: where the report is].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn run(args: &Args) -> Result<(), CliError> {
    let reports = args.report.iter().map(|path| Ok((path, read(path)?))).collect::<Result<Vec<_>, CliError>>()?;
    for (path, report) in &reports {
        let folder = match &args.out {
            Some(out) if reports.len() == 1 => out.clone(),
            Some(out) => out.join(&report.scene.name),
            None => path.parent().unwrap_or(Path::new("")).to_path_buf(),
        };
        let page = files::draw(report, &folder)?;
        writeln!(std::io::stdout().lock(), "{}", page.display())?;
    }
    Ok(())
}

fn read(path: &Path) -> Result<Report, CliError> {
    let text = std::fs::read_to_string(path).map_err(|error| CliError::Read { path: path.to_path_buf(), error })?;
    Report::from_json(&text).map_err(|error| CliError::Report { path: path.to_path_buf(), error })
}
