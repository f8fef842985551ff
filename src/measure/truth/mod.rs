//! The trajectory that runs are judged by, and the position errors of a run against it.

pub mod accuracy;
mod find;
pub mod sampling;
pub mod trusted;

pub use find::find;
