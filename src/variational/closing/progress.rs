//! How far a solve has come: its residuals, held against the rules of [`super::stop`].

use super::decline::Decline;
use super::stop::{Ending, LIMITS, Trust};
use crate::variational::rattle::failure::Open;

/// What the motions of a trial leave open.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    /// Where most is open.
    pub place: Open,
    /// How much, m; angles times the system's length.
    pub residual: f64,
    /// What roundoff may do to it, m.
    pub roundoff: f64,
}

/// What follows from a residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// The constraints hold.
    Closed(Ending),
    /// They do after one more round.
    LastRound(Ending),
    /// More rounds are needed.
    GoOn,
    /// No number of rounds helps.
    GiveUp,
}

/// The residuals of the rounds so far, and the factors of the next one.
#[derive(Debug)]
pub(super) struct Progress {
    /// m
    tolerance: f64,
    /// Rows across the tree.
    rows: usize,
    pub trust: Trust,
    /// The residual of the last round, m.
    last: f64,
    pub rounds: usize,
    /// Whether the factors are those of an exact linearisation, and whether it is made where the next round begins.
    pub exact: bool,
    pub factorise: bool,
    decline: Option<Decline>,
}

impl Progress {
    /// `unbiased` is a guess of the part of a residual that a round leaves, where the iteration goes on below roundoff.
    pub(super) fn new(tolerance: f64, rows: usize, trust: Trust, unbiased: Option<f64>) -> Progress {
        let decline = unbiased.map(Decline::new);
        let last = f64::INFINITY;
        Progress { tolerance, rows, trust, last, rounds: 0, exact: false, factorise: false, decline }
    }

    /// Holds the residual (m) before the next round against the rules.
    pub(super) fn judge(&mut self, residual: f64, roundoff: f64) -> Verdict {
        let contraction = if self.rounds == 0 { 1.0 } else { residual / self.last };
        let last_round = |residual: f64| LIMITS.last_round(self.rows == 0, residual, contraction, roundoff);
        let mut last = last_round(residual);
        // The exact linearisation costs about a round, and another one for each row, which is solved for alone; mostly
        // the round after it is the last.
        let cost = 2 + self.rows as i32;
        let slow = self.rounds > 0 && last_round(residual * contraction.powi(cost)).is_none();
        if let Some(decline) = &mut self.decline {
            decline.follow(residual, roundoff, self.factorise);
            let ends = decline.ends() || (decline.hidden() && self.rounds + 1 >= LIMITS.rounds);
            last = ends.then_some(Ending::Unbiased);
        }
        if residual <= self.tolerance {
            return Verdict::Closed(Ending::Tolerance);
        }
        let left = |part: f64| !(residual <= part * self.last);
        let noise = residual <= LIMITS.noise(self.factorise) * roundoff;
        if self.decline.is_none() && left(LIMITS.stagnant) && noise {
            return Verdict::Closed(Ending::Stagnant);
        }
        let hopeless = match self.trust {
            Trust::Eager => self.factorise && left(LIMITS.promised) && !noise,
            Trust::Careful => self.exact && self.rounds > LIMITS.exact_patience && left(LIMITS.hopeless) && !noise,
        };
        if self.rounds == LIMITS.rounds || hopeless {
            return Verdict::GiveUp;
        }
        let slow = match self.trust {
            Trust::Eager => slow,
            Trust::Careful => self.exact || (self.rounds >= LIMITS.patience && left(LIMITS.slow)),
        };
        self.factorise = slow && last.is_none() && !(residual <= LIMITS.noise * roundoff);
        self.exact |= self.factorise;
        last.map_or(Verdict::GoOn, Verdict::LastRound)
    }

    /// Goes on to the next round, after a correction of a residual, m.
    pub(super) fn corrected(&mut self, residual: f64) {
        (self.last, self.rounds) = (residual, self.rounds + 1);
    }

    /// The part of a residual that a round of the chord iteration leaves, where that was seen in this step, above
    /// roundoff.
    pub(super) fn contraction(&self) -> Option<f64> {
        self.decline.as_ref().and_then(Decline::seen).filter(|_| !self.exact)
    }
}
