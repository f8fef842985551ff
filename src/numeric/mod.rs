//! Arithmetic that several layers share and that knows nothing of mechanics.

mod extremes;
pub(crate) mod fit;

pub(crate) use extremes::larger;
