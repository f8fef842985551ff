//! Topic `long-time`: what all methods, and RK4, conserve over 2000 steps.

use std::sync::atomic::{AtomicU64, Ordering};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::charts::{ChartError, theory::long_time};
use super::{Data, Section, Table, Topic};
use crate::discrete::figures::{LongTimeRow, long_time_row, runge_kutta_row};
use crate::discrete::methods::METHODS;
use crate::discrete::solve::SolveError;
use crate::report::page::document::Picture;
use crate::report::words::number::{short, written};

pub(super) const TOPIC: Topic = Topic {
    name: "long-time",
    summary: "energy, angular momentum and symplectic form of all methods over 2000 steps",
    work: || METHODS.len() as u64 + 1,
    compute,
};

/// What one method conserves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LongTimeRecord {
    pub method: String,
    pub variational: bool,
    pub step_s: f64,
    pub steps: usize,
    /// Largest |H − H₀|.
    #[serde(rename = "energy_error_J")]
    pub energy_error_j: f64,
    /// The slope of the energy error times the length of the run.
    #[serde(rename = "energy_drift_J")]
    pub energy_drift_j: f64,
    /// Largest error of the angular momentum, kg m²/s.
    pub momentum_error: f64,
    /// Largest entry of AᵀJA − J for the derivative A of one step.
    pub symplecticity_defect: f64,
}

impl LongTimeRecord {
    fn new(row: &LongTimeRow, variational: bool) -> LongTimeRecord {
        LongTimeRecord {
            method: row.method.to_string(),
            variational,
            step_s: row.step,
            steps: row.steps,
            energy_error_j: row.energy_error,
            energy_drift_j: row.energy_slope.abs() * row.step * row.steps as f64,
            momentum_error: row.momentum_error,
            symplecticity_defect: row.symplecticity_defect,
        }
    }
}

fn compute(done: &AtomicU64) -> Result<Data, SolveError> {
    let mut rows = Vec::new();
    for method in METHODS {
        rows.extend(long_time_row(method)?.map(|row| LongTimeRecord::new(&row, true)));
        done.fetch_add(1, Ordering::Relaxed);
    }
    rows.push(LongTimeRecord::new(&runge_kutta_row()?, false));
    done.fetch_add(1, Ordering::Relaxed);
    Ok(Data::LongTime(rows))
}

pub(super) fn section(rows: &[LongTimeRecord]) -> Result<Section, ChartError> {
    let worst = |variational: bool, of: fn(&LongTimeRecord) -> f64| {
        written(rows.iter().filter(|r| r.variational == variational).map(of).fold(0.0, f64::max))
    };
    let finding = format!(
        "All {} variational methods hold the angular momentum to {} and the symplectic form to {}; RK4 errs there by {} and \
         {}. The ratio of energy drift to largest energy error is at most {} for them and {} for RK4.",
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
        "The particle of figure 1, {length}. Energy error: the largest |H − H₀|, J. Energy drift: the slope of a straight \
         line through H − H₀ times the length of the run, J. Momentum: the largest error of the angular momentum, kg m²/s. \
         Form: the largest entry of AᵀJA − J for the derivative A of one step at the end of the run, by differences whose \
         roundoff is about 10⁻¹². The initial energy is 0.37 J and the angular momentum 0.72 kg m²/s."
    );
    let caption = "Energy error, energy drift, momentum error and symplecticity defect of all methods and of RK4 after a \
                   long run";
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
