//! When the constraint iteration ends: all thresholds of it, in one place.
//!
//! With the largest residual `r_k` of round `k` (m; angles times the system's length), the roundoff `e` of the motions
//! (m) and the part `c_k = r_k / r_(k-1)` that the last round has left of the residual (`c_0 = 1`), the iteration
//!
//! ```text
//! ends as it is               r_k <= tolerance ,   or   c_k > 0.3  and  r_k <= 64 e   (1e4 e with factors made for it)
//! ends with one more round    c_k r_k <= 1e-4 e ,  or   r_k <= 0.3 e  on a tree
//! linearises anew             r_k c_k^3 > 1e-4 e  and  r_k > 64 e :  two more rounds would not lead to the last one
//! gives up                    after 60 rounds ,    or   c_k > 0.1  of a round with exact factors made for it .
//! ```
//!
//! The exact linearisation costs about as much as a round, and as another one for each row of a linkage: there so many
//! more rounds are waited for. A step that gives up is tried again with more care ([`Trust::Careful`]), then from
//! extrapolations of half the degree and half of that, at last from no impulses at all:
//!
//! ```text
//! linearises in every round   once  c_k > 0.2  after three rounds
//! gives up                    after 60 rounds ,    or   c_k > 0.9  after eight rounds, with exact factors .
//! ```
//!
//! Where nothing may be left that has one sign for many steps (`unbiased`), the second line is `rho l_k <= 1e-13 e`
//! instead, with the part `rho` that a round leaves and what is left `l_k` followed below roundoff; see
//! [`super::decline`].

/// The thresholds.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct Limits {
    /// Rounds after which a step is given up. A chord iteration that leaves half of a residual a round is at roundoff
    /// after 50.
    pub rounds: usize,
    /// A round that leaves more than this part of a residual has stagnated, if that is
    pub stagnant: f64,
    /// at most so many times the estimate of roundoff: with factors that are kept (nothing changes from 4 to 1e4), and
    /// with exact ones made for the round, with which it stops contracting at roundoff only, wherever the estimate puts
    /// that.
    pub noise: f64,
    pub exact_noise: f64,
    /// The iteration ends with a correction that is predicted to leave this part of the roundoff of the motions. That
    /// is estimated for the thinnest axes, and what is left has the same sign for many steps.
    pub negligible: f64,
    /// Or, on a tree, with the correction of a residual that is this part of roundoff. A linkage, which repeats its
    /// motion, lost 2.2e-20 of its energy scale a solve by that on average; with `negligible` alone it loses at most
    /// 1.3e-21.
    pub settled: f64,
    /// The part of a residual that a round with the exact linearisation, made anew where the round begins, may leave.
    /// Where it leaves more, the trial was too far off: in whips of 10 to 50 links with `h |Omega|` near 1, Newton's
    /// method went on from there to false solutions with 1 to 15 % of the energy scale from nowhere, with a quarter and
    /// with half.
    pub promised: f64,
    /// With care, the exact linearisation takes over after so many rounds, once a round leaves more than this part of a
    /// residual.
    pub patience: usize,
    pub slow: f64,
    /// It fails after so many rounds, once a round leaves more than this part.
    pub exact_patience: usize,
    pub hopeless: f64,
    /// The part of the kinetic energy between the half kicks that may be that of the kick: of a first solution, and of
    /// one that no other start betters. In whips of 10 to 50 links with `h |Omega|` near 1 right solutions have up to
    /// 0.31, those that were refused 0.33 to 0.94; with a bound of 0.4 a planar whip of 10 links leaps, with 0.25 a
    /// composition is refused at right steps.
    pub kicked: f64,
    pub kicked_at_last: f64,
    /// The part of the kinetic energy that a step of a linkage may gain or lose by its error. Where two parallelograms
    /// in a row pass their flat position at 2 ms, 0.1 refuses the false solutions and 0.2 lets through what adds up to
    /// 1.5 of the energy scale; where steps resolve a flat position they have up to 0.02, all other linkages below
    /// 0.002.
    pub leap: f64,
    /// Residuals that are so few times the estimated roundoff of the motions are mostly roundoff.
    pub hidden: f64,
    /// No round is taken to leave more than this part of a residual.
    pub slowest: f64,
    /// The part of roundoff that the last correction may leave where the energy must not drift by it. The rate that is
    /// followed is that of the largest residual, above roundoff; what falls slower was smaller there.
    pub unbiased: f64,
}

pub(in crate::variational) const LIMITS: Limits = Limits {
    rounds: 60,
    stagnant: 0.3,
    noise: 64.0,
    exact_noise: 1e4,
    negligible: 1e-4,
    settled: 0.3,
    promised: 0.1,
    patience: 3,
    slow: 0.2,
    exact_patience: 8,
    hopeless: 0.9,
    kicked: 0.3,
    kicked_at_last: 0.32,
    leap: 0.05,
    hidden: 4.0,
    slowest: 0.5,
    unbiased: 1e-13,
};

impl Limits {
    /// The largest stagnant residual that is roundoff, over the estimate of roundoff.
    pub fn noise(&self, exact: bool) -> f64 {
        if exact { self.exact_noise } else { self.noise }
    }

    /// [`Limits::kicked`] of an extrapolation by a degree, or of the last start, from no impulses.
    pub fn kicked(&self, degree: Option<usize>) -> f64 {
        if degree.is_some() { self.kicked } else { self.kicked_at_last }
    }

    /// Whether the correction of a residual (m) is the last, by the second line above.
    pub fn last_round(&self, tree: bool, residual: f64, contraction: f64, roundoff: f64) -> Option<Ending> {
        if tree && residual <= self.settled * roundoff {
            return Some(Ending::Settled);
        }
        (residual * contraction <= self.negligible * roundoff).then_some(Ending::Negligible)
    }
}

/// How far the exact linearisation is trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::variational) enum Trust {
    /// As soon as rounds are slow.
    Eager,
    /// Where that has failed.
    Careful,
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
    /// One word.
    pub fn name(self) -> &'static str {
        match self {
            Ending::Tolerance => "tolerance",
            Ending::Stagnant => "stagnant",
            Ending::Negligible => "negligible",
            Ending::Settled => "settled",
            Ending::Unbiased => "unbiased",
        }
    }

    pub const ALL: [Ending; 5] =
        [Ending::Tolerance, Ending::Stagnant, Ending::Negligible, Ending::Settled, Ending::Unbiased];
}
