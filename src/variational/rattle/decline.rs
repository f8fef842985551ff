//! What the rounds of the constraint iteration leave, also where roundoff hides it.
//!
//! A measured residual ceases to decrease at the roundoff of the motions. Behind that noise, what the corrections leave goes on
//! decreasing as it did above. It has to be followed down, because it has the same sign for many steps and the energy drifts by it:
//! where it was left at a hundredth of roundoff, a chain of three links at order 8 and 4 ms lost 5.9e-21 +- 6e-22 of its energy
//! scale a solve.

/// Residuals that are so few times the estimated roundoff of the motions are mostly roundoff.
const HIDDEN: f64 = 4.0;

/// Stagnation is one of roundoff where the residual is at most so many times the estimate, by the chord iteration and by the exact
/// linearisation, which stops contracting at roundoff only.
const STAGNANT: (f64, f64) = (64.0, 1e4);

/// No round is taken to leave more than this part of a residual.
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
    pub rate: f64,
    /// Whether that was seen in this step, above roundoff.
    seen: bool,
    hidden: bool,
    /// The estimate of the roundoff, m.
    roundoff: f64,
}

impl Decline {
    /// `rate` is a guess, used where nothing better is seen.
    pub(super) fn new(rate: f64) -> Decline {
        let none = f64::INFINITY;
        Decline {
            measured: none,
            before: none,
            left: none,
            rate: rate.min(SLOWEST),
            seen: false,
            hidden: false,
            roundoff: 0.0,
        }
    }

    /// Takes in the residual of another round.
    pub(super) fn follow(&mut self, measured: f64, roundoff: f64, exact: bool) {
        let falls = self.measured.is_finite() && !self.hidden;
        let rate = if falls { (measured / self.measured).min(SLOWEST) } else { self.rate };
        let near = if exact { STAGNANT.1 } else { STAGNANT.0 };
        let stagnant = (self.hidden || measured > 0.5 * self.measured) && measured <= near * roundoff;
        self.hidden = measured <= HIDDEN * roundoff || stagnant;
        if self.hidden {
            // Roundoff makes a residual no smaller.
            self.rate = rate.min(self.rate);
            self.left = measured.min(self.rate * self.left);
        } else {
            (self.rate, self.left) = (rate, measured);
            self.seen |= falls;
        }
        (self.before, self.measured, self.roundoff) = (self.measured, measured, roundoff);
    }

    /// Whether the rate is one of this step, seen above roundoff.
    pub(super) fn seen(&self) -> bool {
        self.seen
    }

    /// Whether the next residual may be one of roundoff.
    pub(super) fn may_end(&self) -> bool {
        self.rate * self.left <= HIDDEN * self.roundoff
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of rounds after which one more leaves 1e-4 of a roundoff of 1e-17 m, with residuals that fall from 1e-9 m by `rate` a
    /// round down to a noise.
    fn rounds(rate: f64, noise: f64, guess: f64) -> usize {
        let mut decline = Decline::new(guess);
        let residual = |round: i32| 1e-9 * rate.powi(round) + noise * (1.0 + 0.3 * f64::from(round).sin());
        (0..60)
            .position(|round| {
                decline.follow(residual(round), 1e-17, false);
                decline.ends(1.1e-21)
            })
            .unwrap()
    }

    #[test]
    fn residuals_are_followed_down_as_they_fell_above_roundoff() {
        for guess in [1e-6, f64::INFINITY] {
            // 1e-9 rate^(n + 1) <= 1e-21 from n = 11, 5 and 3 on.
            assert_eq!(rounds(0.1, 1e-18, guess), 11);
            assert_eq!(rounds(0.01, 1e-18, guess), 5);
            assert_eq!(rounds(0.001, 1e-18, guess), 3);
        }
        // Where roundoff is underestimated it looks like a slower fall.
        assert_eq!(rounds(0.01, 1e-16, f64::INFINITY), 8);
    }

    #[test]
    fn a_residual_that_starts_at_roundoff_falls_as_in_the_step_before() {
        let rounds = |guess| {
            let mut decline = Decline::new(guess);
            (0..60).position(|_| {
                decline.follow(1e-18, 1e-17, false);
                decline.ends(1.1e-21)
            })
        };
        assert_eq!(rounds(1e-3), Some(0));
        assert_eq!(rounds(1e-2), Some(1));
        assert_eq!(rounds(f64::INFINITY), Some(9));
    }

    #[test]
    fn what_does_not_fall_does_not_end_far_above_roundoff() {
        let mut decline = Decline::new(1e-3);
        for _ in 0..20 {
            decline.follow(1e-15, 1e-17, false);
            assert!(!decline.ends(1e-21) && !decline.hidden());
        }
        assert!(decline.left_more_than(0.9));
        decline.follow(1e-15, 1e-17, true);
        assert!(decline.hidden(), "but that is the roundoff of the exact linearisation");
    }
}
