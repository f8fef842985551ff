//! Rigid bodies.

use nalgebra::Vector3;

use super::joint::Joint;

/// A rigid body, in the frame of its centre of mass and principal axes.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name of the link nearest to the root among those that make up the body.
    pub name: String,
    /// kg
    pub mass: f64,
    /// Principal moments about the centre of mass, kg m^2.
    pub inertia: Vector3<f64>,
    /// What the body hangs on.
    pub joint: Joint,
}
