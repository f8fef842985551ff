//! Links in joint coordinates.

use nalgebra::{Isometry3, Matrix3, Vector3};

use crate::mechanics::{Drive, JointKind};

/// A body seen from its *link frame*, which is the joint frame fixed in the child. Constant over a run.
#[derive(Clone, Debug)]
pub struct Link {
    pub parent: Option<usize>,
    pub kind: JointKind,
    /// Pose of the joint frame fixed in the parent, in the parent's link frame (in the world for the ground).
    pub in_parent: Isometry3<f64>,
    /// The rotation of `in_parent` as a matrix.
    pub parent_axes: Matrix3<f64>,
    /// Pose of the body frame (centre of mass, principal axes) in the link frame.
    pub body: Isometry3<f64>,
    /// kg
    pub mass: f64,
    /// `m c` with the centre of mass `c` in the link frame, kg m.
    pub first_moment: Vector3<f64>,
    /// Inertia about the origin of the link frame, in its axes, kg m^2.
    pub inertia: Matrix3<f64>,
    /// Mass of the link and of all links beyond it, kg.
    pub mass_beyond: f64,
    /// N m s/rad or N s/m, for each velocity.
    pub damping: f64,
    /// Springs in a joint of one coordinate: the effort is `spring_effort - stiffness q`, in N m/rad and N m, or N/m
    /// and N.
    pub stiffness: f64,
    pub spring_effort: f64,
    /// In a joint of one coordinate.
    pub drives: Vec<Drive>,
    /// First position and first velocity of the joint.
    pub position: usize,
    pub velocity: usize,
}

impl Link {
    /// What springs and drives exert in a joint of one coordinate `q` at a time in s.
    #[inline(always)]
    pub(super) fn joint_effort(&self, time: f64, q: f64) -> f64 {
        self.spring_effort - self.stiffness * q + self.drive_effort(time)
    }

    /// What drives exert in a joint of one coordinate at a time in s.
    #[inline(always)]
    pub(super) fn drive_effort(&self, time: f64) -> f64 {
        self.drives.iter().map(|drive| drive.at(time)).sum()
    }
}
