//! What a scene adds to the tree: loops, springs and drives.

use nalgebra::{Isometry3, Unit, Vector3};

/// A joint that closes a loop, between two places that the tree already connects.
#[derive(Clone, Debug)]
pub struct Loop {
    pub name: String,
    pub kind: LoopKind,
    /// In the frame `parent_origin`; x where the kind has no axis.
    pub axis: Unit<Vector3<f64>>,
    pub parent: FixedFrame,
    pub child: FixedFrame,
}

/// What a loop joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoopKind {
    Revolute,
    Spherical,
    Fixed,
    Prismatic,
}

impl LoopKind {
    pub(super) const ALL: [LoopKind; 4] =
        [LoopKind::Revolute, LoopKind::Spherical, LoopKind::Fixed, LoopKind::Prismatic];

    /// True where the axis has a meaning.
    pub(super) const fn has_axis(self) -> bool {
        match self {
            LoopKind::Revolute | LoopKind::Prismatic => true,
            LoopKind::Spherical | LoopKind::Fixed => false,
        }
    }

    /// What an engine must have to run a scene with such a loop.
    pub(super) const fn need(self) -> &'static str {
        match self {
            LoopKind::Revolute => "revolute loops",
            LoopKind::Spherical => "ball loops",
            LoopKind::Fixed => "fixed loops",
            LoopKind::Prismatic => "prismatic loops",
        }
    }
}

/// A frame fixed in a link.
#[derive(Clone, Debug)]
pub struct FixedFrame {
    /// Index in [`Model::links`](crate::model::Model::links); `None` is the ground.
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
    /// Force `stiffness (distance - rest_length) + damping d(distance)/dt` that pulls two points together. N/m, N s/m,
    /// m.
    Points { from: Anchor, to: Anchor, stiffness: f64, damping: f64, rest_length: f64 },
}

impl Spring {
    /// All needs of springs, in the order in which they are listed.
    pub(super) const NEEDS: [&str; 2] = ["joint springs", "point springs"];

    /// What an engine must have to run a scene with such a spring.
    pub(super) const fn need(&self) -> &'static str {
        match self {
            Spring::Joint { .. } => Spring::NEEDS[0],
            Spring::Points { .. } => Spring::NEEDS[1],
        }
    }
}

/// A point fixed in a link.
#[derive(Clone, Debug, PartialEq)]
pub struct Anchor {
    /// Index in [`Model::links`](crate::model::Model::links); `None` is the ground.
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
