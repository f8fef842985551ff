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
    /// All of them, in the order in which messages list them.
    pub const ALL: [JointKind; 7] = [
        JointKind::Fixed,
        JointKind::Revolute,
        JointKind::Continuous,
        JointKind::Prismatic,
        JointKind::Planar,
        JointKind::Spherical,
        JointKind::Floating,
    ];

    /// The value of `<joint type="...">`.
    pub const fn name(self) -> &'static str {
        match self {
            JointKind::Fixed => "fixed",
            JointKind::Revolute => "revolute",
            JointKind::Continuous => "continuous",
            JointKind::Prismatic => "prismatic",
            JointKind::Planar => "planar",
            JointKind::Spherical => "spherical",
            JointKind::Floating => "floating",
        }
    }

    /// What an engine must have to run a model with such a joint.
    pub(super) const fn need(self) -> &'static str {
        match self {
            JointKind::Fixed => "welded links",
            JointKind::Revolute | JointKind::Continuous => "revolute joints",
            JointKind::Prismatic => "prismatic joints",
            JointKind::Planar => "planar joints",
            JointKind::Spherical => "ball joints",
            JointKind::Floating => "floating joints",
        }
    }

    /// True where the axis has a meaning.
    pub(crate) const fn has_axis(self) -> bool {
        match self {
            JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic | JointKind::Planar => true,
            JointKind::Fixed | JointKind::Spherical | JointKind::Floating => false,
        }
    }

    /// True where the two links are one body.
    pub(crate) const fn is_weld(self) -> bool {
        self.degrees_of_freedom() == 0
    }

    /// Number of coordinates, and of velocities.
    pub const fn degrees_of_freedom(self) -> usize {
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
