//! The engines in joint coordinates and the reference, against closed forms and against the core.

mod closed_forms;
#[path = "../common/mod.rs"]
mod common;
mod reduced;
mod reference;
mod reference_parts;
