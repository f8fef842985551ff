//! Topic `small-steps`: one step in `(q, v)` against one in positions as `h` goes to 0 (PC section 2.4).

use std::sync::atomic::{AtomicU64, Ordering};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::charts::{ChartError, theory::small_steps};
use super::{Data, Section, Table, Topic};
use crate::discrete::order::problems;
use crate::discrete::solve::SolveError;
use crate::discrete::tangent;
use crate::report::page::document::Picture;
use crate::report::words::number::{short, written};

pub(super) const TOPIC: Topic = Topic {
    name: "small-steps",
    summary: "Patrick and Cuell, section 2.4: steps in (q, v) keep their accuracy down to h = 1e-12 s",
    work: || problems().len() as u64,
    compute,
};

/// Steps from 10^-0.5 to 10^-12 s, two a decade.
const HALF_DECADES: std::ops::RangeInclusive<i32> = 1..=24;

/// One problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SmallStepsRecord {
    pub problem: String,
    pub steps: Vec<SmallStepRecord>,
}

/// Errors of the acceleration from one step of the midpoint rule, m/s^2 or rad/s^2.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SmallStepRecord {
    pub step_s: f64,
    /// From the equations in `(q, v)` divided by `h`.
    pub blown_up: f64,
    /// The same with osculating parabolas for the straight curves.
    pub curved: f64,
    /// From `(q2 - 2 q1 + q0)/h^2`.
    pub position_form: f64,
}

fn compute(done: &AtomicU64) -> Result<Data, SolveError> {
    let steps: Vec<f64> = HALF_DECADES.map(|k| 10f64.powf(-0.5 * f64::from(k))).collect();
    let mut records = Vec::new();
    for problem in problems() {
        let rows = tangent::small_steps(&problem, &steps)?;
        let steps = rows
            .iter()
            .map(|r| SmallStepRecord {
                step_s: r.h,
                blown_up: r.blown_up,
                curved: r.curved,
                position_form: r.position_form,
            })
            .collect();
        records.push(SmallStepsRecord { problem: problem.name.to_string(), steps });
        done.fetch_add(1, Ordering::Relaxed);
    }
    Ok(Data::SmallSteps(records))
}

pub(super) fn section(problems: &[SmallStepsRecord]) -> Result<Section, ChartError> {
    // From here on the position form has nothing but roundoff left.
    let small = || problems.iter().flat_map(|p| &p.steps).filter(|s| s.step_s < 1e-8);
    let worst = small().flat_map(|s| [s.blown_up, s.curved]).fold(0.0, f64::max);
    let position = small().map(|s| s.position_form).fold(f64::INFINITY, f64::min);
    let finding = format!(
        "From steps below 10⁻⁸ s down to 10⁻¹² s the acceleration from a step in (q, v), along straight lines or parabolas, \
         errs by at most {}, that of the position form by at least {}.",
        written(worst),
        written(position)
    );
    let explanation = "One step from the same initial data. In (q, v) the discrete Euler-Lagrange equations are divided by h \
                       before they are put into figures, are regular at h = 0 (the blown-up principle of Patrick and Cuell), \
                       and nothing cancels: for the midpoint rule, whose curves are straight, and for parabolas that \
                       osculate the motion, with two Gauss points. The position form of the midpoint rule has \
                       q₂ − 2q₁ + q₀, whose roundoff is divided by h². All are compared with the acceleration in the middle \
                       of the step, which any of them meets to O(h²)."
        .to_string();
    let caption = "Error of the acceleration from one step against the step size, in (q, v) along straight lines and \
                   parabolas, and in positions";
    let picture = Picture { caption, png: small_steps::draw(problems)? };
    Ok(Section {
        title: "Small steps: the blown-up principle of Patrick and Cuell",
        finding,
        explanation,
        charts: vec![("small-steps.png".to_string(), picture)],
        tables: problems.iter().map(table).collect(),
    })
}

fn table(problem: &SmallStepsRecord) -> Table {
    let whole_decades = problem.steps.iter().skip(1).step_by(2);
    Table {
        caption: format!("Error of the acceleration on the {}.", problem.problem),
        headings: vec!["step, s", "(q, v), straight", "(q, v), parabolas", "positions"],
        rows: whole_decades.map(|s| [s.step_s, s.blown_up, s.curved, s.position_form].map(short).to_vec()).collect(),
    }
}
