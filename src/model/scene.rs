//! Scenes: a model with gravity, an initial state, loops, forces, a duration and bounds.

use std::path::Path;

use nalgebra::{Isometry3, Unit, Vector3};

use super::bounds::Bound;
use super::scene_error::{SceneError, SceneProblem};
use super::{Model, read_urdf, resolve};

/// Gravity where a scene does not say otherwise, m/s^2.
pub const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

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

/// Initial coordinates and velocities of one joint, each as long as the joint has degrees of freedom.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointInitial {
    pub position: Vec<f64>,
    pub velocity: Vec<f64>,
    /// Whether the scene gave them. What it did not give is solved for where loops or mimic joints need it.
    pub position_given: bool,
    pub velocity_given: bool,
}

/// A joint that closes a loop, between two places that the tree already connects.
#[derive(Clone, Debug)]
pub struct Loop {
    pub name: String,
    pub kind: LoopKind,
    /// In the frame `parent_origin`; x where the kind has no axis.
    pub axis: Unit<Vector3<f64>>,
    pub parent: Place,
    pub child: Place,
}

/// What a loop joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoopKind {
    Revolute,
    Spherical,
    Fixed,
    Prismatic,
}

/// A frame fixed in a link.
#[derive(Clone, Debug)]
pub struct Place {
    /// Index in [`Model::links`]; `None` is the ground.
    pub link: Option<usize>,
    /// Pose in the link's frame.
    pub origin: Isometry3<f64>,
}

/// A spring with a damper beside it.
#[derive(Clone, Debug)]
pub enum Spring {
    /// Effort `-stiffness (position - rest) - damping velocity` in a joint of one coordinate. N m/rad and N m s/rad, or
    /// N/m and N s/m.
    Joint { joint: usize, stiffness: f64, damping: f64, rest: f64 },
    /// Force `stiffness (distance - rest_length) + damping d(distance)/dt` that pulls two points together. N/m, N s/m, m.
    Points { from: Anchor, to: Anchor, stiffness: f64, damping: f64, rest_length: f64 },
}

/// A point fixed in a link.
#[derive(Clone, Debug, PartialEq)]
pub struct Anchor {
    /// Index in [`Model::links`]; `None` is the ground.
    pub link: Option<usize>,
    /// In the link's frame, m.
    pub point: Vector3<f64>,
}

/// Effort `effort + amplitude sin(2 pi frequency_hz t + phase)` in a joint of one coordinate, N m or N.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    pub joint: usize,
    pub effort: f64,
    pub amplitude: f64,
    pub frequency_hz: f64,
    /// rad
    pub phase: f64,
}

impl Scene {
    /// Reads a scene `.json` file, or a `.urdf` file as a scene with defaults: fixed base, everything at rest at zero.
    ///
    /// # Errors
    /// A file that is neither, or that says something impossible; the message names file, element, value and remedy.
    pub fn load(path: impl AsRef<Path>) -> Result<Scene, SceneError> {
        let path = path.as_ref();
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "urdf" => {
                let name = path.file_stem().unwrap_or_default().to_string_lossy();
                Ok(Scene::of_model(&name, read_urdf(path)?))
            }
            "json" => resolve::load(path),
            _ => Err(SceneError::of(path, SceneProblem::UnknownExtension)),
        }
    }

    /// A model with defaults: fixed base, gravity along -z, everything at rest at zero, no loops, springs or drives.
    pub fn of_model(name: &str, model: Model) -> Scene {
        let at_rest = |joint: &super::Joint| {
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
