//! The nine classes of a cell and the rules that choose one.
//!
//! The rules are tried in this order; lengths and energies are over the scales of the scene, angles in rad.
//!
//! | class | where |
//! | --- | --- |
//! | `over_budget` | the run would cost more than its allowance of work, and was not begun |
//! | `refused` | the engine has no means for the scene, or ended with a named reason before it returned a wrong state |
//! | `blow_up` | a state is not a number, or the energy error passes `BLOW_UP` scales |
//! | `constraint_broken` | the halves of a joint are more than [`BROKEN`] of a link apart, or turned by as many rad |
//! | `accurate` | pose error, energy error and joint gap all stay within `ACCURATE`, and the truth is known |
//! | `bounded` | the energy error never passes `MATERIAL`, or does not grow, or comes back from where it was |
//! | `drifting` | the energy error grows like a random walk, without a direction |
//! | `gaining` | energy grows, or stays too high |
//! | `dissipating` | energy falls, or stays too low |
//!
//! Whether an error grows is judged by [`growth`](crate::measure::growth), and runs are a few swings long, over which
//! an error that depends on the position looks like growth. So what grows must also *widen*: the spread of the error
//! over the whole run is at least `WIDER` times that over its first half; and it must not *come back*: its mean over
//! the last quarter of the run, or over the last sixteenth, is at least a quarter of its largest value. An error
//! *stays* where it is above `WHOLE`, or above `SETTLED` and all of the last quarter is beyond half of the largest
//! value, on one side: a motion that was damped to rest in a moment has stopped losing energy, and has lost it all the
//! same. In scenes with dampers or drives the energy is the balance: what the forces without potential did is accounted
//! for.

use serde::{Deserialize, Serialize};

use crate::measure::growth::{Growth, Stretch, Verdict, growth};
use crate::measure::outcome::Outcome;
use crate::numeric::larger;

/// Errors up to this part of their scale are accurate.
pub(crate) const ACCURATE: f64 = 1e-3;

/// The halves of a joint that are further apart than this part of a link, or turned by more rad, have parted.
pub const BROKEN: f64 = 1e-2;

/// A growth of the energy error that stays below this part of the energy scale does not count.
pub(crate) const MATERIAL: f64 = 1e-4;

/// What grows has a spread this much larger over the whole run than over its first half: a straight drift 2, a random
/// walk 1.4 on average.
pub(crate) const WIDER: f64 = 1.2;

/// An energy error beyond this part of the energy scale that stays is no bounded one.
pub(crate) const SETTLED: f64 = 0.05;

/// An energy error beyond this many energy scales is not bounded in a useful sense.
pub(crate) const WHOLE: f64 = 1.0;

/// An energy error beyond this many energy scales is a blow-up.
pub(crate) const BLOW_UP: f64 = 10.0;

/// What became of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    Accurate,
    Bounded,
    Drifting,
    Dissipating,
    Gaining,
    ConstraintBroken,
    BlowUp,
    Refused,
    OverBudget,
}

impl Class {
    pub const ALL: [Class; 9] = [
        Class::Accurate,
        Class::Bounded,
        Class::Drifting,
        Class::Dissipating,
        Class::Gaining,
        Class::ConstraintBroken,
        Class::BlowUp,
        Class::Refused,
        Class::OverBudget,
    ];

    /// For sentences, tables and legends.
    pub fn words(self) -> &'static str {
        match self {
            Class::Accurate => "accurate",
            Class::Bounded => "bounded",
            Class::Drifting => "drifting",
            Class::Dissipating => "dissipating",
            Class::Gaining => "gaining energy",
            Class::ConstraintBroken => "joints apart",
            Class::BlowUp => "blow-up",
            Class::Refused => "refused",
            Class::OverBudget => "over budget",
        }
    }

    /// Right, or wrong within bounds.
    pub fn is_sound(self) -> bool {
        matches!(self, Class::Accurate | Class::Bounded)
    }
}

/// What the rules look at.
#[derive(Clone, Debug)]
pub(crate) struct Evidence<'a> {
    /// How the run ended; `None` where it was not begun because of its cost.
    pub outcome: Option<&'a Outcome>,
    /// The signed energy error over the run.
    pub energy: &'a [Stretch],
    /// Largest gap of a joint: over the length of a link, or rad.
    pub joint_gap: f64,
    /// Largest pose error while the truth is trusted; `None` where it is not trusted for long enough.
    pub pose_error: Option<f64>,
}

