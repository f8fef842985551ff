//! What can advance a system: one trait, one list, one file an engine.
//!
//! An engine is named by a [`Spec`] such as `rattle` or `rapier:joints=multibody,precision=f64`, is built for one
//! [`System`](crate::mechanics::System) and one step size, and hands out states in the form of
//! [`State`](crate::mechanics::State). It is never asked for its own energy: every figure is computed from its states
//! by `measure`. What the rest of the program asks of an engine (keys, line-ups, sweep, colours, cost, parity) stands
//! in its [`Entry`].

mod dop853;
mod dormand_prince;
mod engine;
mod entry;
mod explicit_euler;
mod galerkin;
mod group;
mod held;
mod joint_coordinates;
mod key;
mod line_up;
mod list;
mod rapier;
mod rattle;
pub mod reference;
mod rk4;
mod semi_implicit_euler;
mod spec;
pub(crate) mod swept;
mod values;

pub use engine::{Engine, SolverCounters, StepFailure, Unsupported};
pub use entry::Entry;
pub(crate) use group::Origin;
pub use held::{Held, HeldBody};
pub(crate) use key::Key;
pub use line_up::Role;
pub(crate) use line_up::{Colour, Marker};
pub use list::{ENGINES, line_up};
pub(crate) use list::{group_of, groups, look_of, sweep, tolerance, tuned};
pub(crate) use spec::converged;
#[doc(hidden)]
pub use spec::faulty;
pub use spec::{Spec, SpecError, build, held};
