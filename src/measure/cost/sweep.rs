//! The settings that are tried beside those of a comparison, so that each engine is judged by its best.
//!
//! A sweep takes every setting over the first [`LONGEST`] seconds of a scene, or less where the truth ends sooner, at step
//! sizes that divide this time: errors are compared at the same twenty times in every run, or at those of them that it has.

use crate::engines::{Key, Spec, SpecError};
use crate::measure::Horizon;
use crate::measure::truth::sampling::round_below;

/// Longest time that a sweep simulates, s.
pub const LONGEST: f64 = 2.0;

/// Errors are compared at so many times.
pub const SAMPLES: u64 = 20;

/// An engine setting with the numbers of steps that it is run with.
#[derive(Clone, Debug)]
pub struct Setting {
    pub engine: Spec,
    pub counts: &'static [u64],
}

/// An engine setting with its numbers of steps.
type Listed = (&'static str, &'static [u64]);

/// Steps over the whole time: for methods of high order, of order two, and of order one. The rivals at small errors,
/// compositions of high order, Galerkin methods and `dop853`, have neighbours whose costs differ by an eighth to a third there: with
/// wider gaps a cost would say more about the list than about the engine.
const LONG_STEPS: &[u64] = &[20, 40, 100, 200, 400, 1000, 2000];
const COMPOSED_STEPS: &[u64] = &[20, 40, 60, 80, 100, 140, 200, 260, 340, 400, 500, 600, 800, 1000, 2000];
const STEPS: &[u64] = &[40, 100, 200, 400, 1000, 2000, 4000, 10_000, 20_000];
const SHORT_STEPS: &[u64] = &[100, 200, 400, 1000, 2000, 4000, 10_000, 20_000];
/// For the settings of rapier that gain most by short steps, and those whose error stops falling.
const SHORTEST_STEPS: &[u64] = &[100, 200, 400, 1000, 2000, 4000, 10_000, 20_000, 40_000, 100_000];
/// For methods whose steps may be longer than the interval between two samples: every second, fourth or fifth is met then.
const LONGEST_STEPS: &[u64] = &[4, 10, 20, 40, 60, 100, 200, 400, 1000];
const GALERKIN_STEPS: &[u64] =
    &[4, 5, 8, 10, 12, 16, 20, 25, 30, 35, 40, 50, 60, 70, 80, 100, 120, 140, 160, 200, 260, 400, 1000];
/// Engines whose error a tolerance controls: the state is read seldom, so that reading does not shorten their steps, and at
/// every sample.
const READ: &[u64] = &[4, 10, SAMPLES];

const QUICK_LONG_STEPS: &[u64] = &[20, 100, 400];
const QUICK_SHORT_STEPS: &[u64] = &[200, 1000, 4000];
const QUICK_COMPOSED_STEPS: &[u64] = &[20, 60, 80, 100, 140, 200, 400];
const QUICK_GALERKIN_STEPS: &[u64] = &[5, 10, 20, 25, 30, 40, 50, 60, 80, 100, 140, 200, 400];

/// What is tried where the user names no engine. Rapier: single precision as it comes, then double precision over substeps,
/// Gauss-Seidel iterations and stabilisation, then reduced coordinates.
const ALL: &[Listed] = &[
    ("rattle", STEPS),
    ("rattle:order=4", LONG_STEPS),
    ("rattle:order=6", COMPOSED_STEPS),
    ("rattle:order=8", COMPOSED_STEPS),
    ("galerkin:stages=2", LONG_STEPS),
    ("galerkin:stages=3", LONGEST_STEPS),
    ("galerkin", LONGEST_STEPS),
    ("galerkin:stages=6", GALERKIN_STEPS),
    ("galerkin:stages=8", GALERKIN_STEPS),
    ("dop853:tolerance=1e-3", READ),
    ("dop853:tolerance=1e-4", READ),
    ("dop853:tolerance=1e-5", READ),
    ("dop853:tolerance=1e-6", READ),
    ("dop853:tolerance=1e-7", READ),
    ("dop853:tolerance=1e-8", READ),
    ("dop853:tolerance=5e-9", READ),
    ("dop853:tolerance=2e-9", READ),
    ("dop853", READ),
    ("dop853:tolerance=3e-10", READ),
    ("dop853:tolerance=1e-10", READ),
    ("dop853:tolerance=3e-11", READ),
    ("dop853:tolerance=1e-11", READ),
    ("dop853:tolerance=1e-12", READ),
    ("dop853:tolerance=1e-13", READ),
    ("rk4", STEPS),
    ("semi_implicit_euler", SHORT_STEPS),
    ("explicit_euler", SHORT_STEPS),
    ("rapier", SHORTEST_STEPS),
    ("rapier:substeps=1,iterations=4,stabilization=0", SHORT_STEPS),
    ("rapier:joints=multibody", SHORTEST_STEPS),
    ("rapier:precision=f64", SHORTEST_STEPS),
    ("rapier:precision=f64,stabilization=0", SHORT_STEPS),
    ("rapier:precision=f64,iterations=4", SHORT_STEPS),
    ("rapier:precision=f64,iterations=4,stabilization=0", SHORT_STEPS),
    ("rapier:precision=f64,iterations=16,stabilization=0", SHORT_STEPS),
    ("rapier:precision=f64,substeps=1", SHORT_STEPS),
    ("rapier:precision=f64,substeps=1,stabilization=0", SHORT_STEPS),
    ("rapier:precision=f64,substeps=1,iterations=4", SHORT_STEPS),
    ("rapier:preset=strong", SHORTEST_STEPS),
    ("rapier:preset=strong,iterations=16", SHORTEST_STEPS),
    ("rapier:preset=strong,iterations=64", SHORT_STEPS),
    ("rapier:precision=f64,substeps=16", SHORT_STEPS),
    ("rapier:precision=f64,substeps=16,iterations=4,stabilization=0", SHORT_STEPS),
    ("rapier:joints=multibody,precision=f64", SHORT_STEPS),
    ("rapier:joints=multibody,precision=f64,substeps=1", SHORTEST_STEPS),
];

