//! A run with all that was measured in it.

use super::Horizon;
use super::cost::clock::Timing;
use super::structure::Structure;
use super::trace::Trace;
use crate::engines::Spec;

/// One engine at one step size.
#[derive(Clone, Debug)]
pub struct Run {
    pub engine: Spec,
    pub horizon: Horizon,
    pub trace: Trace,
    pub structure: Option<Structure>,
    pub timing: Option<Timing>,
}
