//! How an error grows over a run: a verdict, an exponent with a confidence interval and a slope, from the extremes and
//! means of at most 400 blocks of equally many steps, so that memory does not grow with the run.
//!
//! # The test
//!
//! The rules and their constants were fixed on synthetic series of known law (`tests/measure/growth.rs`), before they judged any
//! engine. Let `m` be the block means, and let the run be cut into sixteen *parts*. The *band* `a` is the median
//! half-width `(max - min) / 2` of the parts. In this order, an error is
//!
//! 1. `blow_up` where the engine diverged or the error exceeds ten times the energy scale;
//! 2. not judged in fewer than [`MIN_STEPS`] steps;
//! 3. `bounded` where it never leaves the roundoff of the energy, [`ROUNDOFF`];
//! 4. growing by the *widening rule* where the logarithm of the half-widths of the blocks, averaged over each part, rises by
//!    at least 0.4 over the run, and either its t statistic is at least 3.5 and `R` of the half-widths at least 0.01, or it
//!    is at least 2.5 and the half-widths of the parts rise likewise, with a t statistic of at least 3.5;
//! 5. growing by the *trend rule* where the straight line through the means of the parts changes by at least `3/4 a` over
//!    the run and its t statistic is at least 3. Every t statistic is reduced by `sqrt((1 - r) / (1 + r))`, with `r` the
//!    correlation of neighbouring residuals, for an error that remembers (Santer et al., J. Geophys. Res. 105, 2000);
//! 6. growing by the *wander rule* where the means of the parts, their largest and their smallest values each cover a
//!    range of at least `1.7 a`, where the ratio `R` is at least 0.01, and where the exponent of what a straight line
//!    leaves of `m` is at least 1/4;
//! 7. else `bounded`: no growth was established.
//!
//! `R` is the mean square of the running sum of a series without its mean, over the mean square of the series and the
//! square of its length: the statistic of Kwiatkowski, Phillips, Schmidt and Shin (J. Econometrics 54, 1992) without a lag
//! window. It is `1/(4 pi^2 n^2)` for `n` swings in the run, about `tau/(3 T)` for noise with correlation time `tau`, 0.05
//! for a random walk and 0.1 for a line.
//!
//! An error that widens is a `drift`. Another that grows is a `random_walk` where what a straight line leaves of it behaves like one: exponent between 1/4 and
//! 3/4, `R` at least 0.0015, and less than 95 % of the variance explained by the line. Else it is a `drift`.
//!
//! # The exponent
//!
//! The error that grows does so like `t^p`. Of a random walk, `p` is the slope of the logarithm of the Haar wavelet (or
//! Allan) deviation of `m` against that of the time scale, by the weighted regression of Abry and Veitch (IEEE Trans. Inf.
//! Theory 44, 1998) with their interval. Of a drift, `c t^p` is fitted to the means (or half-widths) of the parts, and the
//! interval is that of the F test. Where the error is bounded the exponent is 0, and the interval ends where the spread
//! would grow with the largest trend that the run does not exclude. All intervals are of 95 %.
//!
//! # What it does not promise
//!
//! Measured over 1000 seeds each while the rules were made; `tests/measure/growth.rs` holds them to these rates on seeds that were
//! first used when the rules were final (fewer than 1 % of false alarms, at least 99.5 % of full drifts):
//!
//! | series of 4000 steps | verdict | rate |
//! | --- | --- | --- |
//! | white, violet, pink and red (correlation time 1 % of the run) noise, periodic, quasi-periodic, beating, logistic, Lorenz | not `bounded` | at most 0.4 % |
//! | the same with a drift of the width of the band over the run, which doubles the band | growing | all |
//! | the same with a drift of half of that, which doubles the largest error | growing | at least 98.5 % (Lorenz), 99.4 % (pink) |
//! | the same swinging ever more widely, to twice the width | growing | at least 97 %, but quasi-periodic 83 %, beating 57 % |
//! | random walk | `random_walk` | 93 % (6 % `bounded`, 1 % `drift`) |
//! | bursts of very different height at random times, about 35 in the run | not `bounded` | 1.3 % |
//!
//! A run of fewer than three swings is judged as if its swing were growth: an error of which a run sees only a part of a
//! swing cannot be told from one that grows. So it is with a chaotic motion that has not yet visited all places where its
//! error is large: over 30 s the error of a double pendulum widens, over 100 s it does not. A drift of less than three
//! quarters of the band is not seen.

