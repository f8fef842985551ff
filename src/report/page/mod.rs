//! Pages: one file without links to others, readable from a disk and without a network.

pub mod cost;
pub mod document;
pub mod report;
pub mod stability;
pub mod theory;
