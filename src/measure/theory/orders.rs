//! Topic `orders`: measured orders of all methods (MW 2.3, PC section 4).

use std::sync::atomic::{AtomicU64, Ordering};

use super::topic::{Computed, ProblemOrders, Topic};
use crate::discrete::methods::METHODS;
use crate::discrete::order::{order_row, problems};
use crate::discrete::solve::SolveError;
use crate::measure::threads;

pub(crate) const TOPIC: Topic = Topic {
    name: "orders",
    summary: "measured orders of L_d, F-, F+ and the map of every method against theory",
    work: || (METHODS.len() * problems().len()) as u64,
    compute,
};

/// Rows are independent: as many threads as there are cores take one after the other.
fn compute(done: &AtomicU64) -> Result<Computed, SolveError> {
    let problems = problems();
    let tasks: Vec<usize> = (0..METHODS.len() * problems.len()).collect();
    let rows = threads::map(threads::cores(), tasks.len(), &tasks, |task| {
        let row = order_row(&METHODS[task % METHODS.len()], &problems[task / METHODS.len()]);
        done.fetch_add(1, Ordering::Relaxed);
        Some(row)
    });
    let mut found: Vec<ProblemOrders> =
        problems.iter().map(|p| ProblemOrders { problem: p.name, methods: Vec::new() }).collect();
    for (task, row) in rows.into_iter().enumerate() {
        if let Some(row) = row {
            found[task / METHODS.len()].methods.extend(row?);
        }
    }
    Ok(Computed::Orders(found))
}
