//! What is expected of engines, told.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An expectation and what the runs say about it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Expectation {
    pub expected: String,
    pub holds: bool,
    /// The figures, and the reason where it does not hold.
    pub found: String,
}