/// Chooses the class of a cell.
pub(crate) fn classify(evidence: &Evidence) -> Class {
    match evidence.outcome {
        None | Some(Outcome::OverBudget { .. }) => return Class::OverBudget,
        Some(Outcome::Unsupported { .. } | Outcome::NotConverged { .. }) if !already_wrong(evidence) => {
            return Class::Refused;
        }
        Some(Outcome::Diverged { .. }) => return Class::BlowUp,
        Some(Outcome::Completed | Outcome::Unsupported { .. } | Outcome::NotConverged { .. }) => {}
    }
    let largest = largest(evidence.energy);
    if !(largest <= BLOW_UP) {
        return Class::BlowUp;
    }
    if !(evidence.joint_gap <= BROKEN) {
        return Class::ConstraintBroken;
    }
    let small = |error: f64| error <= ACCURATE;
    if evidence.pose_error.is_some_and(small) && small(largest) && small(evidence.joint_gap) {
        return Class::Accurate;
    }
    by_energy(evidence.energy, largest)
}

/// An engine that gives up after it has returned wrong states has not refused in time.
fn already_wrong(evidence: &Evidence) -> bool {
    !(largest(evidence.energy) <= BLOW_UP && evidence.joint_gap <= BROKEN)
}

fn by_energy(energy: &[Stretch], largest: f64) -> Class {
    let late = Late::of(energy, 4);
    let directed = if late.mean < 0.0 { Class::Dissipating } else { Class::Gaining };
    let stays = largest > SETTLED && late.min.max(-late.max) > 0.5 * largest;
    if largest <= MATERIAL {
        return Class::Bounded;
    }
    if largest > WHOLE || stays {
        return directed;
    }
    let Some(Growth { verdict, .. }) = growth(energy, false) else { return Class::Bounded };
    let grows = || !comes_back(energy, largest) && !(widening(energy) < WIDER);
    match verdict {
        Verdict::Bounded => Class::Bounded,
        Verdict::RandomWalk if grows() => Class::Drifting,
        Verdict::Drift | Verdict::BlowUp if grows() => directed,
        Verdict::RandomWalk | Verdict::Drift | Verdict::BlowUp => Class::Bounded,
    }
}

/// The largest absolute error; NaN where one is.
fn largest(energy: &[Stretch]) -> f64 {
    let sizes =
        energy.iter().map(|stretch| stretch.error.min.abs().max(stretch.error.max.abs()) + 0.0 * stretch.error.mean);
    sizes.fold(0.0, larger)
}

/// The spread of the error, which begins at zero, over the whole run over that of its first half.
fn widening(energy: &[Stretch]) -> f64 {
    let spread = |part: &[Stretch]| {
        part.iter().map(|s| s.error.max).fold(0.0, f64::max) - part.iter().map(|s| s.error.min).fold(0.0, f64::min)
    };
    spread(energy) / spread(&energy[..energy.len() / 2])
}

fn comes_back(energy: &[Stretch], largest: f64) -> bool {
    [4, 16].into_iter().all(|part| Late::of(energy, part).mean.abs() < 0.25 * largest)
}

/// The error over the end of a run.
struct Late {
    min: f64,
    max: f64,
    mean: f64,
}

impl Late {
    /// Over the last of so many parts.
    fn of(energy: &[Stretch], parts: usize) -> Late {
        let late = &energy[energy.len() - energy.len().div_ceil(parts)..];
        let steps: u64 = late.iter().map(|s| s.count).sum();
        Late {
            min: late.iter().map(|s| s.error.min).fold(f64::INFINITY, f64::min),
            max: late.iter().map(|s| s.error.max).fold(f64::NEG_INFINITY, f64::max),
            mean: late.iter().map(|s| s.error.mean * s.count as f64).sum::<f64>() / steps as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::trace::series::Series;

    const STEPS: u64 = 4000;

    /// The class of a completed run over t in (0, 1] with this energy error, joints that hold, and no truth.
    fn of(mut error: impl FnMut(f64) -> f64) -> Class {
        let mut series = Series::<1>::new(STEPS);
        for n in 1..=STEPS {
            let t = n as f64 / STEPS as f64;
            series.push(t, [error(t)]);
        }
        let energy: Vec<Stretch> =
            series.blocks.iter().map(|b| Stretch { to: b.to, count: b.count, error: b.values[0] }).collect();
        classify(&Evidence { outcome: Some(&Outcome::Completed), energy: &energy, joint_gap: 0.0, pose_error: None })
    }

    /// The class of a run whose energy error is the constant `energy`.
    fn with(energy: f64, joint_gap: f64, pose_error: Option<f64>) -> Class {
        let extent = crate::measure::trace::series::Extent { min: energy, max: energy, mean: energy };
        let stretches = [Stretch { to: 1.0, count: 10, error: extent }; 10];
        classify(&Evidence { outcome: Some(&Outcome::Completed), energy: &stretches, joint_gap, pose_error })
    }

    /// Uniform numbers in (-1, 1) from a linear congruential generator (Knuth's MMIX constants).
    fn noise(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 / (1u64 << 53) as f64) * 2.0 - 1.0
        }
    }

