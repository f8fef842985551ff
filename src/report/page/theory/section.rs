//! A section of the page of the theory.

use super::table::Table;
use crate::report::page::document::Picture;

/// What a topic has to tell.
#[derive(Debug)]
pub(crate) struct Section {
    pub title: &'static str,
    /// One sentence with figures.
    pub finding: String,
    /// How the figures were got.
    pub explanation: String,
    /// Charts with the names of their files.
    pub charts: Vec<(String, Picture)>,
    pub tables: Vec<Table>,
}
