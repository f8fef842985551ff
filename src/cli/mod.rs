//! The command line: one file a subcommand. The only folder that knows clap and indicatif.
//!
//! Results go to stdout, progress, remarks and errors to stderr. Exit codes: 0 done, 1 a bound was broken, 2 bad usage
//! or bad input, 3 a run that could not be finished, 130 interrupted.

mod chart;
mod check;
mod compare;
mod cost;
mod error;
mod generate;
mod input;
mod inspect;
mod interrupt;
mod list;
mod merge;
mod progress;
mod schema;
mod simulate;
mod stability;
mod theory;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

pub(crate) use error::CliError;

/// Compares a variational RATTLE integrator with rapier on the same URDF multibody models.
#[derive(Debug, Parser)]
#[command(name = "rattlebench", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Inspect(inspect::Args),
    Simulate(simulate::Args),
    Compare(compare::Args),
    Stability(stability::Args),
    Merge(merge::Args),
    Check(check::Args),
    Cost(cost::Args),
    Theory(theory::Args),
    Generate(generate::Args),
    Chart(chart::Args),
    List(list::Args),
    Schema(schema::Args),
}

/// Parses the command line and runs the subcommand that it names.
pub fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Inspect(args) => inspect::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Stability(args) => stability::run(&args),
        Command::Merge(args) => merge::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Cost(args) => cost::run(&args),
        Command::Theory(args) => theory::run(&args),
        Command::Generate(args) => generate::run(&args),
        Command::Chart(args) => chart::run(&args),
        Command::List(args) => list::run(&args),
        Command::Schema(args) => schema::run(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if !error.is_silent() {
                eprintln!("error: {error}");
            }
            error.exit_code()
        }
    }
}
