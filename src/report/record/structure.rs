//! The record of what a few steps preserve of the structure of the motion.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::measure::structure;

/// How far a few steps, as one map of joint coordinates and conjugate momenta, are from the properties of the exact
/// motion. The engine is made new at every point. Coordinates in rad and m, momenta over the diagonal of the mass
/// matrix in rad/s and m/s.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Structure {
    /// Time of the state that the steps start from, the same for all engines, s.
    pub at_s: f64,
    /// How many steps make up the map.
    pub steps: usize,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub symplecticity: Option<Symplecticity>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reversibility: Option<Reversibility>,
    /// Only where the scene conserves a component of momentum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub momentum_map: Option<MomentumMap>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory: Option<Memory>,
    /// For an engine whose positions and velocities belong to different times: the same map in coordinates moved back
    /// to the time of the velocities.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_level_corrected: Option<CorrectedStructure>,
    /// Why a figure is missing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detail: Option<String>,
}

/// The largest entry of `A^T Omega A - Omega` for the derivative `A` of the map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Symplecticity {
    pub defect: f64,
    /// What the differences that give the derivative err by, from two increments. A defect below it cannot be told from
    /// none.
    pub differencing_error: f64,
}

/// Distance from the start after the steps, a reversal of all velocities, as many steps and another reversal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reversibility {
    pub defect: f64,
}

/// The largest change of a conserved component of momentum over the steps, over its scale.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MomentumMap {
    pub defect: f64,
}

/// Distance between twice the steps of one engine and the steps of two engines made new: what steps take from those
/// before them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Memory {
    pub distance: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CorrectedStructure {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub symplecticity: Option<Symplecticity>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reversibility: Option<Reversibility>,
}

impl From<&structure::Structure> for Structure {
    fn from(found: &structure::Structure) -> Structure {
        let symplecticity = |d: &structure::Defects| {
            d.symplecticity.map(|s| Symplecticity { defect: s.defect, differencing_error: s.error })
        };
        let reversibility = |d: &structure::Defects| d.reversibility.map(|defect| Reversibility { defect });
        Structure {
            at_s: found.at,
            steps: structure::STEPS,
            symplecticity: symplecticity(&found.as_returned),
            reversibility: reversibility(&found.as_returned),
            momentum_map: found.momentum_map.map(|defect| MomentumMap { defect }),
            memory: found.memory.map(|distance| Memory { distance }),
            time_level_corrected: found.time_level_corrected.as_ref().map(|corrected| CorrectedStructure {
                symplecticity: symplecticity(corrected),
                reversibility: reversibility(corrected),
            }),
            detail: found.detail.clone(),
        }
    }
}
