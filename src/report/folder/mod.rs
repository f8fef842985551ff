//! Folders of records, charts and pages. Files are written whole or not at all.

pub mod cells;
pub mod cost;
pub mod files;
pub mod report;
pub mod stability;
pub mod theory;
