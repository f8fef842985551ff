//! `cost.json`: processor time a step against the number of links.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::environment::{self, Machine, Versions};
use crate::measure::cost::scaling::Point;

/// Name and version of `cost.json`.
pub(crate) const SCHEMA: &str = "rattlebench/cost/1";

/// Processor time a step of several engines on chains of several lengths.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cost {
    pub schema: String,
    pub machine: Machine,
    pub versions: Versions,
    pub command: String,
    /// The chains, in words.
    pub model: String,
    pub step_s: f64,
    /// Simulated time that was stepped through, s; less where the steps take long.
    pub timed_s: f64,
    pub points: Vec<CostPoint>,
}

/// One engine on one chain; median, smallest and largest over the rounds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CostPoint {
    pub engine: String,
    pub links: usize,
    pub us_per_step: f64,
    pub us_per_step_min: f64,
    pub us_per_step_max: f64,
}

impl Cost {
    pub fn new(points: &[Point], model: String, step_s: f64, timed_s: f64, command: String) -> Cost {
        let point = |p: &Point| CostPoint {
            engine: p.engine.clone(),
            links: p.links,
            us_per_step: 1e6 * p.timing.median,
            us_per_step_min: 1e6 * p.timing.min,
            us_per_step_max: 1e6 * p.timing.max,
        };
        Cost {
            schema: SCHEMA.to_string(),
            machine: environment::machine(),
            versions: environment::versions(),
            command,
            model,
            step_s,
            timed_s,
            points: points.iter().map(point).collect(),
        }
    }
}
