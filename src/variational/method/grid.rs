//! What maps with steps of their own share: the last grid point of their sequence, and output between two grid points.

use crate::mechanics::State;
use crate::variational::rattle::{Failure, Rattle};

/// The last grid point, and the state at the time of the output: that of a step to it from a copy of the grid point, so
/// that the sequence of grid points does not depend on when output is asked for.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    pub last: Rattle,
    output: Rattle,
}

impl Grid {
    pub(super) fn starting_at(rattle: Rattle) -> Grid {
        Grid { output: rattle.clone(), last: rattle }
    }

    /// Time of the output, s.
    pub(super) fn output_time(&self) -> f64 {
        self.output.time()
    }

    /// Makes the output at a time (s) that is nearer than the next grid point, a `step` (s) from the last.
    pub(super) fn make_output(&mut self, time: f64, step: f64) -> Result<(), Failure> {
        let rest = time - self.last.time();
        if rest.is_nan() || step.is_nan() {
            return Err(Failure::Stalled { step });
        }
        self.output.copy_from(&self.last)?;
        if rest == 0.0 { Ok(()) } else { self.output.step(rest) }
    }

    /// Writes the state at the time of the output.
    pub(super) fn write_output(&self, out: &mut State) {
        self.output.write_state(out);
    }
}
