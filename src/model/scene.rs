//! Scenes: a model with gravity, an initial state, forces, a duration and bounds.

use nalgebra::{Isometry3, Vector3};

use super::Model;

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
    /// s
    pub duration: f64,
    /// Step sizes that a comparison runs by default, s, largest first.
    pub steps: Vec<f64>,
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
}
