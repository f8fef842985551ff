//! Why a step could not be taken.

/// Why a step could not be taken; the integrator stays where it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The rounds did not reach roundoff, nor did Newton's method; the last correction of the rounds in units of the
    /// velocities that hold the scene's energy.
    NotConverged { rounds: usize, correction: f64 },
    /// After these rounds the stages were no numbers any more, and Newton's method found none either.
    RanAway { rounds: usize },
    /// A joint can move without moving any mass, or the stages ran away before the first round.
    Singular,
}
