//! The growth of an error, and what it is judged from.

use serde::{Deserialize, Serialize};

use crate::measure::trace::series::Extent;

/// How the energy error behaved, from the best to the worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// No growth was established.
    Bounded,
    /// Grows about like the square root of time.
    RandomWalk,
    /// Grows about like time, or faster.
    Drift,
    /// More than ten energy scales, or no number any more.
    BlowUp,
}

impl Verdict {
    pub const ALL: [Verdict; 4] = [Verdict::Bounded, Verdict::RandomWalk, Verdict::Drift, Verdict::BlowUp];

    /// For tables.
    pub fn words(self) -> &'static str {
        match self {
            Verdict::Bounded => "bounded",
            Verdict::RandomWalk => "random walk",
            Verdict::Drift => "drift",
            Verdict::BlowUp => "blow-up",
        }
    }

    /// As files spell it.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Bounded => "bounded",
            Verdict::RandomWalk => "random_walk",
            Verdict::Drift => "drift",
            Verdict::BlowUp => "blow_up",
        }
    }
}

/// The growth of an error over a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    pub verdict: Verdict,
    /// Slope of the straight line through the block means, 1/s; negative where energy is lost. Absent where the run was
    /// too short.
    pub slope_per_s: Option<f64>,
    /// Absent after a blow-up.
    pub exponent: Option<Exponent>,
}

/// The power of time with which an error grows, with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponent {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

/// A stretch of a run: its last time (s), the number of its steps, the extent of the error in it.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    pub to: f64,
    pub count: u64,
    pub error: Extent,
}
