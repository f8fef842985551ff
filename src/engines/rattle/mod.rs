//! The variational RATTLE core as an engine.

mod build;
mod engine;
mod entry;
mod explain;
mod fits;
mod messages;
mod remarks;
mod settings;

pub(super) use build::faulty;
pub(super) use entry::ENTRY;
