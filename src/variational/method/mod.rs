//! Maps of one step made of RATTLE, and its relatives.

pub mod adaptive;
#[allow(clippy::excessive_precision, reason = "weights with all the digits that were published")]
pub mod composition;
pub mod energy_momentum;
mod facts;
pub mod lobatto;
mod nodes;
mod relatives;
pub mod substep;

pub use facts::{Facts, Kind, METHODS, Order, Refuses, Steps};
pub use relatives::Method;
