//! What a URDF and a scene file say, as plain validated data in SI units. Nothing here knows dynamics.

pub mod assemble;
pub mod bounds;
mod document;
mod error;
pub mod generate;
mod inertia;
mod names;
mod needs;
mod resolve;
pub mod scene;
mod scene_error;
pub mod scene_file;
mod shapes;
mod tree;
mod urdf;

use nalgebra::{Isometry3, Matrix3, Unit, Vector3};

pub use bounds::{Bound, Limit, read_bounds};
pub use error::{ModelError, Position, Problem};
pub use scene::{Base, Scene};
pub use scene_error::{SceneError, SceneProblem};
pub use urdf::{read_urdf, read_urdf_with_density};

/// A URDF as read: a tree of links. `links[0]` is the root, and every joint's parent stands before its child.
#[derive(Clone, Debug)]
pub struct Model {
    pub name: String,
    pub links: Vec<Link>,
    /// In tree order: the joint of a link's parent comes before the joint of the link. Joint `j` carries link `j + 1`.
    pub joints: Vec<Joint>,
    /// What the file holds and a run does not use, in the order of the file.
    pub ignored: Vec<Ignored>,
    /// What was read but deserves a second look, one sentence each.
    pub remarks: Vec<String>,
}

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

/// A URDF joint between two links, named by their index in [`Model::links`].
#[derive(Clone, Debug)]
pub struct Joint {
    pub name: String,
    pub kind: JointKind,
    pub parent: usize,
    pub child: usize,
    /// Pose of the child link's frame in the parent link's frame at joint position zero.
    pub origin: Isometry3<f64>,
    /// In the child link's frame. Meaningless for fixed, spherical and floating joints, where it is x.
    pub axis: Unit<Vector3<f64>>,
    /// Viscous damping, N m s/rad for rotations and N s/m for translations, acting on each coordinate of the joint.
    pub damping: f64,
    /// Coulomb friction as read, N m or N. Not simulated.
    pub friction: f64,
    /// `position = multiplier * position(source) + offset`, as read.
    pub mimic: Option<Mimic>,
}

/// URDF joint types.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    Fixed,
    Revolute,
    Continuous,
    Prismatic,
    Planar,
    Spherical,
    Floating,
}

impl JointKind {
    /// The values of `<joint type="...">`.
    pub const NAMES: [&str; 7] = ["fixed", "revolute", "continuous", "prismatic", "planar", "spherical", "floating"];

    /// The value of `<joint type="...">`.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// True where the axis has a meaning.
    pub fn has_axis(self) -> bool {
        matches!(self, JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic | JointKind::Planar)
    }

    /// Number of coordinates, and of velocities.
    pub fn degrees_of_freedom(self) -> usize {
        match self {
            JointKind::Fixed => 0,
            JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic => 1,
            JointKind::Planar | JointKind::Spherical => 3,
            JointKind::Floating => 6,
        }
    }
}

/// A joint that follows another one.
#[derive(Clone, Debug, PartialEq)]
pub struct Mimic {
    /// Index in [`Model::joints`] of the joint that is followed.
    pub source: usize,
    pub multiplier: f64,
    /// rad or m
    pub offset: f64,
}

/// Something that the file holds and that a run does not use.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Ignored {
    /// Where it stands, such as `joint 'elbow'`.
    pub element: String,
    /// What it is, such as `limit`.
    pub what: String,
    /// What was read, such as `lower -1.57, upper 1.57`.
    pub value: String,
}
