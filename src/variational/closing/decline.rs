//! What the rounds of the constraint iteration leave below roundoff.
//!
//! A measured residual ceases to decrease at the roundoff of the motions. Behind that noise, what the corrections leave
//! goes on decreasing as it did above. It comes from the extrapolated wrenches and so depends on where the motion comes
//! from: it has the same sign for many steps, both ways of a swing, and the energy drifts by it. Roundoff that depends
//! on the present state alone does no such harm.
//!
//! At order 8 and 2 ms a chain of three links that is left with 1e-10 of roundoff loses 1.5e-22 +- 4e-23 of its energy
//! scale a solve (24 runs of 1e7 solves), with 1e-13 7e-23 +- 4e-23; a four-bar with 1e-6 loses 2.5e-22 +- 5e-23, and
//! 3.3e-22 +- 6e-23 when it turns the other way.

use super::stop::LIMITS;

/// The residuals of the rounds of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Decline {
    /// The last one as measured, m.
    measured: f64,
    /// What it is without roundoff, m.
    left: f64,
    /// The part of it that a round leaves, and whether that was seen in this step, above roundoff.
    rate: f64,
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
            left: none,
            rate: rate.min(LIMITS.slowest),
            seen: false,
            hidden: false,
            roundoff: 0.0,
        }
    }

    /// Takes in the residual of another round, and what roundoff may do to it.
    pub(super) fn follow(&mut self, measured: f64, roundoff: f64, exact: bool) {
        let falls = self.measured.is_finite() && !self.hidden;
        let rate = if falls { (measured / self.measured).min(LIMITS.slowest) } else { self.rate };
        let stagnant = (self.hidden || measured > 0.5 * self.measured) && measured <= LIMITS.noise(exact) * roundoff;
        self.hidden = measured <= LIMITS.hidden * roundoff || stagnant;
        if self.hidden {
            // Roundoff makes a residual no smaller.
            self.rate = rate.min(self.rate);
            self.left = measured.min(self.rate * self.left);
        } else {
            (self.rate, self.left) = (rate, measured);
            self.seen |= falls;
        }
        (self.measured, self.roundoff) = (measured, roundoff);
    }

    /// The part of a residual that a round leaves, where that was seen in this step, above roundoff.
    pub(super) fn seen(&self) -> Option<f64> {
        self.seen.then_some(self.rate)
    }

    /// Whether the last residual is roundoff for the most part.
    pub(super) fn hidden(&self) -> bool {
        self.hidden
    }

    /// Whether another correction leaves nothing that matters.
    pub(super) fn ends(&self) -> bool {
        self.hidden && self.rate * self.left <= LIMITS.unbiased * self.roundoff
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of rounds before the last correction, with residuals that fall from 1e-9 m by `rate` a round down to
    /// a noise, and a roundoff of 1e-17 m.
    fn rounds(rate: f64, noise: f64, guess: f64) -> usize {
        let mut decline = Decline::new(guess);
        let residual = |round: i32| 1e-9 * rate.powi(round) + noise * (1.0 + 0.3 * f64::from(round).sin());
        (0..60)
            .position(|round| {
                decline.follow(residual(round), 1.1e-17, false);
                decline.ends()
            })
            .unwrap()
    }

    #[test]
    fn residuals_are_followed_down_as_they_fell_above_roundoff() {
        for guess in [1e-6, f64::INFINITY] {
            // 1e-9 rate^(n + 1) <= 1.1e-30 from n = 20, 10 and 6 on.
            assert_eq!(rounds(0.1, 1e-19, guess), 20);
            assert_eq!(rounds(0.01, 1e-19, guess), 10);
            assert_eq!(rounds(0.001, 1e-19, guess), 6);
        }
        // Where roundoff is underestimated it looks like a slower fall.
        assert!(rounds(0.01, 1e-16, f64::INFINITY) > 10);
    }

    #[test]
    fn a_residual_that_starts_at_roundoff_falls_as_in_the_step_before() {
        let rounds = |guess| {
            let mut decline = Decline::new(guess);
            (0..60).position(|_| {
                decline.follow(1e-18, 1.1e-17, false);
                decline.ends()
            })
        };
        // 1e-18 rate^(n + 1) <= 1.1e-30
        assert_eq!(rounds(1e-13), Some(0));
        assert_eq!(rounds(1e-3), Some(3));
        assert_eq!(rounds(f64::INFINITY), Some(39));
    }

    #[test]
    fn what_does_not_fall_does_not_end_far_above_roundoff() {
        let mut decline = Decline::new(1e-3);
        for _ in 0..20 {
            decline.follow(1e-15, 1e-17, false);
            assert!(!decline.ends() && !decline.hidden());
        }
        decline.follow(1e-15, 1e-17, true);
        assert!(decline.hidden(), "but that is the roundoff of the exact linearisation");
    }
}
