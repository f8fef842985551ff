//! A run in few numbers, for the charts.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::measure::trace::series::{Block, Extent};
use crate::measure::trace::{self, Trace};

/// The run in at most 400 blocks of consecutive steps, six digits.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Series {
    /// Middle of each block, s.
    pub time_s: Vec<f64>,
    /// Smallest and largest signed relative energy error in each block.
    pub energy_min: Vec<f64>,
    pub energy_max: Vec<f64>,
    /// Largest absolute time-level-corrected relative energy error in each block.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corrected_energy: Option<Vec<f64>>,
    /// Largest residuals in each block.
    pub constraint_position: Vec<f64>,
    pub constraint_velocity: Vec<f64>,
}

pub(super) fn series(trace: &Trace) -> Series {
    let column = |pick: &dyn Fn(&Block<{ trace::QUANTITIES }>) -> f64| {
        trace.series.blocks.iter().map(|b| six_digits(pick(b))).collect::<Vec<f64>>()
    };
    let of = |quantity: usize, pick: fn(&Extent) -> f64| column(&|b| pick(&b.values[quantity]));
    Series {
        time_s: column(&|b| 0.5 * (b.from + b.to)),
        energy_min: of(trace::ENERGY, |e| e.min),
        energy_max: of(trace::ENERGY, |e| e.max),
        corrected_energy: trace.time_level_corrected.map(|_| of(trace::CORRECTED_ENERGY, |e| e.amplitude())),
        constraint_position: of(trace::POSITION, |e| e.max),
        constraint_velocity: of(trace::VELOCITY, |e| e.max),
    }
}

fn six_digits(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_keep_six_digits() {
        assert_eq!(six_digits(-1.234_567_89e-7), -1.23457e-7);
        assert_eq!(six_digits(0.0), 0.0);
    }
}
