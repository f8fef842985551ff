//! Why a figure could not be had.

use crate::mechanics::{State, System};

/// Why a figure could not be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    #[error("{0}")]
    Step(String),
    #[error("with dampers the exact motion is neither symplectic nor reversible")]
    Dampers,
    #[error("with drives that change in time the exact motion is not reversible")]
    Drives,
    #[error("the loops cannot be closed as far from the state as the differences reach")]
    Open,
    #[error("a step led to a state that is not a number")]
    NotFinite,
    #[error("the mass matrix of the joint coordinates is not positive")]
    Singular,
    #[error(
        "the structure of the steps took longer than its budget of {budget_s} s on the wall clock; allow more with \
         --budget"
    )]
    OverBudget { budget_s: f64 },
    #[error("interrupted")]
    Interrupted,
}

/// A map of states: takes the initial state of a system to the state that follows.
pub type StateMap<'a> = dyn Fn(&System) -> Result<State, Failure> + 'a;
