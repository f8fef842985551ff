//! When the constraint iteration ends: all thresholds of it, in one place.
//!
//! With the largest residual `r_k` of round `k` (m; angles times the system's length), the roundoff `e` of the motions (m) and the part
//! `c_k = r_k / r_(k-1)` that the last round has left of the residual (`c_0 = 1`), the iteration
//!
//! ```text
//! ends as it is              r_k <= tolerance ,   or   c_k > 0.3  and  r_k <= 64 e   (1e4 e with the exact linearisation)
//! ends with one more round   c_k r_k <= 1e-4 e ,  or   r_k <= 0.3 e  on a tree
//! turns exact                c_k > 0.2  after three rounds
//! gives up                   after 60 rounds ,    or   c_k > 0.9  after eight rounds, the exact ones included .
//! ```
//!
//! Where nothing may be left that has one sign for many steps (`unbiased`), the second line is `rho l_k <= 1e-13 e` instead, with the
//! part `rho` that a round leaves and what is left `l_k` followed below roundoff; see [`super::decline`].

/// The thresholds.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct Limits {
    /// Rounds after which a step is given up. A chord iteration that leaves half of a residual a round is at roundoff after 50.
    pub rounds: usize,
    /// A round that leaves more than this part of a residual has stagnated, if that is
    pub stagnant: f64,
    /// at most so many times the estimate of roundoff: for the chord iteration, and for the exact linearisation, which stops contracting
    /// at roundoff only, wherever the estimate puts that.
    pub noise: f64,
    pub exact_noise: f64,
    /// The iteration ends with a correction that is predicted to leave this part of the roundoff of the motions. That is estimated
    /// for the thinnest axes, and what is left has the same sign for many steps.
    pub negligible: f64,
    /// Or, on a tree, with the correction of a residual that is this part of roundoff. A linkage, which repeats its motion, lost
    /// 2.2e-20 of its energy scale a solve by that on average; with `negligible` alone it loses at most 1.3e-21.
    pub settled: f64,
    /// The exact linearisation takes over after so many rounds, once a round leaves more than this part of a residual.
    pub patience: usize,
    pub slow: f64,
    /// It fails after so many rounds, once a round leaves more than this part.
    pub exact_patience: usize,
    pub hopeless: f64,
    /// Residuals that are so few times the estimated roundoff of the motions are mostly roundoff.
    pub hidden: f64,
    /// No round is taken to leave more than this part of a residual.
    pub slowest: f64,
    /// The part of roundoff that the last correction may leave where the energy must not drift by it. The rate that is followed is that
    /// of the largest residual, above roundoff; what falls slower was smaller there.
    pub unbiased: f64,
}

pub(in crate::variational) const LIMITS: Limits = Limits {
    rounds: 60,
    stagnant: 0.3,
    noise: 64.0,
    exact_noise: 1e4,
    negligible: 1e-4,
    settled: 0.3,
    patience: 3,
    slow: 0.2,
    exact_patience: 8,
    hopeless: 0.9,
    hidden: 4.0,
    slowest: 0.5,
    unbiased: 1e-13,
};

impl Limits {
    /// The largest stagnant residual that is roundoff, over the estimate of roundoff.
    pub fn noise(&self, exact: bool) -> f64 {
        if exact { self.exact_noise } else { self.noise }
    }
}

/// Which rule has ended a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The residual is within the tolerance that the user has given.
    Tolerance,
    /// The residual is at roundoff and falls no more.
    Stagnant,
    /// The last correction was predicted to leave nothing that counts beside roundoff.
    Negligible,
    /// The last correction was that of a residual below roundoff.
    Settled,
    /// The last correction was predicted to leave nothing that makes the energy drift.
    Unbiased,
}

impl Ending {
    pub const ALL: [Ending; 5] =
        [Ending::Tolerance, Ending::Stagnant, Ending::Negligible, Ending::Settled, Ending::Unbiased];
}

/// Whether the correction of a residual (m) is the last, by the second line above.
pub(super) fn last_round(tree: bool, residual: f64, contraction: f64, roundoff: f64) -> Option<Ending> {
    if tree && residual <= LIMITS.settled * roundoff {
        return Some(Ending::Settled);
    }
    (residual * contraction <= LIMITS.negligible * roundoff).then_some(Ending::Negligible)
}
