//! `stability`: where engines stop being right, cell by cell.

use std::io::Write as _;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use clap::builder::{PossibleValue, PossibleValuesParser};

use super::{CliError, input, interrupt, progress};
use crate::engines::{self, Role};
use crate::measure::stability::suite;
use crate::measure::stability::{Cell, FAMILIES, Family, Finding, Shard, Suite};
use crate::measure::threads;
use crate::report::folder;
use crate::report::folder::cells::{Store, StoreError};
use crate::report::record::stability::{Key, StabilityReport, StoredCell, SuiteRecord};
use crate::report::words::borders;

/// Find where engines stop being right, and how they fail: stiff and extreme scenes along a parameter, against the
/// step.
///
/// Every cell gets a class: accurate, bounded, drifting, dissipating, gaining, constraint_broken, blow_up, refused or
/// over_budget. Finished cells are kept in the folder; --resume runs the rest.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Families to run [default: all].
    #[arg(value_name = "FAMILY", value_parser = PossibleValuesParser::new(
        FAMILIES.into_iter().map(|family| PossibleValue::new(family.name).help(family.question))
    ))]
    family: Vec<String>,
    #[arg(long, value_name = "SPEC", help = engine_help())]
    engine: Vec<String>,
    /// Folder for the cells, the maps and the page.
    #[arg(long, value_name = "DIR", default_value = "reports/stability")]
    out: PathBuf,
    /// Threads [default: one a core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Fewer values and steps.
    #[arg(long)]
    quick: bool,
    /// Keep the cells that are finished in the folder and run the rest.
    #[arg(long)]
    resume: bool,
    /// Run the I-th of N parts of the suite, to be put together by merge.
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    shard: Shard,
}

/// With the engines that some families add.
fn engine_help() -> String {
    let families: Vec<&str> = FAMILIES.iter().filter(|family| family.explicit).map(|family| family.name).collect();
    let (more, families) = (engines::line_up(Role::Explicit).join(", "), families.join(", "));
    format!("{}; without it also {more} in {families}", input::engine_help(Role::Stability))
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Shard, String> {
        let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((index, of)) if (1..=of).contains(&index) => Ok(Shard { index, of }),
            _ => Err("must be I/N with whole numbers 1 <= I <= N, such as 2/8".to_string()),
        }
    }
}

pub fn run(args: &Args) -> Result<(), CliError> {
    let asked = |family: &&&Family| args.family.is_empty() || args.family.iter().any(|name| name == family.name);
    let families: Vec<&'static Family> = FAMILIES.iter().filter(asked).copied().collect();
    let engines = if args.engine.is_empty() {
        input::specs(&engines::line_up(Role::Stability))?
    } else {
        input::specs(&args.engine)?
    };
    let head = SuiteRecord::new(&families, &engines, args.engine.is_empty(), args.quick);
    let (store, mut finished) = Store::open(&args.out, &head, args.resume)?;
    let suite = Suite::new(families, |family| input::specs(&head.engines_of(family)), args.quick)?;
    let mut todo = suite.cells(args.shard);
    todo.retain(|cell| !finished.contains_key(&Key::of(cell)));
    let jobs = args.jobs.map_or_else(threads::cores, usize::from);
    let new = work_off(&todo, jobs, &store)?;
    let missing = todo.len() - new.len();
    finished.extend(new.into_iter().map(|stored| (stored.key(), stored.cell)));
    let mut out = std::io::stdout().lock();
    if missing > 0 {
        eprintln!("{missing} cells are left; the same command with --resume runs them");
        return Err(CliError::Interrupted);
    }
    if args.shard != Shard::WHOLE {
        writeln!(out, "{} cells of shard {}/{}", finished.len(), args.shard.index, args.shard.of)?;
        return Ok(());
    }
    let report = StabilityReport::assemble(&head, &finished)?;
    let page = folder::stability::write(&report, &args.out)?;
    writeln!(out, "{}{}", borders::text(&report), page.display())?;
    Ok(())
}

/// Runs cells, puts each on disk as soon as it is finished, and returns those that were.
fn work_off(todo: &[Cell], jobs: usize, store: &Store) -> Result<Vec<StoredCell>, CliError> {
    let (done, interrupted) = (AtomicU64::new(0), interrupt::flag());
    let (found, failure) = (Mutex::new(Vec::new()), Mutex::new(None::<StoreError>));
    let keep = |cell: &Cell, finding: Finding| {
        let stored = StoredCell::new(cell, finding);
        match (store.add(&stored), found.lock(), failure.lock()) {
            (Ok(()), Ok(mut found), _) => found.push(stored),
            (Err(error), _, Ok(mut failure)) => {
                *failure = Some(error);
                interrupted.store(true, Ordering::Relaxed);
            }
            _ => interrupted.store(true, Ordering::Relaxed),
        }
    };
    let stages = [progress::Stage::new("running", suite::work(todo), &done)];
    progress::during("stability", &stages, || suite::run(todo, jobs, interrupted, &done, &keep));
    match failure.into_inner() {
        Ok(Some(error)) => Err(error.into()),
        _ => Ok(found.into_inner().unwrap_or_default()),
    }
}
