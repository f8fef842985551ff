//! A bound that has been checked: its engine, figure and run exist.

use super::need::Need;
use crate::engines::{Spec, SpecError};
use crate::measure::Horizon;
use crate::measure::growth::Verdict;
use crate::model::{Bound, Limit};
use crate::report::record::metrics::{METRICS, Metric, TIME_RATIO, VERDICT};

/// How far, relative to it, a duration may be from a whole number of steps.
const WHOLE: f64 = 1e-9;

/// A bound on one figure of one run.
#[derive(Clone, Debug)]
pub struct Requirement {
    /// Where it stands, such as `bounds[2]`.
    pub key: String,
    pub engine: Spec,
    /// The other engine of a ratio.
    pub against: Option<Spec>,
    pub horizon: Horizon,
    pub metric: &'static Metric,
    pub max: Option<f64>,
    pub min: Option<f64>,
}

/// Why a bound cannot be held to.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BoundError {
    #[error("{key}: metric '{metric}' is not known; metrics are: {known}")]
    UnknownMetric { key: String, metric: String, known: String },
    #[error("{key}: {error}")]
    Engine { key: String, error: SpecError },
    #[error("{key}: {metric}: min {min} is above max {max}; swap them or remove one")]
    MinAboveMax { key: String, metric: &'static str, min: String, max: String },
    #[error("{key}: {metric}: {end} is {value}; give a finite number")]
    NotFinite { key: String, metric: &'static str, end: &'static str, value: f64 },
    #[error("{key}: {metric}: {end} is \"{word}\"; give a number")]
    NotANumber { key: String, metric: &'static str, end: &'static str, word: String },
    #[error("{key}: {metric}: {end} is {value}; verdicts are: \
             {known}", known = Verdict::ALL.map(Verdict::name).join(", "))]
    NotAVerdict { key: String, metric: &'static str, end: &'static str, value: String },
    #[error("{key}: neither max nor min is given; a bound needs one of them or both")]
    NoEnd { key: String },
    #[error("{key}: duration {duration} s is not a whole number of steps of {step} s; use {below} s or {above} s")]
    NotWhole { key: String, duration: f64, step: f64, below: f64, above: f64 },
    #[error("{key}: {problem}")]
    Horizon { key: String, problem: String },
    #[error("{key}: {metric} needs \"against\", the engine that it is a ratio to")]
    AgainstMissing { key: String, metric: &'static str },
    #[error("{key}: \"against\" does not go with {metric}; remove it, or use {TIME_RATIO}")]
    AgainstUnused { key: String, metric: &'static str },
}

impl Requirement {
    /// Checks a bound; `key` is where it stands.
    ///
    /// # Errors
    /// An unknown engine or metric, an end that is no number or verdict, ends that exclude each other, a run that is
    /// not a whole number of steps. The message lists what exists.
    pub fn new(key: &str, bound: &Bound) -> Result<Requirement, BoundError> {
        let named = key.to_owned();
        let metric = METRICS.iter().find(|m| m.name == bound.metric).ok_or_else(|| BoundError::UnknownMetric {
            key: named.clone(),
            metric: bound.metric.clone(),
            known: METRICS.iter().map(|m| m.name).collect::<Vec<_>>().join(", "),
        })?;
        let spec = |text: &str| Spec::parse(text).map_err(|error| BoundError::Engine { key: named.clone(), error });
        let engine = spec(&bound.engine)?;
        let against = bound.against.as_deref().map(spec).transpose()?;
        match (&against, metric.name == TIME_RATIO) {
            (None, true) => return Err(BoundError::AgainstMissing { key: named, metric: metric.name }),
            (Some(_), false) => return Err(BoundError::AgainstUnused { key: named, metric: metric.name }),
            _ => {}
        }
        let end = |end, limit: &Option<Limit>| limit.as_ref().map(|l| value(key, metric, end, l)).transpose();
        let (max, min) = (end("max", &bound.max)?, end("min", &bound.min)?);
        match (max, min) {
            (None, None) => return Err(BoundError::NoEnd { key: named }),
            (Some(max), Some(min)) if min > max => {
                let (min, max) = (shown(metric, min), shown(metric, max));
                return Err(BoundError::MinAboveMax { key: named, metric: metric.name, min, max });
            }
            _ => {}
        }
        Ok(Requirement { horizon: horizon(key, bound)?, key: named, engine, against, metric, max, min })
    }

    /// The engines that it needs.
    pub fn engines(&self) -> impl Iterator<Item = &Spec> {
        std::iter::once(&self.engine).chain(&self.against)
    }

    /// Whether processor time is needed.
    pub fn timed(&self) -> bool {
        self.need().timed
    }

    /// What has to be measured beside the run.
    pub fn need(&self) -> Need {
        let of = |group| self.metric.name.starts_with(group);
        Need { timed: of("time."), compared: of("accuracy."), examined: of("structure.") }
    }

    /// The bound in words: `<= 1e-4`, `between 0 and 1`.
    pub fn limits(&self) -> String {
        match (self.min, self.max) {
            (Some(min), Some(max)) => format!("{} to {}", shown(self.metric, min), shown(self.metric, max)),
            (Some(min), None) => format!("≥ {}", shown(self.metric, min)),
            (None, Some(max)) => format!("≤ {}", shown(self.metric, max)),
            (None, None) => String::new(),
        }
    }
}

/// A value of a figure in words.
pub(crate) fn shown(metric: &Metric, value: f64) -> String {
    match metric.name == VERDICT {
        true => Verdict::ALL.get(value as usize).map_or("?", |v| v.name()).to_string(),
        false if value == 0.0 || (0.01..1000.0).contains(&value.abs()) => format!("{}", (value * 1e3).round() / 1e3),
        false => format!("{value:.1e}"),
    }
}

fn value(key: &str, metric: &'static Metric, end: &'static str, limit: &Limit) -> Result<f64, BoundError> {
    let (key, name) = (key.to_owned(), metric.name);
    match (metric.name == VERDICT, limit) {
        (true, Limit::Word(word)) => match Verdict::ALL.iter().position(|v| v.name() == word) {
            Some(rank) => Ok(rank as f64),
            None => Err(BoundError::NotAVerdict { key, metric: name, end, value: format!("\"{word}\"") }),
        },
        (true, Limit::Number(x)) => Err(BoundError::NotAVerdict { key, metric: name, end, value: x.to_string() }),
        (false, Limit::Word(word)) => Err(BoundError::NotANumber { key, metric: name, end, word: word.clone() }),
        (false, Limit::Number(x)) if x.is_finite() => Ok(*x),
        (false, Limit::Number(x)) => Err(BoundError::NotFinite { key, metric: name, end, value: *x }),
    }
}

fn horizon(key: &str, bound: &Bound) -> Result<Horizon, BoundError> {
    let (step, duration) = (bound.step, bound.duration);
    let horizon = Horizon::nearest(step, duration)
        .map_err(|e| BoundError::Horizon { key: key.to_owned(), problem: e.to_string().replace("--", "") })?;
    if (horizon.steps as f64 * step - duration).abs() <= WHOLE * duration {
        return Ok(horizon);
    }
    let below = (duration / step).floor().max(1.0);
    let of = |count: f64| format!("{:.11e}", count * step).parse().unwrap_or(count * step);
    Err(BoundError::NotWhole { key: key.to_owned(), duration, step, below: of(below), above: of(below + 1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bound() -> Bound {
        Bound {
            engine: "rattle".into(),
            step: 1e-3,
            duration: 1.0,
            metric: "energy.max_relative_error".into(),
            against: None,
            max: Some(Limit::Number(1e-4)),
            min: None,
        }
    }

    fn message(bound: &Bound) -> String {
        Requirement::new("bounds[0]", bound).expect_err("refused").to_string()
    }

    #[test]
    fn a_good_bound_is_taken() {
        let good = Requirement::new("bounds[0]", &bound()).expect("good");
        assert_eq!((good.horizon.steps, good.max, good.min), (1000, Some(1e-4), None));
        let verdict = Bound { metric: VERDICT.into(), max: Some(Limit::Word("random_walk".into())), ..bound() };
        let verdict = Requirement::new("bounds[0]", &verdict).expect("good");
        assert_eq!((verdict.max, verdict.limits().as_str()), (Some(1.0), "≤ random_walk"));
    }

    #[test]
    fn bad_bounds_are_refused_with_what_exists() {
        let unknown = message(&Bound { metric: "energy.maximum".into(), ..bound() });
        assert!(unknown.starts_with("bounds[0]: metric 'energy.maximum' is not known; metrics are: energy.max_rel"));
        let engine = message(&Bound { engine: "ratle".into(), ..bound() });
        assert!(engine.starts_with("bounds[0]: engine 'ratle' is not known; engines are: rattle, "), "{engine}");
        assert_eq!(
            message(&Bound { min: Some(Limit::Number(1e-3)), ..bound() }),
            "bounds[0]: energy.max_relative_error: min 1.0e-3 is above max 1.0e-4; swap them or remove one"
        );
        assert_eq!(
            message(&Bound { max: Some(Limit::Number(f64::NAN)), ..bound() }),
            "bounds[0]: energy.max_relative_error: max is NaN; give a finite number"
        );
        assert_eq!(
            message(&Bound { max: Some(Limit::Word("NaN".into())), ..bound() }),
            "bounds[0]: energy.max_relative_error: max is \"NaN\"; give a number"
        );
        assert_eq!(
            message(&Bound { metric: VERDICT.into(), ..bound() }),
            "bounds[0]: energy.verdict: max is 0.0001; verdicts are: bounded, random_walk, drift, blow_up"
        );
        assert_eq!(
            message(&Bound { step: 0.3, ..bound() }),
            "bounds[0]: duration 1 s is not a whole number of steps of 0.3 s; use 0.9 s or 1.2 s"
        );
        assert_eq!(
            message(&Bound { metric: TIME_RATIO.into(), ..bound() }),
            "bounds[0]: time.us_per_step_ratio needs \"against\", the engine that it is a ratio to"
        );
        assert!(message(&Bound { against: Some("rapier".into()), ..bound() }).contains("\"against\" does not go with"));
    }
}
