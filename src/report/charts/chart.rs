//! What a chart of a report is.

use super::canvas::ChartError;
use crate::report::record::report::Report;

/// A chart of a report.
#[derive(Debug)]
pub struct Chart {
    /// Name of the file, without the folder.
    pub file: &'static str,
    /// What it shows, for readers who cannot see it.
    pub caption: &'static str,
    /// Draws it as PNG; `None` where the report has nothing to show in it.
    pub draw: fn(&Report) -> Result<Option<Vec<u8>>, ChartError>,
}
