//! Folders of records, charts and pages. Files are written whole or not at all.

pub(crate) mod cells;
pub(crate) mod cost;
pub(crate) mod files;
pub(crate) mod report;
pub(crate) mod stability;
pub(crate) mod theory;
