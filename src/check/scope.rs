//! Which bounds are checked.

use super::requirement::Requirement;

/// Runs of more steps than this are left to the nightly check.
pub const QUICK_STEPS: u64 = 100_000;

/// Which bounds are checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    All,
    /// Those on runs of at most [`QUICK_STEPS`].
    Quick,
}

/// The requirements within a scope, and how many are not.
pub fn scoped(all: Vec<Requirement>, scope: Scope) -> (Vec<Requirement>, usize) {
    let count = all.len();
    let fits = |r: &Requirement| scope == Scope::All || r.horizon.steps <= QUICK_STEPS;
    let kept: Vec<Requirement> = all.into_iter().filter(fits).collect();
    let left_out = count - kept.len();
    (kept, left_out)
}