    #[test]
    fn a_pure_drift_is_named_by_its_direction() {
        assert_eq!(of(|t| 3e-4 * t), Class::Gaining);
        assert_eq!(of(|t| -3e-4 * t), Class::Dissipating);
        assert_eq!(of(|t| -1.0 + (-3.0 * t).exp()), Class::Dissipating);
    }

    #[test]
    fn a_motion_that_is_damped_to_rest_in_a_moment_has_lost_its_energy() {
        assert_eq!(of(|t| -0.3 * (1.0 - (-100.0 * t).exp())), Class::Dissipating);
        assert_eq!(of(|t| -0.03 * (1.0 - (-100.0 * t).exp())), Class::Bounded);
    }

    #[test]
    fn a_burst_that_comes_back_is_bounded() {
        // Falls of a pendulum, few and of different depth: growth alone takes some of them for a drift.
        for falls in [1.0, 1.5, 2.0, 2.7, 3.0] {
            let error = |t: f64| -2e-3 * (falls * std::f64::consts::PI * t).sin().powi(2) * (1.0 - 0.2 * t);
            assert_eq!(of(error), Class::Bounded, "{falls} falls");
        }
    }

    #[test]
    fn a_growth_that_does_not_matter_is_bounded() {
        assert_eq!(of(|t| 1e-4 * t), Class::Bounded);
        assert_eq!(of(|t| 2e-4 * t), Class::Gaining);
    }

    #[test]
    fn a_random_walk_is_mostly_drifting() {
        let walk = |seed| {
            let (mut step, mut sum) = (noise(seed), 0.0);
            of(move |_| {
                sum += 1e-4 * step();
                sum
            })
        };
        let classes: Vec<Class> = (1..=1000).map(walk).collect();
        let count = |class| classes.iter().filter(|c| **c == class).count();
        let directed = count(Class::Gaining) + count(Class::Dissipating);
        let counts = (count(Class::Drifting), directed, count(Class::Bounded));
        assert!(counts.0 > 400 && counts.0 > 2 * directed, "{counts:?}");
        assert_eq!(count(Class::BlowUp) + count(Class::Accurate), 0);
    }

    #[test]
    fn an_exponential_is_a_gain_until_it_blows_up() {
        assert_eq!(of(|t| 1e-12 * (20.0 * t).exp()), Class::Gaining);
        assert_eq!(of(|t| 1e-12 * (30.2 * t).exp()), Class::BlowUp);
        assert_eq!(of(|t| 9.9 * t), Class::Gaining);
    }

    #[test]
    fn an_oscillation_is_bounded_unless_it_passes_the_scale() {
        let swing = |size: f64| of(|t| size * (1.0 - (500.0 * t).cos()));
        assert_eq!(swing(1e-5), Class::Bounded);
        assert_eq!(swing(0.4), Class::Bounded);
        assert_eq!(swing(0.6), Class::Gaining);
        assert_eq!(swing(-0.6), Class::Dissipating);
    }

    #[test]
    fn one_nan_is_a_blow_up() {
        assert_eq!(of(|t| if t == 0.25 { f64::NAN } else { 0.0 }), Class::BlowUp);
        assert_eq!(of(|t| if t == 1.0 { f64::INFINITY } else { 0.0 }), Class::BlowUp);
        assert_eq!(with(0.0, f64::NAN, Some(0.0)), Class::ConstraintBroken);
        assert_eq!(with(0.0, 0.0, Some(f64::NAN)), Class::Bounded);
    }

    #[test]
    fn accurate_needs_energy_joints_and_a_truth() {
        assert_eq!(with(1e-3, 1e-3, Some(1e-3)), Class::Accurate);
        assert_eq!(with(1e-4, 1e-4, None), Class::Bounded);
        assert_eq!(with(1e-4, 1e-4, Some(1.1e-3)), Class::Bounded);
        assert_eq!(with(1.1e-3, 1e-4, Some(1e-4)), Class::Bounded);
        assert_eq!(with(1e-4, 1.1e-3, Some(1e-4)), Class::Bounded);
        assert_eq!(with(1e-4, 1.1e-2, Some(1e-4)), Class::ConstraintBroken);
    }

    #[test]
    fn an_end_before_time_has_its_class() {
        let ended = |outcome: Option<&Outcome>, joint_gap| {
            classify(&Evidence { outcome, energy: &[], joint_gap, pose_error: None })
        };
        let detail = String::new;
        assert_eq!(ended(None, 0.0), Class::OverBudget);
        assert_eq!(ended(Some(&Outcome::Unsupported { detail: detail() }), 0.0), Class::Refused);
        assert_eq!(ended(Some(&Outcome::NotConverged { detail: detail() }), 0.0), Class::Refused);
        assert_eq!(ended(Some(&Outcome::Diverged { detail: detail() }), 0.0), Class::BlowUp);
        // Too late: the states before the failure were already wrong.
        assert_eq!(ended(Some(&Outcome::NotConverged { detail: detail() }), 0.1), Class::ConstraintBroken);
    }
}
