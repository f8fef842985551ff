//! Maps that advance a state by a step: RATTLE, its relatives, and what is made of them.

use super::rattle::{Failure, Rattle};
use crate::mechanics::State;

/// A map from the state at one time to that a step later.
pub trait Map: Clone {
    /// Whether a step that fails leaves the state before it (that after it where it ends in a singular configuration).
    /// Otherwise it may be any state on the way.
    const STAYS_ON_FAILURE: bool;

    /// Takes one step of size `h` (s), backwards where that is negative.
    ///
    /// # Errors
    /// See [`Failure`].
    fn step(&mut self, h: f64) -> Result<(), Failure>;

    /// Writes the present state.
    fn write_state(&self, out: &mut State);

    /// The RATTLE map that takes the steps, for what it knows of the motion; `None` where another one does.
    fn rattle(&self) -> Option<&Rattle>;

    /// A copy at the start of the step of size `h` (s) that has just failed, as near as the map is reversible; `None`
    /// where it cannot go back.
    fn before_failure(&self, h: f64) -> Option<Self>;

    /// The step that is next in a sequence of the map's own; `None` where it takes those that are asked for.
    fn own_step(&self) -> Option<OwnStep>;
}

/// A step of a map that chooses its own.
#[derive(Clone, Copy, Debug)]
pub struct OwnStep {
    /// Where it begins, s.
    pub time: f64,
    /// s
    pub size: f64,
}

impl Map for Rattle {
    const STAYS_ON_FAILURE: bool = true;

    fn step(&mut self, h: f64) -> Result<(), Failure> {
        Rattle::step(self, h)
    }

    fn write_state(&self, out: &mut State) {
        Rattle::write_state(self, out);
    }

    fn rattle(&self) -> Option<&Rattle> {
        Some(self)
    }

    fn before_failure(&self, _h: f64) -> Option<Rattle> {
        Some(self.clone())
    }

    fn own_step(&self) -> Option<OwnStep> {
        None
    }
}
