//! The curves of a figure of energies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::discrete::figures::{EnergyFigure, EnergySeries};

/// The curves of a figure: the truth, the variational method, RK4.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EnergyRecord {
    pub curves: Vec<CurveRecord>,
}

/// Energy over time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CurveRecord {
    pub method: String,
    /// Absent for the truth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step_s: Option<f64>,
    pub time_s: Vec<f64>,
    #[serde(rename = "energy_J")]
    pub energy_j: Vec<f64>,
}

impl From<EnergyFigure> for EnergyRecord {
    fn from(figure: EnergyFigure) -> EnergyRecord {
        let curve = |s: EnergySeries| CurveRecord {
            method: s.name.to_string(),
            step_s: s.step,
            time_s: s.time,
            energy_j: s.energy,
        };
        EnergyRecord { curves: figure.series.into_iter().map(curve).collect() }
    }
}

impl EnergyRecord {
    /// Whether all three curves are there, with as many energies as times and at least one.
    pub(super) fn is_whole(&self) -> bool {
        self.curves.len() == 3 && self.curves.iter().all(|c| !c.time_s.is_empty() && c.time_s.len() == c.energy_j.len())
    }
}
