//! Topic `long-time`: what all methods, and RK4, conserve over 2000 steps.

use std::sync::atomic::{AtomicU64, Ordering};

use super::topic::{Computed, Conserved, Topic};
use crate::discrete::figures::{long_time_row, runge_kutta_row};
use crate::discrete::methods::METHODS;
use crate::discrete::solve::SolveError;

pub(crate) const TOPIC: Topic = Topic {
    name: "long-time",
    summary: "energy, angular momentum and symplectic form of all methods over 2000 steps",
    work: || METHODS.len() as u64 + 1,
    compute,
};

fn compute(done: &AtomicU64) -> Result<Computed, SolveError> {
    let mut rows = Vec::new();
    for method in METHODS {
        rows.extend(long_time_row(method)?.map(|row| Conserved { row, variational: true }));
        done.fetch_add(1, Ordering::Relaxed);
    }
    rows.push(Conserved { row: runge_kutta_row()?, variational: false });
    done.fetch_add(1, Ordering::Relaxed);
    Ok(Computed::LongTime(rows))
}
