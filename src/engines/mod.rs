//! What can advance a system: one trait, one list, one file an engine.
//!
//! An engine is named by a [`Spec`] such as `rattle` or `rapier:joints=multibody,precision=f64`, is built for one
//! [`System`] and one step size, and hands out states in the form of [`State`]. It is never asked for its own energy:
//! every figure is computed from its states by `measure`.

mod dop853;
mod explicit_euler;
mod galerkin;
mod joint_coordinates;
pub mod rapier;
mod rattle;
pub mod reference;
mod rk4;
mod semi_implicit_euler;
mod spec;

use std::fmt;

use crate::mechanics::{Part, State, System};

#[doc(hidden)]
pub use rattle::faulty;
pub use spec::{Choice, Key, Number, Spec, SpecError};

/// Something that advances a system by a fixed step.
pub trait Engine {
    /// Advances by one step. After a failure the engine stays at the last state that it reached.
    fn step(&mut self) -> Result<(), StepFailure>;

    /// Writes the present state into `out`, which has as many bodies as the system.
    fn write_state(&self, out: &mut State);

    /// By how much the positions of a state lag behind its velocities, s: the potential energy that goes with the
    /// velocities is the one at `x - lag * v`. Zero for engines whose state belongs to one time.
    fn position_lag_s(&self) -> f64 {
        0.0
    }

    /// Whether the step of the run only says where states are handed out.
    fn chooses_its_steps(&self) -> bool {
        false
    }

    /// Why the figures of the run may mislead although no step has failed, as far as the engine knows.
    fn warning(&self) -> Option<String> {
        None
    }

    /// What a reader of the run should know about how it was done so far, one sentence each.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }
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

/// Builds an engine from its settings for a system and a step size in s.
type Build = fn(&Spec, &System, f64) -> Result<Box<dyn Engine>, Unsupported>;

/// An engine in the list: how it is called, what keys it takes, how it is built.
pub struct Entry {
    pub name: &'static str,
    pub summary: &'static str,
    pub keys: &'static [Key],
    /// What of a system beside its tree of bodies the engine has means for.
    pub parts: &'static [Part],
    build: Build,
}

impl fmt::Debug for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

/// All engines. A new one is one file and one line here.
pub static ENGINES: &[Entry] = &[
    rattle::ENTRY,
    galerkin::ENTRY,
    rapier::ENTRY,
    dop853::ENTRY,
    rk4::ENTRY,
    semi_implicit_euler::ENTRY,
    explicit_euler::ENTRY,
    reference::ENTRY,
];

/// Builds the engine that a spec names for a system, at its initial state, with a step size in s.
///
/// # Errors
/// The engine has no means for something that the system needs.
pub fn build(spec: &Spec, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    if let Some(part) = system.parts.kinds().find(|part| !spec.entry().parts.contains(part)) {
        return Err(Unsupported { engine: spec.to_string(), what: part.name().to_string() });
    }
    (spec.entry().build)(spec, system, step)
}

/// What an engine holds of a system, read back from its own data; `None` for engines that compute on the [`System`]
/// itself, and where the engine cannot be built.
pub fn held(spec: &Spec, system: &System, step: f64) -> Option<rapier::Held> {
    (spec.entry().name == rapier::ENTRY.name).then(|| rapier::hold(spec, system, step).ok()).flatten()
}

/// The same engine with its constraints solved to the end, for engines whose settings leave them half solved.
pub fn converged(spec: &Spec) -> Option<Spec> {
    (spec.entry().name == rapier::ENTRY.name).then(|| rapier::converged(spec)).flatten()
}
