//! The compiled system: what every engine is built from.

use nalgebra::{Isometry3, Vector3};

use super::body::Body;
use super::joint::JointCoordinates;
use super::mobility::Mobility;
use super::parts::{JointSpring, Parts};
use super::state::State;

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
    /// What relative energy errors are divided by, J. See [`energy::scale`](super::energy::scale).
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

impl System {
    /// Number of coordinates that joints, loops and couplings leave free at t = 0.
    pub fn degrees_of_freedom(&self) -> usize {
        self.mobility.degrees_of_freedom()
    }

    /// All that pulls on the coordinates of a body's joint, as one spring: the springs together, and the damping of the
    /// joint with that of the springs. `rest` is where the springs hold each other.
    pub fn joint_spring(&self, body: usize) -> JointSpring {
        let springs = || self.parts.joint_springs.iter().filter(|spring| spring.body == body);
        let stiffness: f64 = springs().map(|spring| spring.stiffness).sum();
        let damping = self.bodies[body].joint.damping + springs().map(|spring| spring.damping).sum::<f64>();
        // From the first one, so that the rest of a single spring is not rounded.
        let first = springs().next().map_or(0.0, |spring| spring.rest);
        let moment: f64 = springs().map(|spring| spring.stiffness * (spring.rest - first)).sum();
        let rest = if stiffness > 0.0 { first + moment / stiffness } else { first };
        JointSpring { body, stiffness, damping, rest }
    }

    /// A damper, in words for messages: the first that there is in a joint, beside a joint's spring or between two
    /// points.
    pub(crate) fn first_damper(&self) -> Option<String> {
        let springs = self.parts.joint_springs.iter().filter(|spring| spring.damping > 0.0).map(|spring| spring.body);
        let own = (0..self.bodies.len()).find(|&i| self.bodies[i].joint.damping > 0.0);
        let joint = own.or(springs.min()).map(|i| format!("joint '{}'", self.bodies[i].joint.name));
        let points = || self.parts.point_springs.iter().any(|spring| spring.damping > 0.0);
        joint.or_else(|| points().then(|| "a spring between points".to_string()))
    }
}
