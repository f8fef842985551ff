//! The settings that are tried beside those of a comparison, so that each engine is judged by its best.
//!
//! A sweep takes every setting over the first `LONGEST` seconds of a scene, or less where the truth ends sooner, at
//! step sizes that divide this time: errors are compared at the same twenty times in every run, or at those of them
//! that it has.

use crate::engines::swept::{self, Swept};
use crate::engines::{self, Spec, SpecError};
use crate::measure::Horizon;
use crate::measure::truth::sampling::round_below;

/// Longest time that a sweep simulates, s.
pub(crate) const LONGEST: f64 = 2.0;

/// Errors are compared at so many times.
pub(crate) const SAMPLES: u64 = 20;

/// An engine setting with the numbers of steps that it is run with.
#[derive(Clone, Debug)]
pub struct Setting {
    pub engine: Spec,
    pub counts: &'static [u64],
}

/// The settings that are tried where the user names no engine: those of every engine's entry.
///
/// # Errors
/// None while the entries name engines and keys that there are.
pub fn settings(quick: bool) -> Result<Vec<Setting>, SpecError> {
    let counts = |swept: &'static Swept| if quick { swept.quick } else { swept.counts };
    let tried = engines::sweep().filter(|swept| !counts(swept).is_empty());
    tried.map(|swept| Ok(Setting { engine: Spec::parse(swept.spec)?, counts: counts(swept) })).collect()
}

/// Engines that the user named, over as many step sizes as suit them.
pub fn settings_of(engines: &[Spec], quick: bool) -> Vec<Setting> {
    engines.iter().map(|spec| Setting { engine: spec.clone(), counts: counts_of(spec, quick) }).collect()
}

/// Those of the same setting in its engine's entry, or of the first one there.
fn counts_of(spec: &Spec, quick: bool) -> &'static [u64] {
    let entry = spec.entry();
    if entry.tolerance.is_some() {
        return swept::READ;
    }
    let same = entry.sweep.iter().find(|swept| swept.spec == spec.to_string());
    let listed = same.or(entry.sweep.first());
    if !quick {
        return listed.map_or(swept::STEPS, |swept| swept.counts);
    }
    let long = listed.is_none_or(|swept| swept.counts[0] < 100);
    let usual = if long { swept::QUICK_LONG_STEPS } else { swept::QUICK_SHORT_STEPS };
    same.map(|swept| swept.quick).filter(|quick| !quick.is_empty()).unwrap_or(usual)
}

/// The time that a sweep simulates, s: the largest of 1, 2, 5 times a power of ten within the scene's duration, the
/// time that the truth is known for, and [`LONGEST`]. `None` where the truth is not known.
pub(crate) fn span(duration: f64, trusted_until: f64) -> Option<f64> {
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
