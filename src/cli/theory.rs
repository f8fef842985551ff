//! `theory`: the figures and tables of the sources of the theory.

use std::io::Write as _;
use std::path::PathBuf;
use std::sync::atomic::AtomicU64;

use clap::builder::{PossibleValue, PossibleValuesParser};

use super::{CliError, input, progress};
use crate::measure::theory::{TOPICS, Topic};
use crate::report::folder::files;
use crate::report::folder::theory;
use crate::report::record::theory::Data;

/// Compute the figures and tables of the theory: orders, energy, conservation, small steps.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// What to compute [default: everything].
    #[arg(value_name = "TOPIC", value_parser = PossibleValuesParser::new(
        TOPICS.iter().map(|topic| PossibleValue::new(topic.name).help(topic.summary))
    ))]
    topic: Vec<String>,
    /// Folder for the files and the page.
    #[arg(long, value_name = "DIR", default_value = "reports/theory")]
    out: PathBuf,
}

pub fn run(args: &Args) -> Result<(), CliError> {
    files::prepare(&args.out)?;
    let asked = |topic: &&Topic| args.topic.is_empty() || args.topic.iter().any(|name| name == topic.name);
    let topics: Vec<&Topic> = TOPICS.iter().filter(asked).collect();
    let counters: Vec<AtomicU64> = topics.iter().map(|_| AtomicU64::new(0)).collect();
    let stages: Vec<progress::Stage> = topics
        .iter()
        .zip(&counters)
        .map(|(topic, done)| progress::Stage::new(topic.name, (topic.work)(), done))
        .collect();
    let computed = progress::during("theory", &stages, || {
        let compute = |(topic, done): (&&'static Topic, &AtomicU64)| match (topic.compute)(done) {
            Ok(found) => Ok((*topic, Data::from(found))),
            Err(error) => Err(CliError::Theory { topic: topic.name, error }),
        };
        topics.iter().zip(&counters).map(compute).collect::<Result<Vec<(&Topic, Data)>, CliError>>()
    })?;
    let (files, page) = theory::write(computed, &input::command_line(), &args.out)?;
    let mut out = std::io::stdout().lock();
    for file in &files {
        writeln!(out, "{}: {}\n", file.topic, file.finding)?;
    }
    writeln!(out, "{}", page.display())?;
    Ok(())
}
