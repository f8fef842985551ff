//! How a run ends.

use std::sync::atomic::{AtomicBool, AtomicU64};
use std::time::Duration;

/// A relative energy error from which on a run counts as diverged.
pub(crate) const DIVERGED: f64 = 1e6;

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    Completed,
    /// The state stopped being a number, or its energy passed `DIVERGED` energy scales.
    Diverged {
        detail: String,
    },
    /// A step could not be solved.
    NotConverged {
        detail: String,
    },
    /// The engine has no means for something in the scene.
    Unsupported {
        detail: String,
    },
    /// The run took longer than it may, on the wall clock.
    OverBudget {
        detail: String,
    },
}

/// What stops a run before its end, and who is told how far it is.
#[derive(Clone, Copy, Debug)]
pub struct Limits<'a> {
    /// Wall-clock time that a run may take.
    pub budget: Duration,
    /// Set from outside to end the run without a result.
    pub interrupted: &'a AtomicBool,
    /// Counts the steps taken, for a progress bar.
    pub taken: &'a AtomicU64,
}
