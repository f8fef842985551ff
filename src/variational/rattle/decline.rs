//! What the rounds of the constraint iteration leave, also where roundoff hides it.
//!
//! A measured residual ceases to decrease at the roundoff of the motions. What the corrections leave behind that noise goes on
//! decreasing as it did above, and it must be followed down: it has the same sign for many steps, so the energy drifts by
//! it. Rounds that ended at a hundredth of roundoff gave a chain of three links at order 8 and 4 ms a mean of -5.9e-21 +- 6e-22 of its energy
//! scale a solve.

/// Residuals that are so few times the estimated roundoff of the motions are mostly roundoff.
const HIDDEN: f64 = 4.0;

/// Stagnation is one of roundoff where the residual is at most so many times the estimate, by the chord iteration and by the exact
/// linearisation, which stops contracting at roundoff only.
const STAGNANT: (f64, f64) = (64.0, 1e4);

/// Rates that are never seen, because one round goes down to roundoff or the iteration is given up, are taken for no higher.
const SLOWEST: f64 = 0.5;

/// The residuals of the rounds of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Decline {
    /// The last one as measured, m.
    measured: f64,
    /// The one before that.
    before: f64,
    /// What the last one is without roundoff, m.
    left: f64,
    /// The part of it that a round leaves.
    rate: f64,
    hidden: bool,
}

impl Decline {
    /// `rate` is a guess, used where nothing better is seen.
    pub(super) fn new(rate: f64) -> Decline {
        let none = f64::INFINITY;
        Decline { measured: none, before: none, left: none, rate: rate.min(SLOWEST), hidden: false }
    }

    /// Takes in the residual of another round.
    pub(super) fn follow(&mut self, measured: f64, roundoff: f64, exact: bool) {
        let seen = self.measured.is_finite() && !self.hidden;
        let rate = if seen { (measured / self.measured).min(SLOWEST) } else { self.rate };
        let near = if exact { STAGNANT.1 } else { STAGNANT.0 };
        let stagnant = (self.hidden || measured > 0.5 * self.measured) && measured <= near * roundoff;
        self.hidden = measured <= HIDDEN * roundoff || stagnant;
        if self.hidden {
            // Roundoff makes a residual no smaller.
            self.rate = rate.min(self.rate);
            self.left = measured.min(self.rate * self.left);
        } else {
            (self.rate, self.left) = (rate, measured);
        }
        (self.before, self.measured) = (self.measured, measured);
    }

    /// The rate, where it is not that of an earlier step or of roundoff.
    pub(super) fn seen(&self) -> Option<f64> {
        (!self.hidden && self.before.is_finite()).then_some(self.rate)
    }

    /// Takes in what another part of the system has left.
    pub(super) fn join(&mut self, residual: f64) {
        self.measured = self.measured.max(residual);
        self.left = self.left.max(residual);
    }

    /// Whether the last residual is roundoff for the most part.
    pub(super) fn hidden(&self) -> bool {
        self.hidden
    }

    /// Whether another round leaves at most `negligible`, m.
    pub(super) fn ends(&self, negligible: f64) -> bool {
        self.hidden && self.rate * self.left <= negligible
    }

    /// Whether the last round left more than a part of the residual, apart from roundoff.
    pub(super) fn left_more_than(&self, part: f64) -> bool {
        !self.hidden && self.measured > part * self.before
    }
}