/// With `--quick`.
const QUICK: &[Listed] = &[
    ("rattle", QUICK_SHORT_STEPS),
    ("rattle:order=4", QUICK_LONG_STEPS),
    ("rattle:order=8", QUICK_COMPOSED_STEPS),
    ("galerkin", QUICK_LONG_STEPS),
    ("galerkin:stages=6", QUICK_GALERKIN_STEPS),
    ("galerkin:stages=8", QUICK_GALERKIN_STEPS),
    ("dop853:tolerance=1e-6", READ),
    ("dop853:tolerance=1e-8", READ),
    ("dop853:tolerance=5e-9", READ),
    ("dop853:tolerance=2e-9", READ),
    ("dop853", READ),
    ("dop853:tolerance=1e-10", READ),
    ("dop853:tolerance=1e-12", READ),
    ("rk4", QUICK_SHORT_STEPS),
    ("rapier", QUICK_SHORT_STEPS),
    ("rapier:preset=strong", QUICK_SHORT_STEPS),
    ("rapier:joints=multibody,precision=f64", QUICK_SHORT_STEPS),
];

/// The settings that are tried by default.
///
/// # Errors
/// None while the lists above name engines and keys that there are.
pub fn settings(quick: bool) -> Result<Vec<Setting>, SpecError> {
    let list = if quick { QUICK } else { ALL };
    list.iter().map(|(text, counts)| Ok(Setting { engine: Spec::parse(text)?, counts })).collect()
}

/// Engines that the user named, over as many step sizes as suit them.
pub fn settings_of(engines: &[Spec], quick: bool) -> Vec<Setting> {
    let same = |list: &'static [Listed], spec: &Spec| list.iter().find(|l| l.0 == spec.to_string());
    let listed = |spec: &Spec| {
        same(ALL, spec).or_else(|| ALL.iter().find(|(text, _)| text.split(':').next() == Some(spec.entry().name)))
    };
    let counts = |spec: &Spec| match listed(spec) {
        _ if chooses_steps(spec) => READ,
        Some((_, counts)) if quick => {
            if let Some((_, counts)) = same(QUICK, spec) {
                counts
            } else if counts[0] < 100 {
                QUICK_LONG_STEPS
            } else {
                QUICK_SHORT_STEPS
            }
        }
        Some((_, counts)) => counts,
        None if quick => QUICK_LONG_STEPS,
        None => STEPS,
    };
    engines.iter().map(|spec| Setting { engine: spec.clone(), counts: counts(spec) }).collect()
}

/// Whether an engine chooses its own steps, by a tolerance: its state is then read at the steps of a run.
pub fn chooses_steps(spec: &Spec) -> bool {
    spec.entry().keys.iter().map(|key: &Key| key.name()).any(|name| name == "tolerance")
}

/// The time that a sweep simulates, s: the largest of 1, 2, 5 times a power of ten within the scene's duration, the time
/// that the truth is known for, and [`LONGEST`]. `None` where the truth is not known.
pub fn span(duration: f64, trusted_until: f64) -> Option<f64> {
    let longest = duration.min(trusted_until).min(LONGEST);
    (longest > 0.0).then(|| round_below(longest))
}

/// The run of so many steps over a time, s.
pub fn horizon(span: f64, count: u64) -> Horizon {
    let step = span / count as f64;
    // The nearest short decimal, so that 2 s / 400 is 0.005 s.
    Horizon { step: format!("{step:.14e}").parse().unwrap_or(step), steps: count, end: span }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_setting_is_known_and_stands_once() {
        for quick in [false, true] {
            let settings = settings(quick).expect("known");
            let mut names: Vec<String> = settings.iter().map(|s| s.engine.to_string()).collect();
            names.sort();
            names.dedup();
            assert_eq!(names.len(), settings.len());
            for setting in &settings {
                assert!(setting.counts.windows(2).all(|w| w[0] < w[1]), "{}", setting.engine);
                // Every run meets at least four of the common times, the last one among them.
                let met = |n: &u64| (1..=SAMPLES).filter(|k| (k * n).is_multiple_of(SAMPLES)).count();
                assert!(setting.counts.iter().all(|n| met(n) >= 4), "{}", setting.engine);
            }
        }
    }

    #[test]
    fn a_sweep_ends_with_the_truth() {
        assert_eq!([span(10.0, 10.0), span(10.0, 1.37), span(0.7, 10.0)], [Some(2.0), Some(1.0), Some(0.5)]);
        assert_eq!(span(10.0, 0.0), None);
        assert_eq!((horizon(2.0, 400).step, horizon(0.5, 20_000).step), (0.005, 2.5e-5));
    }
}
