//! Comparison with an earlier report: what has become worse by more than its margin.
//!
//! An error is worse when its size is more than `FACTOR` times the earlier one and more than roundoff. A verdict is
//! worse when it comes later in `bounded`, `random_walk`, `drift`, `blow_up`. Processor time is compared as the ratio
//! of `rattle` to another engine in the same report only, and is worse when that ratio has grown by more than
//! `TIME_FACTOR`: a slower machine changes no ratio.

use super::need::Need;
use super::requirement::shown;
use super::run::{self, Unit};
use crate::engines::{self, Spec};
use crate::measure::Horizon;
use crate::mechanics::System;
use crate::report::Report;
use crate::report::record::metrics::{METRICS, Metric, VERDICT};
use crate::report::record::run::{Outcome, Run};

/// An error may grow by this factor.
pub(crate) const FACTOR: f64 = 2.0;

/// A ratio of processor times may grow by this factor.
pub(crate) const TIME_FACTOR: f64 = 1.5;

/// Figures below this are roundoff.
const FLOOR: f64 = 1e-14;

/// Intervals and exponents are judged by the verdict, first states by the energy.
const LEFT_OUT: [&str; 4] =
    ["energy.growth_exponent", "energy.growth_exponent_low", "energy.growth_exponent_high", "start.relative_energy"];

/// The runs of an earlier report that can be taken again, at most `longest` steps each, and those that cannot, in
/// words.
pub(crate) fn units(earlier: &Report, system: &System, longest: u64) -> (Vec<Unit>, Vec<String>) {
    let (mut units, mut lost) = (Vec::new(), Vec::new());
    for old in earlier.runs.iter().filter(|r| r.outcome == Outcome::Completed && r.steps <= longest) {
        let spec = Spec::parse(&old.engine).map_err(|e| e.to_string());
        let able = spec.and_then(|spec| match engines::build(&spec, system, old.step_s) {
            Ok(_) => Ok(spec),
            Err(unsupported) => Err(unsupported.to_string()),
        });
        match (able, Horizon::nearest(old.step_s, old.duration_s)) {
            (Ok(spec), Ok(horizon)) => {
                let need = Need {
                    timed: old.time.is_some() && rivals(earlier, old) > 0,
                    compared: old.accuracy.is_some(),
                    examined: old.structure.is_some(),
                };
                run::add(&mut units, &spec, horizon, need);
            }
            (Err(problem), _) => lost.push(format!("{} at {} s: {problem}", old.engine, old.step_s)),
            (_, Err(problem)) => lost.push(format!("{} at {} s: {problem}", old.engine, old.step_s)),
        }
    }
    (units, lost)
}

/// Timed runs of other engines over the same horizon.
fn rivals(report: &Report, run: &Run) -> usize {
    let timed = |r: &&Run| r.time.is_some() && r.engine != run.engine && same_horizon(r, run);
    report.runs.iter().filter(timed).count()
}

fn same_horizon(a: &Run, b: &Run) -> bool {
    a.step_s == b.step_s && a.steps == b.steps
}

/// The same run in another report, a timed one where there is one.
fn again<'a>(report: &'a Report, run: &Run) -> Option<&'a Run> {
    let same = report.runs.iter().filter(|r| r.engine == run.engine && same_horizon(r, run));
    same.max_by_key(|r| r.time.is_some())
}

/// A figure that has become worse.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Worse {
    pub engine: String,
    pub step_s: f64,
    pub metric: String,
    pub sentence: String,
}

/// Compares the runs that both reports have; the number of figures compared comes with what is worse.
pub(crate) fn compare(earlier: &Report, now: &Report) -> (usize, Vec<Worse>) {
    let (mut compared, mut worse) = (0, Vec::new());
    for old in earlier.runs.iter().filter(|r| r.outcome == Outcome::Completed) {
        let Some(new) = again(now, old) else { continue };
        let mut tell = |metric: &str, was: String, is: String| {
            let sentence =
                format!("{}, {} steps of {} s: {metric} was {was} and is {is}", old.engine, old.steps, old.step_s);
            worse.push(Worse { engine: old.engine.clone(), step_s: old.step_s, metric: metric.to_string(), sentence });
        };
        for metric in METRICS.iter().filter(|m| !m.name.starts_with("time.") && !LEFT_OUT.contains(&m.name)) {
            let Some(was) = (metric.value)(old) else { continue };
            compared += 1;
            match (metric.value)(new) {
                Some(is) if new.outcome == Outcome::Completed && !worsened(metric, was, is) => {}
                Some(is) => tell(metric.name, shown(metric, was), shown(metric, is)),
                None => tell(metric.name, shown(metric, was), format!("absent ({})", new.outcome.words())),
            }
        }
        for (name, was, is) in ratios(earlier, now, old, new) {
            compared += 1;
            if !(is <= TIME_FACTOR * was) {
                tell(&name, format!("{was:.2}"), format!("{is:.2}"));
            }
        }
    }
    (compared, worse)
}

fn worsened(metric: &Metric, was: f64, is: f64) -> bool {
    match metric.name == VERDICT {
        true => !(is <= was),
        false => !(is.abs() <= FACTOR * was.abs()) && !(is.abs() <= FLOOR),
    }
}

/// Processor time of a run of `rattle` over that of every other engine with the same horizon, in both reports. Only so:
/// a `rattle` that has become faster must not count against another engine.
fn ratios(earlier: &Report, now: &Report, old: &Run, new: &Run) -> Vec<(String, f64, f64)> {
    let time = |run: &Run| run.time.as_ref().map(|t| t.us_per_step);
    let ours = |run: &Run| run.engine.split(':').next() == Some("rattle");
    let mut found = Vec::new();
    for other in earlier.runs.iter().filter(|r| ours(old) && !ours(r) && same_horizon(r, old)) {
        let rerun = again(now, other);
        if let (Some(a), Some(b), Some(c), Some(d)) = (time(old), time(other), time(new), rerun.and_then(time)) {
            found.push((format!("time.us_per_step_ratio to {}", other.engine), a / b, c / d));
        }
    }
    found
}
