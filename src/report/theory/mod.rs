//! What `rattlebench theory` writes: the figures of Marsden and West (2001) and the tables of orders, conservation and small
//! steps, computed by [`crate::discrete`].
//!
//! A topic is computed into plain records, and its section of the page, its tables and charts are made from those alone.

mod energy;
mod files;
mod long_time;
mod orders;
mod small_steps;
mod table;

use std::sync::atomic::AtomicU64;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::charts::ChartError;
use super::page::document::Picture;
use crate::discrete::solve::SolveError;

pub use energy::{CurveRecord, EnergyRecord};
pub use files::{FILE_SCHEMA, TheoryError, TheoryFile, draw, draw_folder, write};
pub use long_time::LongTimeRecord;
pub use orders::{ErrorRecord, OrderRecord, OrdersRecord};
pub use small_steps::{SmallStepRecord, SmallStepsRecord};
pub use table::Table;

/// Something that the theory says and that is computed here.
pub struct Topic {
    pub name: &'static str,
    pub summary: &'static str,
    /// Units of work that `compute` counts.
    pub work: fn() -> u64,
    pub compute: fn(&AtomicU64) -> Result<Data, SolveError>,
}

/// All topics, in the order of the page. A new one is a file, a line here, and a kind of [`Data`].
pub const TOPICS: [Topic; 5] =
    [orders::TOPIC, energy::FIGURE_1, energy::FIGURE_2, long_time::TOPIC, small_steps::TOPIC];

/// What a topic computes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Data {
    Orders(Vec<OrdersRecord>),
    Energy(EnergyRecord),
    LongTime(Vec<LongTimeRecord>),
    SmallSteps(Vec<SmallStepsRecord>),
}

/// What a topic has to tell.
#[derive(Debug)]
pub struct Section {
    pub title: &'static str,
    /// One sentence with figures.
    pub finding: String,
    /// How the figures were got.
    pub explanation: String,
    /// Charts with the names of their files.
    pub charts: Vec<(String, Picture)>,
    pub tables: Vec<Table>,
}

impl Data {
    /// Whether this is what a topic computes; data read from a file may be another's.
    fn belongs_to(&self, topic: &str) -> bool {
        match self {
            Data::Orders(_) => topic == orders::TOPIC.name,
            Data::Energy(record) => {
                [energy::FIGURE_1.name, energy::FIGURE_2.name].contains(&topic) && record.is_whole()
            }
            Data::LongTime(_) => topic == long_time::TOPIC.name,
            Data::SmallSteps(_) => topic == small_steps::TOPIC.name,
        }
    }

    /// Tables, charts and words of a topic.
    ///
    /// # Errors
    /// A chart that cannot be drawn.
    pub fn section(&self, topic: &str) -> Result<Section, ChartError> {
        match self {
            Data::Orders(problems) => orders::section(problems),
            Data::Energy(record) => energy::section(record, topic),
            Data::LongTime(rows) => long_time::section(rows),
            Data::SmallSteps(problems) => small_steps::section(problems),
        }
    }
}

/// `x`, where it is a number that JSON can hold.
fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

/// Text of a figure, a dash where there is none.
fn cell(x: Option<f64>, text: impl Fn(f64) -> String) -> String {
    x.map_or_else(|| "–".to_string(), text)
}
