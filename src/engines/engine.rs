//! What advances a system.

use crate::mechanics::State;

/// Something that advances a system by a fixed step, on the thread that calls it: runs are timed by that thread's
/// clock.
pub trait Engine {
    /// Advances by one step. After a failure the engine stays at the last state that it reached.
    fn step(&mut self) -> Result<(), StepFailure>;

    /// Writes the present state into `out`, which has as many bodies as the system.
    fn write_state(&self, out: &mut State);

    /// By how much the time of a state's positions is ahead of that of its velocities, s: the potential energy that
    /// goes with the velocities is the one at `x - lag * v`. Zero for engines whose state belongs to one time.
    fn position_lag_s(&self) -> f64 {
        0.0
    }

    /// Whether the step of the run only says where states are handed out.
    fn chooses_its_steps(&self) -> bool {
        false
    }

    /// What its constraint solver has taken since the start, where it counts.
    fn solver(&self) -> Option<SolverCounters> {
        None
    }

    /// What a reader of the run should know about how it was done so far, one sentence each.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }
}

/// What a constraint solver has taken since the start of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SolverCounters {
    pub solves: u64,
    /// Rounds of the iteration, those of solves that failed included.
    pub rounds: u64,
    /// Factorisations beside the one of each solve.
    pub refactorisations: u64,
    /// Solves that began again from another start.
    pub restarts: u64,
    /// Steps that failed and were taken in halves.
    pub steps_in_halves: u64,
    /// Which rule has ended how many of the solves.
    pub endings: Vec<(&'static str, u64)>,
}

/// Why a step could not be taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepFailure {
    /// The constraint solve did not reach roundoff.
    #[error("{detail}")]
    NotConverged { detail: String },
    /// The state has stopped being a number.
    #[error("{detail}")]
    Diverged { detail: String },
}

/// The engine has no means for something that a system needs.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("engine '{engine}' does not support {what}")]
pub struct Unsupported {
    pub engine: String,
    pub what: String,
}