mod statistics;

use serde::{Deserialize, Serialize};

use super::trace::series::Extent;
use statistics::{Line, haar_exponent, power_law, slowness};

/// An energy error of this size, relative to the energy scale, cannot be told from roundoff.
pub const ROUNDOFF: f64 = 64.0 * f64::EPSILON;

/// Shorter runs are not judged.
pub const MIN_STEPS: u64 = 2000;

/// An energy error of this many energy scales is a blow-up.
const BLOW_UP: f64 = 10.0;

/// Parts of a run.
const PARTS: usize = 16;

/// Trend rule: change over the run, in bands, and t statistic.
const TREND: f64 = 0.75;
const TREND_T: f64 = 3.0;

/// Wander rule: range in bands, and exponent of what is left without the line.
const WANDER: f64 = 1.7;
const WANDER_EXPONENT: f64 = 0.25;

/// Widening rule: change of the logarithm over the run, and t statistics of parts and of blocks.
const WIDENING: f64 = 0.4;
const WIDENING_T: f64 = 3.5;
const WIDENING_FINE_T: f64 = 2.5;

/// What moves more slowly than this moves on the scale of the run.
const SLOW: f64 = 0.01;

/// A random walk without its line: smallest `R`, largest exponent, largest part that the line explains.
const WALK_SLOW: f64 = 0.0015;
const WALK_EXPONENT: f64 = 0.75;
const WALK_EXPLAINED: f64 = 0.95;

/// How the energy error behaved, from the best to the worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// No growth was established.
    Bounded,
    /// Grows about like the square root of time.
    RandomWalk,
    /// Grows about like time, or faster.
    Drift,
    /// More than ten energy scales, or no number any more.
    BlowUp,
}

impl Verdict {
    pub const ALL: [Verdict; 4] = [Verdict::Bounded, Verdict::RandomWalk, Verdict::Drift, Verdict::BlowUp];

    /// For tables.
    pub fn words(self) -> &'static str {
        match self {
            Verdict::Bounded => "bounded",
            Verdict::RandomWalk => "random walk",
            Verdict::Drift => "drift",
            Verdict::BlowUp => "blow-up",
        }
    }

    /// As files spell it.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Bounded => "bounded",
            Verdict::RandomWalk => "random_walk",
            Verdict::Drift => "drift",
            Verdict::BlowUp => "blow_up",
        }
    }
}

/// The growth of an error over a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    pub verdict: Verdict,
    /// Slope of the straight line through the block means, 1/s; negative where energy is lost. Absent where the run was too
    /// short.
    pub slope_per_s: Option<f64>,
    /// Absent after a blow-up.
    pub exponent: Option<Exponent>,
}

/// The power of time with which an error grows, with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponent {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

/// A stretch of a run: its last time (s), the number of its steps, the extent of the error in it.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    pub to: f64,
    pub count: u64,
    pub error: Extent,
}

/// Judges a run from its stretches, which follow each other from t = 0 and have equally many steps; the last one may have
/// fewer. `None` for fewer than [`MIN_STEPS`] steps, unless the run ended in a blow-up.
pub fn growth(stretches: &[Stretch], diverged: bool) -> Option<Growth> {
    let steps: u64 = stretches.iter().map(|s| s.count).sum();
    let largest = stretches.iter().map(|s| s.error.amplitude()).fold(0.0, f64::max);
    let blocks = whole(stretches);
    let judged = steps >= MIN_STEPS && blocks.len() >= 4 * PARTS;
    if diverged || !(largest <= BLOW_UP) {
        let slope = judged.then(|| slope_per_s(blocks));
        return Some(Growth { verdict: Verdict::BlowUp, slope_per_s: slope, exponent: None });
    }
    judged.then(|| {
        let (verdict, exponent) = if largest <= ROUNDOFF { no_growth(0.0) } else { judge(blocks) };
        Growth { verdict, slope_per_s: Some(slope_per_s(blocks)), exponent: Some(exponent) }
    })
}

/// Without a last block that is shorter than the others.
fn whole(stretches: &[Stretch]) -> &[Stretch] {
    match stretches {
        [first, .., last] if last.count < first.count => &stretches[..stretches.len() - 1],
        all => all,
    }
}

