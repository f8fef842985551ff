//! What a topic of the theory is, and what it computes.

use std::sync::atomic::AtomicU64;

use super::long_time::Conserved;
use super::orders::ProblemOrders;
use super::small_steps::ProblemSteps;
use crate::discrete::figures::EnergyFigure;
use crate::discrete::solve::SolveError;

/// Something that the theory says and that is computed here.
pub struct Topic {
    pub name: &'static str,
    pub summary: &'static str,
    /// Units of work that `compute` counts.
    pub work: fn() -> u64,
    pub compute: fn(&AtomicU64) -> Result<Computed, SolveError>,
}

/// What a topic computes.
pub enum Computed {
    Orders(Vec<ProblemOrders>),
    Energy(EnergyFigure),
    LongTime(Vec<Conserved>),
    SmallSteps(Vec<ProblemSteps>),
}
