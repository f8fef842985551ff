//! What a topic of the theory is, and what it computes.

use std::sync::atomic::AtomicU64;

use crate::discrete::figures::{EnergyFigure, LongTimeRow};
use crate::discrete::order::OrderRow;
use crate::discrete::solve::SolveError;
use crate::discrete::tangent::SmallStep;

/// Something that the theory says and that is computed here.
pub(crate) struct Topic {
    pub name: &'static str,
    pub summary: &'static str,
    /// Units of work that `compute` counts.
    pub work: fn() -> u64,
    pub compute: fn(&AtomicU64) -> Result<Computed, SolveError>,
}

/// What a topic computes.
pub(crate) enum Computed {
    Orders(Vec<ProblemOrders>),
    Energy(EnergyFigure),
    LongTime(Vec<Conserved>),
    SmallSteps(Vec<ProblemSteps>),
}

/// What one method conserves.
pub(crate) struct Conserved {
    pub row: LongTimeRow,
    pub variational: bool,
}

/// All methods on one problem, but for those that cannot be used there.
pub(crate) struct ProblemOrders {
    pub problem: &'static str,
    pub methods: Vec<OrderRow>,
}

/// Errors on one problem, step by step.
pub(crate) struct ProblemSteps {
    pub problem: &'static str,
    pub steps: Vec<SmallStep>,
}
