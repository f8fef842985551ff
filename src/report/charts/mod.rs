//! The charts, one file each. The only folder that knows plotters.

mod axis;
pub mod broken_bound;
mod canvas;
mod constraint_violation;
mod convergence;
pub mod cost;
mod energy_drift;
mod error_vs_run_time;
mod legend;
mod panel;
pub mod stability_map;
mod structure;
mod style;
pub mod theory;
mod time_panels;
mod work_precision;

use super::Report;

pub use canvas::ChartError;

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

/// All charts, in the order of the page. A new one is one file and one line here.
pub const CHARTS: [Chart; 6] = [
    work_precision::CHART,
    convergence::CHART,
    energy_drift::CHART,
    constraint_violation::CHART,
    error_vs_run_time::CHART,
    structure::CHART,
];
