//! The integrator: RATTLE for rigid bodies on the constraint manifold of their joints.
//!
//! | file | is |
//! | --- | --- |
//! | `step` | the map, (1) to (5) |
//! | `state` | the parts of the integrator; `start` makes them |
//! | `kick`, `project` | half kicks, and the second with its projection; `attitude` adds up turns |
//! | `parts` | springs, dampers, drives, loops; `light` bodies with next to no inertia |
//! | `switching` | which rule a body turns by |
//! | `energy`, `node`, `figures` | what others ask of it |
//! | `failure` | why a step could not be taken |

mod attitude;
mod energy;
pub(super) mod failure;
mod figures;
pub(super) mod kick;
mod light;
mod node;
mod parts;
pub(super) mod project;
mod start;
pub(super) mod state;
mod step;
mod switching;

pub(super) use attitude::{norm_defect, turn_less_one};
pub use failure::Failure;
pub(super) use project::{RETURN, world_inertia};
pub use state::Rattle;
pub(super) use state::{Body, bodies};
