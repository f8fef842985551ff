//! Arithmetic that several layers share and that knows nothing of mechanics.

mod compensated;
mod extremes;
pub(crate) mod fit;

pub(crate) use compensated::{Compensated, Compensated3, CompensatedVec};
pub(crate) use extremes::larger;
