//! What `theory` writes, one file a topic.

mod data;
pub mod energy;
pub mod long_time;
pub mod orders;
pub mod small_steps;

pub(crate) use data::FILE_SCHEMA;
pub use data::{Data, TheoryFile};
