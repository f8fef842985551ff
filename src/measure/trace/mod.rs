//! One traced run of an engine: energy, joint residuals, momentum and positions from the state after every step.

mod figures;
mod follow;
mod probe;
mod running_integral;
pub mod series;
pub mod turn_per_step;
mod work;

pub(crate) use figures::{CORRECTED_ENERGY, ENERGY, POSITION, QUANTITIES, VELOCITY};
pub use figures::{EnergyError, MomentumError, StartDifference, Trace};
pub use follow::{trace, trace_against};
