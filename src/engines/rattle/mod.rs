//! The variational RATTLE core as an engine.

mod build;
mod engine;
mod explain;
mod fits;
mod messages;
mod remarks;
mod settings;

pub(super) use build::ENTRY;
pub use build::faulty;
