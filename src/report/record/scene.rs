//! What was simulated.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::mechanics::System;
use crate::model::{Ignored, Scene};

/// What was simulated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SceneRecord {
    pub name: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
    /// Moving bodies; links that fixed joints hold together are one.
    pub bodies: usize,
    /// Joints between them, the ground's included.
    pub joints: usize,
    pub degrees_of_freedom: usize,
    pub loops: usize,
    /// m/s^2
    pub gravity: [f64; 3],
    /// kg
    pub mass_kg: f64,
    /// What relative energy errors are divided by, J.
    pub energy_scale_j: f64,
    /// What an engine must be able to do.
    pub needs: Vec<String>,
    /// What the files hold and no run used.
    pub ignored: Vec<Ignored>,
    /// What was read but deserves a second look.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<String>,
}

impl SceneRecord {
    pub(super) fn new(scene: &Scene, system: &System) -> SceneRecord {
        SceneRecord {
            name: scene.name.clone(),
            description: scene.description.clone(),
            bodies: system.bodies.len(),
            joints: system.bodies.len(),
            degrees_of_freedom: system.degrees_of_freedom(),
            loops: scene.loops.len(),
            gravity: system.gravity.into(),
            mass_kg: system.bodies.iter().map(|b| b.mass).sum(),
            energy_scale_j: system.energy_scale,
            needs: scene.needs(),
            ignored: scene.model.ignored.clone(),
            remarks: scene.model.remarks.clone(),
        }
    }
}
