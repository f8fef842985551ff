//! Joints between bodies, and their coordinates.

use nalgebra::Isometry3;

use super::joint_kind::JointKind;

/// A joint between a body and its parent, as a motion subspace.
///
/// The *joint frame* exists twice: fixed in the parent and fixed in the child; at joint position zero the two agree.
/// Its z axis is the axis of the joint. A relative twist is that of the child against the parent, taken at the origin
/// of the child's joint frame, in the axes of the parent's joint frame; a joint lets exactly the components of
/// [`JointKind::free`] pass.
#[derive(Clone, Debug)]
pub struct Joint {
    pub name: String,
    pub kind: JointKind,
    /// Index of the parent body; `None` is the ground.
    pub parent: Option<usize>,
    /// Pose of the joint frame in the parent body's frame (in the world for the ground).
    pub in_parent: Isometry3<f64>,
    /// Pose of the joint frame in the child body's frame.
    pub in_child: Isometry3<f64>,
    /// Viscous damping of each coordinate, N m s/rad or N s/m.
    pub damping: f64,
}

/// Positions and velocities of one joint; entries past its degrees of freedom are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointCoordinates {
    /// m and rad, in the order of [`JointKind`].
    pub position: [f64; 6],
    /// m/s and rad/s
    pub velocity: [f64; 6],
}
