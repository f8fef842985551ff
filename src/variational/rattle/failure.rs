//! Why a step could not be taken.

/// Why a step could not be taken. Bodies and joints are named by the index of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The body turns too far in one step for the rotation rule to have a solution.
    Rotation { body: usize, angle: f64 },
    /// The constraint iteration stopped contracting.
    Constraint { joint: usize, rounds: usize, residual: f64 },
    /// A loop, coupling or spring does not close, or cannot: the index among loops, then couplings, then springs.
    Loop { index: usize, rounds: usize, residual: f64 },
    /// The step would go to another solution of its equations, with this part of the kinetic energy from nowhere: near
    /// a singular configuration of a linkage, or with `h |Omega|` near 1.
    Leap { gained: f64 },
    /// An adaptive step (s) has become too short for the time to advance.
    Stalled { step: f64 },
    /// No step keeps the discrete energy (J) of [`super::super::EnergyMomentum`]; the nearest that was tried (s) misses
    /// it by `missed`, J.
    NoStep { step: f64, energy: f64, missed: f64 },
    /// A joint can move without moving any mass.
    Singular { joint: usize },
    /// A body's state stopped being a number.
    NotFinite { body: usize },
}

/// Where a step is farthest from closed: a joint, by its body, or a bond.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) enum Open {
    Joint(usize),
    Loop(usize),
}

impl Open {
    pub(in crate::variational) fn failure(self, rounds: usize, residual: f64) -> Failure {
        match self {
            Open::Joint(joint) => Failure::Constraint { joint, rounds, residual },
            Open::Loop(index) => Failure::Loop { index, rounds, residual },
        }
    }
}
