//! A run with all that was measured in it.

use super::Horizon;
use super::cost::clock::Timing;
use super::outcome::Outcome;
use super::structure::Structure;
use super::trace::Trace;
use crate::engines::Spec;

/// One engine at one step size.
#[derive(Clone, Debug)]
pub struct Run {
    pub engine: Spec,
    pub horizon: Horizon,
    pub trace: Trace,
    pub structure: Option<Structure>,
    pub timing: Option<Timing>,
}

impl Run {
    fn completed(&self) -> bool {
        matches!(self.trace.outcome, Outcome::Completed)
    }

    /// Largest joint position error of a completed run, rad or m.
    pub(crate) fn joint_error(&self) -> Option<f64> {
        self.trace.accuracy.as_ref().filter(|_| self.completed()).map(|accuracy| accuracy.joint.max)
    }

    /// Processor seconds a simulated second of a completed run, from the lower decile over the rounds.
    pub fn cost(&self) -> Option<f64> {
        self.timing.filter(|_| self.completed()).map(|timing| timing.low / self.horizon.step)
    }
}
