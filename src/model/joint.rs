//! Joints between links.

use nalgebra::{Isometry3, Unit, Vector3};

/// A URDF joint between two links, named by their index in [`Model::links`](super::Model::links).
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
    /// Index in [`Model::joints`](super::Model::joints) of the joint that is followed.
    pub source: usize,
    pub multiplier: f64,
    /// rad or m
    pub offset: f64,
}
