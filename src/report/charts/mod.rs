//! The charts, one file each. The only folder that knows plotters.

mod axis;
pub mod broken_bound;
mod canvas;
mod chart;
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

pub use canvas::ChartError;
pub use chart::Chart;

/// All charts, in the order of the page. A new one is one file and one line here.
pub const CHARTS: [Chart; 6] = [
    work_precision::CHART,
    convergence::CHART,
    energy_drift::CHART,
    constraint_violation::CHART,
    error_vs_run_time::CHART,
    structure::CHART,
];
