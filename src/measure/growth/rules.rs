//! The rules by which growth is told from swinging, numbered as in the folder's description.

use super::figures::{Exponent, Growth, Stretch, Verdict};
use super::statistics::{Line, haar_exponent, power_law, slowness};
use crate::measure::trace::series::Extent;

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

/// Judges a run from its stretches, which follow each other from t = 0 and have equally many steps; the last one may
/// have fewer. `None` for fewer than [`MIN_STEPS`] steps, unless the run ended in a blow-up.
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

/// Exponent 0. A spread of 1 that a drift widens by `excess` over the run grows like `1 + excess t`, which between half
/// of the run and its end is the power below.
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
