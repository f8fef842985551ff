//! Links with their mass properties and collision shapes.

use nalgebra::{Isometry3, Matrix3, Vector3};

/// A rigid link. Its frame is the frame of the joint that it hangs on.
#[derive(Clone, Debug)]
pub struct Link {
    pub name: String,
    /// `None` for a link without mass.
    pub inertial: Option<Inertial>,
    /// Shapes that give mass where the scene states a density.
    pub collisions: Vec<Collision>,
}

/// Mass, centre of mass and inertia of a link.
#[derive(Clone, Debug, PartialEq)]
pub struct Inertial {
    /// kg
    pub mass: f64,
    /// Centre of mass in the link frame, m.
    pub com: Vector3<f64>,
    /// Inertia about the centre of mass in axes parallel to the link frame, kg m^2. Symmetric, positive semidefinite.
    pub inertia: Matrix3<f64>,
}

/// A collision shape, placed in its link's frame.
#[derive(Clone, Debug)]
pub struct Collision {
    pub origin: Isometry3<f64>,
    pub shape: Shape,
}

/// Shapes in their own frame, all lengths in m. Cylinders and capsules stand along z, centred on the origin.
#[derive(Clone, Debug)]
pub enum Shape {
    Box {
        half_extents: Vector3<f64>,
    },
    Cylinder {
        radius: f64,
        length: f64,
    },
    /// `length` is that of the cylindrical part.
    Capsule {
        radius: f64,
        length: f64,
    },
    Sphere {
        radius: f64,
    },
    /// Path as in the file, resolved against the URDF's folder by who reads it.
    Mesh {
        filename: String,
        scale: Vector3<f64>,
    },
}
