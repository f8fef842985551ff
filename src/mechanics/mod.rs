//! The compiled system: rigid bodies in a tree of joints, and what can be computed from a state of it.
//!
//! A [`System`] is what every engine is built from. Links that fixed joints hold together are one body; a body's frame
//! has its origin in the centre of mass and its axes along the principal axes of inertia. Each body hangs on exactly
//! one [`Joint`]: a body that nothing holds hangs on the ground by a floating joint.

mod closing;
pub mod constraint;
pub mod coordinates;
pub mod energy;
pub mod momentum;
mod parts;
mod system;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

pub use closing::{Given, Mobility};
pub use parts::{Anchor, Closure, Coupling, Drive, JointSpring, Part, Parts, PointSpring};
pub use system::CompileError;

use coordinates::JointCoordinates;

/// A multibody system ready to be simulated.
#[derive(Clone, Debug)]
pub struct System {
    pub name: String,
    /// Parents before children.
    pub bodies: Vec<Body>,
    /// What there is beside the tree.
    pub parts: Parts,
    /// m/s^2, world axes
    pub gravity: Vector3<f64>,
    /// The state at t = 0, on the constraint manifold to roundoff.
    pub initial: State,
    /// The coordinates that `initial` was built from, one entry a body.
    pub initial_coordinates: Vec<JointCoordinates>,
    /// What loops and couplings leave free at t = 0.
    pub mobility: Mobility,
    /// What relative energy errors are divided by, J. See [`energy::scale`].
    pub energy_scale: f64,
    /// Set where the root link is free: its frame, seen from the frame of the body that it is part of.
    pub floating_base: Option<FloatingBase>,
}

/// Where the root link of a floating model is.
#[derive(Clone, Debug)]
pub struct FloatingBase {
    /// Index of the body in [`System::bodies`].
    pub body: usize,
    /// Pose of the root link's frame in the body's frame.
    pub link_in_body: Isometry3<f64>,
}

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

/// A joint between a body and its parent, as a motion subspace.
///
/// The *joint frame* exists twice: fixed in the parent and fixed in the child; at joint position zero the two agree.
/// Its z axis is the axis of the joint. A relative twist is that of the child against the parent, taken at the origin of
/// the child's joint frame, in the axes of the parent's joint frame; a joint lets exactly the components of
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

/// The motions that a joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// One angle about z (URDF `revolute` and `continuous`).
    Revolute,
    /// One length along z.
    Prismatic,
    /// Lengths along x and y, and the angle about z.
    Planar,
    /// A rotation vector; its velocity is the relative angular velocity in the parent's joint frame.
    Spherical,
    /// Lengths along x, y, z, then a rotation vector; velocities in the parent's joint frame.
    Floating,
}

impl JointKind {
    /// Which components of a relative twist (linear x, y, z, angular x, y, z) are free.
    pub const fn free(self) -> [bool; 6] {
        match self {
            JointKind::Revolute => [false, false, false, false, false, true],
            JointKind::Prismatic => [false, false, true, false, false, false],
            JointKind::Planar => [true, true, false, false, false, true],
            JointKind::Spherical => [false, false, false, true, true, true],
            JointKind::Floating => [true; 6],
        }
    }

    /// Number of coordinates, and of velocities.
    pub const fn degrees_of_freedom(self) -> usize {
        match self {
            JointKind::Revolute | JointKind::Prismatic => 1,
            JointKind::Planar | JointKind::Spherical => 3,
            JointKind::Floating => 6,
        }
    }
}

/// Pose and velocity of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Centre of mass, m, world.
    pub position: Vector3<f64>,
    /// Body axes to world axes.
    pub attitude: UnitQuaternion<f64>,
    /// Of the centre of mass, m/s, world axes.
    pub velocity: Vector3<f64>,
    /// rad/s, world axes
    pub angular_velocity: Vector3<f64>,
}

impl BodyState {
    /// The state of the ground, as if it were a body.
    pub fn ground() -> BodyState {
        BodyState {
            position: Vector3::zeros(),
            attitude: UnitQuaternion::identity(),
            velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
        }
    }

    /// Pose of the body frame in the world.
    pub fn pose(&self) -> Isometry3<f64> {
        Isometry3::from_parts(self.position.into(), self.attitude)
    }
}

/// State of a system: one entry a body, in the order of [`System::bodies`].
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    pub bodies: Vec<BodyState>,
}

impl State {
    /// True where every number is finite.
    pub fn is_finite(&self) -> bool {
        self.bodies.iter().all(|b| {
            b.position
                .iter()
                .chain(b.attitude.coords.iter())
                .chain(b.velocity.iter())
                .chain(b.angular_velocity.iter())
                .all(|x| x.is_finite())
        })
    }
}
