//! The evidence that all engines were given one mechanical system.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::measure::parity::Parity as MeasuredParity;

/// The evidence that all engines were given one mechanical system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Parity {
    /// Whether every figure of every engine stands within its bound.
    pub agrees: bool,
    pub engines: Vec<EngineParity>,
}

/// Differences between what an engine has at t = 0 and the system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EngineParity {
    pub engine: String,
    pub agrees: bool,
    /// Largest relative differences of masses and principal moments, and distance of a centre of mass, as read back
    /// from the engine; absent for engines that compute on the system itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub com_m: Option<f64>,
    /// Over the energy scale.
    pub energy: f64,
    /// Over `sqrt(2 m E)` and `sqrt(2 I E)`, with the energy scale `E`.
    pub linear_momentum: f64,
    pub angular_momentum: f64,
    /// Largest difference of a joint acceleration from the reference, over the largest of them (or 1 rad/s^2 or m/s^2).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration: Option<f64>,
    /// The same with the constraints solved to the end, where the engine's settings leave them half solved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration_solved: Option<f64>,
    /// What the figures are held to: accelerations, solved where there are two, to the second bound, the others to the
    /// first.
    pub bound: f64,
    /// Absent where accelerations are told and not judged: motions that the steps do not resolve, and single precision
    /// with constraints that iterations solve or with velocities whose roundoff hides the accelerations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration_bound: Option<f64>,
}

impl Parity {
    /// `None` where no engine could be looked at.
    pub(super) fn new(found: &[MeasuredParity]) -> Option<Parity> {
        let engines: Vec<EngineParity> = found
            .iter()
            .map(|p| EngineParity {
                engine: p.engine.clone(),
                agrees: p.agrees(),
                mass: p.held.map(|h| h.mass),
                inertia: p.held.map(|h| h.inertia),
                com_m: p.held.map(|h| h.com),
                energy: p.start.energy,
                linear_momentum: p.momentum[0],
                angular_momentum: p.momentum[1],
                acceleration: p.acceleration,
                acceleration_solved: p.acceleration_solved,
                bound: p.bounds.system,
                acceleration_bound: p.bounds.acceleration,
            })
            .collect();
        (!engines.is_empty()).then(|| Parity { agrees: engines.iter().all(|e| e.agrees), engines })
    }
}
