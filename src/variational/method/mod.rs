//! Maps of one step beside RATTLE, and what is made of them.
//!
//! | file | is |
//! | --- | --- |
//! | `facts` | one row of facts a method: what refusals, help and documentation read |
//! | `relatives` | where RATTLE's relatives let the forces act |
//! | `composition` | weights of high order, and the map composed by them |
//! | `lobatto` | Lobatto IIIA-IIIB |
//! | `adaptive`, `energy_momentum` | steps of their own, on a `grid` |
//! | `substep` | a step that fails in halves |

pub mod adaptive;
#[allow(clippy::excessive_precision, reason = "weights with all the digits that were published")]
pub mod composition;
pub mod energy_momentum;
mod facts;
mod grid;
pub mod lobatto;
mod relatives;
pub mod substep;

pub use facts::{Facts, Kind, METHODS, Order, Refuses, Steps};
pub use relatives::Method;
