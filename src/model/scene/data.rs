//! Scenes: a model with gravity, an initial state, loops, forces, a duration and bounds.

use nalgebra::{Isometry3, Vector3};

use super::bounds::Bound;
use super::parts::{Drive, Loop, Spring};
use crate::model::joint::Joint;
use crate::model::robot::Model;

/// Gravity where a scene does not say otherwise, m/s^2.
pub(crate) const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Duration where a scene does not say otherwise, s.
pub const DURATION: f64 = 10.0;

/// Steps where a scene does not say otherwise, s.
pub const STEPS: [f64; 4] = [0.01, 0.005, 0.002, 0.001];

/// A model with all that a run of it needs. Lengths m, angles rad, time s.
#[derive(Clone, Debug)]
pub struct Scene {
    pub name: String,
    pub description: String,
    pub model: Model,
    /// m/s^2, world axes
    pub gravity: Vector3<f64>,
    pub base: Base,
    /// For each joint of the model, in its order, one entry a degree of freedom.
    pub initial: Vec<JointInitial>,
    pub loops: Vec<Loop>,
    pub springs: Vec<Spring>,
    pub drives: Vec<Drive>,
    /// s
    pub duration: f64,
    /// Step sizes that a comparison runs by default, s, largest first.
    pub steps: Vec<f64>,
    pub bounds: Vec<Bound>,
}

/// How the root link stands in the world.
#[derive(Clone, Debug)]
pub enum Base {
    /// Bolted to the world: the root link's frame is the world frame.
    Fixed,
    /// Free. Pose and velocity are those of the root link's frame, in world axes.
    Floating { pose: Isometry3<f64>, linear_velocity: Vector3<f64>, angular_velocity: Vector3<f64> },
}

impl Base {
    /// True where the root link is a body of its own.
    pub(crate) const fn is_floating(&self) -> bool {
        match self {
            Base::Fixed => false,
            Base::Floating { .. } => true,
        }
    }
}

/// Initial coordinates and velocities of one joint, each as long as the joint has degrees of freedom.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointInitial {
    pub position: Vec<f64>,
    pub velocity: Vec<f64>,
    /// Whether the scene gave them. What it did not give is solved for where loops or mimic joints need it.
    pub position_given: bool,
    pub velocity_given: bool,
}

impl Scene {
    /// A model with defaults: fixed base, gravity along -z, everything at rest at zero, no loops, springs or drives.
    pub fn of_model(name: &str, model: Model) -> Scene {
        let at_rest = |joint: &Joint| {
            let zero = vec![0.0; joint.kind.degrees_of_freedom()];
            JointInitial { position: zero.clone(), velocity: zero, ..JointInitial::default() }
        };
        Scene {
            name: name.to_owned(),
            description: String::new(),
            initial: model.joints.iter().map(at_rest).collect(),
            model,
            gravity: Vector3::from(GRAVITY),
            base: Base::Fixed,
            loops: Vec::new(),
            springs: Vec::new(),
            drives: Vec::new(),
            duration: DURATION,
            steps: STEPS.to_vec(),
            bounds: Vec::new(),
        }
    }
}
