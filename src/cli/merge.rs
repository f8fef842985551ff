//! `merge`: shards of one suite into one.

use std::collections::HashMap;
use std::io::Write as _;
use std::path::PathBuf;

use super::CliError;
use crate::report::folder::cells::{self, Store};
use crate::report::folder::stability;
use crate::report::record::stability::StabilityReport;
use crate::report::record::stability::{CellRecord, Key, SuiteRecord};
use crate::report::words::borders;

/// Put the shards of one stability suite together: the same bytes as of a suite that was run in one piece.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Folders that `stability --shard I/N --out DIR` wrote.
    #[arg(required = true, value_name = "DIR")]
    shard: Vec<PathBuf>,
    /// Folder for the cells, the maps and the page.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub fn run(args: &Args) -> Result<(), CliError> {
    let mut suite: Option<SuiteRecord> = None;
    let mut cells: HashMap<Key, CellRecord> = HashMap::new();
    let mut stored = Vec::new();
    for folder in &args.shard {
        let (there, found) = cells::read(folder, suite.as_ref())?;
        suite.get_or_insert(there);
        for cell in found {
            match cells.insert(cell.key(), cell.cell.clone()) {
                Some(other) if other != cell.cell => {
                    return Err(CliError::TwoResults { path: folder.clone(), cell: cell.key().words() });
                }
                Some(_) => {}
                None => stored.push(cell),
            }
        }
    }
    let Some(suite) = suite else { return Ok(()) };
    let report = StabilityReport::assemble(&suite, &cells)?;
    let (store, _) = Store::open(&args.out, &suite, false)?;
    for cell in &stored {
        store.add(cell)?;
    }
    let page = stability::write(&report, &args.out)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}{}", borders::text(&report), page.display())?;
    Ok(())
}
