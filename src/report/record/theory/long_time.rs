//! What methods conserve over many steps.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::measure::theory::Conserved;

/// What one method conserves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LongTimeRecord {
    pub method: String,
    pub variational: bool,
    pub step_s: f64,
    pub steps: usize,
    /// Largest |H − H₀|.
    #[serde(rename = "energy_error_J")]
    pub energy_error_j: f64,
    /// The slope of the energy error times the length of the run.
    #[serde(rename = "energy_drift_J")]
    pub energy_drift_j: f64,
    /// Largest error of the angular momentum, kg m²/s.
    pub momentum_error: f64,
    /// Largest entry of AᵀJA − J for the derivative A of one step.
    pub symplecticity_defect: f64,
}

impl LongTimeRecord {
    pub(super) fn new(Conserved { row, variational }: &Conserved) -> LongTimeRecord {
        LongTimeRecord {
            method: row.method.to_string(),
            variational: *variational,
            step_s: row.step,
            steps: row.steps,
            energy_error_j: row.energy_error,
            energy_drift_j: row.energy_slope.abs() * row.step * row.steps as f64,
            momentum_error: row.momentum_error,
            symplecticity_defect: row.symplecticity_defect,
        }
    }
}
