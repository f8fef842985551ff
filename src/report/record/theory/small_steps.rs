//! Errors of single steps as they shrink.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::discrete::tangent::SmallStep;
use crate::measure::theory::ProblemSteps;

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

impl SmallStepsRecord {
    pub(super) fn new(found: &ProblemSteps) -> SmallStepsRecord {
        let step = |row: &SmallStep| SmallStepRecord {
            step_s: row.h,
            blown_up: row.blown_up,
            curved: row.curved,
            position_form: row.position_form,
        };
        SmallStepsRecord { problem: found.problem.to_string(), steps: found.steps.iter().map(step).collect() }
    }
}
