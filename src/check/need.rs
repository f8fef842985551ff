//! What a bound needs to be measured beside a run.

/// What is measured beside a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Need {
    /// Processor time.
    pub timed: bool,
    /// Positions against the truth.
    pub compared: bool,
    /// What a few steps preserve.
    pub examined: bool,
}

impl Need {
    pub(super) fn or(self, other: Need) -> Need {
        Need {
            timed: self.timed || other.timed,
            compared: self.compared || other.compared,
            examined: self.examined || other.examined,
        }
    }
}
