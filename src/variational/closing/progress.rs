//! How far a solve has come: its residuals, held against the rules of [`super::stop`].

use super::decline::Decline;
use super::stop::{Ending, LIMITS, last_round};
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

/// The residuals of the rounds so far.
#[derive(Debug)]
pub(super) struct Progress {
    /// m
    tolerance: f64,
    /// Whether the system is a tree, without rows across it.
    tree: bool,
    /// The residual of the last round, m.
    last: f64,
    pub rounds: usize,
    /// Whether rounds are taken with the exact linearisation.
    pub exact: bool,
    slow: bool,
    decline: Option<Decline>,
}

impl Progress {
    /// `unbiased` is a guess of the part of a residual that a round leaves, where the iteration goes on below roundoff.
    pub(super) fn new(tolerance: f64, tree: bool, unbiased: Option<f64>) -> Progress {
        let decline = unbiased.map(Decline::new);
        Progress { tolerance, tree, last: f64::INFINITY, rounds: 0, exact: false, slow: false, decline }
    }

    /// Holds a residual of the next round against the rules.
    pub(super) fn judge(&mut self, residual: f64, roundoff: f64) -> Verdict {
        let contraction = if self.rounds == 0 { 1.0 } else { residual / self.last };
        let (hidden, last_round) = match &mut self.decline {
            None => (false, last_round(self.tree, residual, contraction, roundoff)),
            Some(decline) => {
                decline.follow(residual, roundoff, self.exact);
                let ends = decline.ends() || (decline.hidden() && self.rounds + 1 >= LIMITS.rounds);
                (decline.hidden(), ends.then_some(Ending::Unbiased))
            }
        };
        if residual <= self.tolerance {
            return Verdict::Closed(Ending::Tolerance);
        }
        let falls_to = |part: f64| residual <= part * self.last;
        if self.decline.is_none() && !falls_to(LIMITS.stagnant) && residual <= LIMITS.noise(self.exact) * roundoff {
            return Verdict::Closed(Ending::Stagnant);
        }
        self.slow = !falls_to(LIMITS.slow) && !hidden;
        let hopeless = self.exact && self.rounds > LIMITS.exact_patience && !falls_to(LIMITS.hopeless) && !hidden;
        if self.rounds == LIMITS.rounds || hopeless {
            return Verdict::GiveUp;
        }
        last_round.map_or(Verdict::GoOn, Verdict::LastRound)
    }

    /// Whether the last round has not stagnated.
    pub(super) fn falls(&self, residual: f64) -> bool {
        residual <= LIMITS.stagnant * self.last
    }

    /// Whether the exact linearisation is called for from now on.
    pub(super) fn turns_exact(&mut self) -> bool {
        self.exact |= self.slow && self.rounds >= LIMITS.patience;
        self.exact
    }

    /// Goes on to the next round, after a correction of a residual, m.
    pub(super) fn corrected(&mut self, residual: f64) {
        (self.last, self.rounds) = (residual, self.rounds + 1);
    }

    /// The part of a residual that a round of the chord iteration leaves, where that was seen in this step, above roundoff.
    pub(super) fn contraction(&self) -> Option<f64> {
        self.decline.as_ref().and_then(Decline::seen).filter(|_| !self.exact)
    }
}
