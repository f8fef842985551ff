//! Topic `small-steps`: one step in `(q, v)` against one in positions as `h` goes to 0 (PC section 2.4).

use std::sync::atomic::{AtomicU64, Ordering};

use super::topic::{Computed, ProblemSteps, Topic};
use crate::discrete::order::problems;
use crate::discrete::solve::SolveError;
use crate::discrete::tangent;

pub(crate) const TOPIC: Topic = Topic {
    name: "small-steps",
    summary: "Patrick and Cuell, section 2.4: steps in (q, v) keep their accuracy down to h = 1e-12 s",
    work: || problems().len() as u64,
    compute,
};

/// Steps from 10^-0.5 to 10^-12 s, two a decade.
const HALF_DECADES: std::ops::RangeInclusive<i32> = 1..=24;

fn compute(done: &AtomicU64) -> Result<Computed, SolveError> {
    let steps: Vec<f64> = HALF_DECADES.map(|k| 10f64.powf(-0.5 * f64::from(k))).collect();
    let mut found = Vec::new();
    for problem in problems() {
        found.push(ProblemSteps { problem: problem.name, steps: tangent::small_steps(&problem, &steps)? });
        done.fetch_add(1, Ordering::Relaxed);
    }
    Ok(Computed::SmallSteps(found))
}
