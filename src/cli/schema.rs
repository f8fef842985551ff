//! `schema`: JSON Schemas of the files that are read and written.

use std::io::Write as _;

use clap::ValueEnum;

use super::CliError;
use crate::model::scene::SceneFile;
use crate::report::Report;
use crate::report::record::cost::Cost;
use crate::report::record::stability::StabilityReport;
use crate::report::record::theory::TheoryFile;

/// Print the JSON Schema of a file on stdout.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Which file.
    file: File,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum File {
    /// A scene file.
    Scene,
    /// A report.json.
    Report,
    /// A stability.json.
    Stability,
    /// A cost.json.
    Cost,
    /// A file that `theory` writes.
    Theory,
}

pub fn run(args: &Args) -> Result<(), CliError> {
    let schema = match args.file {
        File::Scene => schemars::schema_for!(SceneFile),
        File::Report => schemars::schema_for!(Report),
        File::Stability => schemars::schema_for!(StabilityReport),
        File::Cost => schemars::schema_for!(Cost),
        File::Theory => schemars::schema_for!(TheoryFile),
    };
    let text = serde_json::to_string_pretty(&schema)?;
    writeln!(std::io::stdout().lock(), "{text}")?;
    Ok(())
}
