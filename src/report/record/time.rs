//! Processor times, and how they were measured.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::measure::cost::clock::{self, Effort};
use crate::measure::study::Findings;

/// Processor time of the stepping alone, on one thread.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Time {
    /// Median over the repeats.
    pub us_per_step: f64,
    /// A tenth of the repeats took less, none where they are few. Costs are compared by it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub us_per_step_low: Option<f64>,
    pub us_per_step_min: f64,
    pub us_per_step_max: f64,
    /// Processor seconds for a simulated second.
    pub s_per_simulated_s: f64,
    pub repeats: usize,
    /// Steps of one repeat, counted from the start of the run; long runs are timed over their first part.
    pub steps: u64,
}

pub(super) fn time(timing: clock::Timing, step: f64) -> Time {
    Time {
        us_per_step: 1e6 * timing.median,
        us_per_step_low: Some(1e6 * timing.low),
        us_per_step_min: 1e6 * timing.min,
        us_per_step_max: 1e6 * timing.max,
        s_per_simulated_s: timing.median / step,
        repeats: timing.rounds,
        steps: timing.steps,
    }
}

/// How processor times were measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Timing {
    pub method: String,
    pub rounds: usize,
    /// What the loop around a step takes; it is part of every figure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overhead_us_per_step: Option<f64>,
}

impl Timing {
    pub(super) fn new(findings: &Findings) -> Timing {
        Timing {
            method: format!(
                "processor time of the stepping thread, engines in turns round by round, median over the rounds; \
                 settings of the sweep that decide a rank in {} rounds, and costs compared by the lower decile",
                Effort::RANKING.rounds
            ),
            rounds: Effort::FULL.rounds,
            overhead_us_per_step: findings.overhead.map(|seconds| 1e6 * seconds),
        }
    }
}
