//! What a topic of the theory computes, and the file of it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::energy::EnergyRecord;
use super::long_time::LongTimeRecord;
use super::orders::OrdersRecord;
use super::small_steps::SmallStepsRecord;
use crate::measure::theory::{Computed, energy, long_time, orders, small_steps};
use crate::report::record::environment::Versions;

/// Name and version of the JSON files.
pub(crate) const FILE_SCHEMA: &str = "rattlebench/theory/1";

/// One topic as JSON. It holds no timing and is the same whenever the same program writes it by the same command.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TheoryFile {
    /// Always `rattlebench/theory/1`.
    pub schema: String,
    /// Name of the topic, as on the command line.
    pub topic: String,
    pub title: String,
    /// One sentence with figures.
    pub finding: String,
    pub versions: Versions,
    /// The command line that wrote this file.
    pub command: String,
    pub data: Data,
}

/// What a topic computes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Data {
    Orders(Vec<OrdersRecord>),
    Energy(EnergyRecord),
    LongTime(Vec<LongTimeRecord>),
    SmallSteps(Vec<SmallStepsRecord>),
}

impl Data {
    /// Whether this is what a topic computes; data read from a file may be another's.
    pub(in crate::report) fn belongs_to(&self, topic: &str) -> bool {
        match self {
            Data::Orders(_) => topic == orders::TOPIC.name,
            Data::Energy(record) => {
                [energy::FIGURE_1.name, energy::FIGURE_2.name].contains(&topic) && record.is_whole()
            }
            Data::LongTime(_) => topic == long_time::TOPIC.name,
            Data::SmallSteps(_) => topic == small_steps::TOPIC.name,
        }
    }
}

impl From<Computed> for Data {
    fn from(found: Computed) -> Data {
        match found {
            Computed::Orders(problems) => Data::Orders(problems.into_iter().map(OrdersRecord::from).collect()),
            Computed::Energy(figure) => Data::Energy(figure.into()),
            Computed::LongTime(rows) => Data::LongTime(rows.iter().map(LongTimeRecord::new).collect()),
            Computed::SmallSteps(problems) => Data::SmallSteps(problems.iter().map(SmallStepsRecord::new).collect()),
        }
    }
}
