//! All that the rest of the program asks of an engine.

use std::fmt;

use super::engine::{Engine, Unsupported};
use super::group::Group;
use super::held::Held;
use super::key::{Key, Number};
use super::line_up::{Contestant, Tuned};
use super::swept::Swept;
use super::values::Values;
use crate::mechanics::{Part, System};

/// Builds an engine from its settings for a system and a step size in s.
pub(crate) type Build = fn(&Values, &System, f64) -> Result<Box<dyn Engine>, Unsupported>;

/// Reads back what an engine built so holds of the system before its first step.
pub(crate) type Hold = fn(&Values, &System, f64) -> Result<Held, Unsupported>;

/// An engine in the list.
pub struct Entry {
    /// As in specs.
    pub name: &'static str,
    pub(crate) summary: &'static str,
    pub(crate) keys: &'static [Key],
    /// What of a system beside its tree of bodies the engine has means for.
    pub(crate) parts: &'static [Part],
    /// What it is shown with.
    pub(crate) group: &'static Group,
    /// Its settings with a place in a line-up or in charts.
    pub(crate) contestants: &'static [Contestant],
    /// Where its settings trade accuracy for cost: how the best of them are shown.
    pub(crate) tuned: Option<Tuned>,
    /// The settings that a sweep tries.
    pub(crate) sweep: &'static [Swept],
    /// The key that controls the error where the step of a run only says when the state is read.
    pub(crate) tolerance: Option<&'static Number>,
    /// Nominal time of a step of so many bodies, us: what decides whether a run of `stability` is within its budget.
    pub(crate) nominal_cost: fn(&Values, f64) -> f64,
    /// `None` for engines that compute on the [`System`] itself.
    pub(crate) hold: Option<Hold>,
    /// The spec of the same engine with its constraints solved to the end; `None` where they are.
    pub(crate) converged: fn(&Values) -> Option<String>,
    /// Crates whose versions its results depend on.
    pub(crate) crates: &'static [&'static str],
    pub(crate) build: Build,
}

impl fmt::Debug for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

/// [`Entry::nominal_cost`] of engines that none was fitted to.
pub(super) fn usual_cost(_values: &Values, bodies: f64) -> f64 {
    2.0 + 2.0 * bodies
}

/// [`Entry::converged`] of engines whose settings leave no constraint half solved.
pub(super) fn is_converged(_values: &Values) -> Option<String> {
    None
}
