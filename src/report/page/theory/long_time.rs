//! The section of topic `long-time`.

use super::section::Section;
use super::table::Table;
use crate::report::charts::{ChartError, theory::long_time};
use crate::report::page::document::Picture;
use crate::report::record::theory::long_time::LongTimeRecord;
use crate::report::words::number::{short, written};

pub(super) fn section(rows: &[LongTimeRecord]) -> Result<Section, ChartError> {
    let worst = |variational: bool, of: fn(&LongTimeRecord) -> f64| {
        written(rows.iter().filter(|r| r.variational == variational).map(of).fold(0.0, f64::max))
    };
    let finding = format!(
        "All {} variational methods hold the angular momentum to {} and the symplectic form to {}; RK4 errs there by \
         {} and {}. The ratio of energy drift to largest energy error is at most {} for them and {} for RK4.",
        rows.iter().filter(|r| r.variational).count(),
        worst(true, |r| r.momentum_error),
        worst(true, |r| r.symplecticity_defect),
        worst(false, |r| r.momentum_error),
        worst(false, |r| r.symplecticity_defect),
        worst(true, relative_drift),
        worst(false, relative_drift),
    );
    let length = rows.first().map(|r| format!("{} steps of {} s", r.steps, r.step_s)).unwrap_or_default();
    let explanation = format!(
        "The particle of figure 1, {length}. Energy error: the largest |H − H₀|, J. Energy drift: the slope of a \
         straight line through H − H₀ times the length of the run, J. Momentum: the largest error of the angular \
         momentum, kg m²/s. Form: the largest entry of AᵀJA − J for the derivative A of one step at the end of \
         the run, by differences whose roundoff is about 10⁻¹². The initial energy is 0.37 J and the angular \
         momentum 0.72 kg m²/s."
    );
    let caption = "Energy error, energy drift, momentum error and symplecticity defect of all methods and of RK4 after \
                   a long run";
    let picture = Picture { caption, png: long_time::draw(rows)? };
    let table = Table {
        caption: format!("After {length}."),
        headings: vec!["method", "energy error, J", "energy drift, J", "momentum error, kg m²/s", "form defect"],
        rows: rows
            .iter()
            .map(|r| {
                let figures = [r.energy_error_j, r.energy_drift_j, r.momentum_error, r.symplecticity_defect];
                std::iter::once(r.method.clone()).chain(figures.map(short)).collect()
            })
            .collect(),
    };
    Ok(Section {
        title: "Long times: energy, momentum and symplectic form",
        finding,
        explanation,
        charts: vec![("long-time.png".to_string(), picture)],
        tables: vec![table],
    })
}

/// Drift over the largest error, for errors above roundoff.
fn relative_drift(row: &LongTimeRecord) -> f64 {
    row.energy_drift_j / (row.energy_error_j + 1e-12)
}