fn slope_per_s(blocks: &[Stretch]) -> f64 {
    let means: Vec<f64> = blocks.iter().map(|b| b.error.mean).collect();
    Line::through(&means).change / blocks[blocks.len() - 1].to
}

/// Rules 4 to 7.
fn judge(blocks: &[Stretch]) -> (Verdict, Exponent) {
    let means: Vec<f64> = blocks.iter().map(|b| b.error.mean).collect();
    let parts = Parts::of(blocks);
    let line = Line::through(&means);
    let trend = Line::through(&parts.mean);
    let left = haar_exponent(&line.residual);
    let drifts = trend.change.abs() >= TREND * parts.band && trend.t() >= TREND_T;
    let wanders = parts.range() >= WANDER * parts.band && slowness(&means) >= SLOW && left.value >= WANDER_EXPONENT;
    if widens(blocks, &parts) {
        return (Verdict::Drift, power_law(if drifts || wanders { &parts.mean } else { &parts.half_width }));
    }
    if drifts || wanders {
        let walks = left.value >= WANDER_EXPONENT
            && left.value < WALK_EXPONENT
            && slowness(&line.residual) >= WALK_SLOW
            && line.explained < WALK_EXPLAINED;
        return match walks {
            true => (Verdict::RandomWalk, haar_exponent(&means)),
            false => (Verdict::Drift, power_law(&parts.mean)),
        };
    }
    no_growth(trend.largest_change() / (2.0 * parts.band))
}

/// Rule 4.
fn widens(blocks: &[Stretch], parts: &Parts) -> bool {
    let fine: Vec<f64> = blocks.iter().map(|b| b.error.half_width()).collect();
    let (coarse, finer) = (Line::through(&logarithms(&parts.half_width)), Line::through(&logarithms(&averages(&fine))));
    let steady = finer.t() >= WIDENING_T && slowness(&fine) >= SLOW;
    let both = coarse.change >= WIDENING && coarse.t() >= WIDENING_T && finer.t() >= WIDENING_FINE_T;
    finer.change >= WIDENING && (steady || both)
}

/// Exponent 0. A spread of 1 that a drift widens by `excess` over the run grows like `1 + excess t`, which between half of
/// the run and its end is the power below.
fn no_growth(excess: f64) -> (Verdict, Exponent) {
    let excess = if excess.is_finite() { excess } else { 0.0 };
    let high = ((1.0 + excess) / (1.0 + 0.5 * excess)).log2();
    (Verdict::Bounded, Exponent { value: 0.0, low: 0.0, high })
}

/// What is known of each part of a run.
struct Parts {
    mean: Vec<f64>,
    max: Vec<f64>,
    min: Vec<f64>,
    half_width: Vec<f64>,
    band: f64,
}

impl Parts {
    fn of(blocks: &[Stretch]) -> Parts {
        let joined: Vec<Extent> = (0..PARTS)
            .map(|k| {
                let (from, to) = (k * blocks.len() / PARTS, (k + 1) * blocks.len() / PARTS);
                let (mut joined, mut count) = (blocks[from].error, 1.0);
                for block in &blocks[from + 1..to] {
                    joined = joined.join(count, block.error, 1.0);
                    count += 1.0;
                }
                joined
            })
            .collect();
        let column = |pick: fn(&Extent) -> f64| joined.iter().map(pick).collect::<Vec<f64>>();
        Parts {
            mean: column(|e| e.mean),
            max: column(|e| e.max),
            min: column(|e| e.min),
            half_width: column(|e| e.half_width()),
            band: median(column(|e| e.half_width())),
        }
    }

    /// The range that means, largest and smallest values all cover.
    fn range(&self) -> f64 {
        let range = |values: &[f64]| {
            values.iter().copied().fold(f64::MIN, f64::max) - values.iter().copied().fold(f64::MAX, f64::min)
        };
        range(&self.mean).min(range(&self.max)).min(range(&self.min))
    }
}

fn logarithms(values: &[f64]) -> Vec<f64> {
    values.iter().map(|x| x.max(f64::MIN_POSITIVE).ln()).collect()
}

fn averages(values: &[f64]) -> Vec<f64> {
    (0..PARTS)
        .map(|k| {
            let part = &values[k * values.len() / PARTS..(k + 1) * values.len() / PARTS];
            part.iter().sum::<f64>() / part.len() as f64
        })
        .collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
