//! What the constraint solver of an engine took.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::engines::SolverCounters;

/// What the constraint solver took over the run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Solver {
    pub solves: u64,
    /// Rounds of the iteration, those of solves that failed included.
    pub rounds: u64,
    /// Factorisations beside the one of each solve.
    pub refactorisations: u64,
    /// Solves that began again from another start.
    pub restarts: u64,
    /// Steps that failed and were taken in halves.
    pub steps_in_halves: u64,
    /// How many solves each rule has ended.
    pub endings: BTreeMap<String, u64>,
}

impl From<&SolverCounters> for Solver {
    fn from(counters: &SolverCounters) -> Solver {
        let endings = counters.endings.iter().filter(|(_, count)| *count > 0);
        Solver {
            solves: counters.solves,
            rounds: counters.rounds,
            refactorisations: counters.refactorisations,
            restarts: counters.restarts,
            steps_in_halves: counters.steps_in_halves,
            endings: endings.map(|(rule, count)| (rule.to_string(), *count)).collect(),
        }
    }
}
