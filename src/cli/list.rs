//! `list`: what there is to choose from, from the lists that the program itself works with.

use std::io::Write as _;
use std::path::Path;

use clap::ValueEnum;
use serde::Serialize;

use super::{CliError, input};
use crate::discrete::methods::METHODS;
use crate::engines::{ENGINES, Key};
use crate::model::Scene;
use crate::report::record::metrics::METRICS;

/// List what there is to choose from.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    what: What,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum What {
    /// Engines and the keys of their specs.
    Engines,
    /// Discrete Lagrangians of the general theory.
    Methods,
    /// Scenes under models/ in this folder.
    Scenes,
    /// Figures of a run, by the name that bounds use.
    Metrics,
}

/// One line of a list; what belongs to it stands indented below.
#[derive(Debug, Serialize)]
struct Item {
    name: String,
    summary: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    values: Option<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    keys: Vec<Item>,
}

impl Item {
    fn new(name: &str, summary: &str) -> Item {
        Item { name: name.to_string(), summary: summary.to_string(), values: None, keys: Vec::new() }
    }
}

pub fn run(args: &Args) -> Result<(), CliError> {
    let items = match args.what {
        What::Engines => ENGINES
            .iter()
            .map(|e| Item { keys: e.keys.iter().map(|k| key(*k)).collect(), ..Item::new(e.name, e.summary) })
            .collect(),
        What::Methods => METHODS
            .iter()
            .map(|m| Item::new(m.name, &format!("order {}, Marsden and West (2001) {}", m.order, m.equation)))
            .collect(),
        What::Scenes => scenes(Path::new("models"))?,
        What::Metrics => METRICS
            .iter()
            .map(|m| Item { values: (!m.unit.is_empty()).then(|| m.unit.to_string()), ..Item::new(m.name, m.summary) })
            .collect(),
    };
    let text = if args.json { serde_json::to_string_pretty(&items)? + "\n" } else { lines(&items, "") };
    write!(std::io::stdout().lock(), "{text}")?;
    Ok(())
}

fn key(key: Key) -> Item {
    Item { values: Some(key.values()), ..Item::new(key.name(), &key.summary()) }
}

/// The scenes `models/*/scene.json`, by name.
fn scenes(models: &Path) -> Result<Vec<Item>, CliError> {
    let files = input::shipped(models)?;
    files
        .iter()
        .map(|file| {
            let scene = Scene::load(file)?;
            Ok(Item { values: Some(file.display().to_string()), ..Item::new(&scene.name, &scene.description) })
        })
        .collect()
}

fn lines(items: &[Item], indent: &str) -> String {
    let width = items.iter().map(|i| i.name.chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for item in items {
        let values = item.values.as_ref().map(|v| format!(" ({v})")).unwrap_or_default();
        text += &format!("{indent}{:width$}  {}{values}\n", item.name, item.summary);
        text += &lines(&item.keys, &format!("{indent}    "));
    }
    text
}
