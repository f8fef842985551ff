//! Whether the figures of a report keep to the bounds.

use super::requirement::Requirement;
use super::requirement::shown;
use super::run::TRUTH_BUDGET;
use crate::engines::Spec;
use crate::measure::growth::MIN_STEPS;
use crate::report::Report;
use crate::report::record::metrics::TIME_RATIO;
use crate::report::record::run::{Outcome, Run};

/// What became of one bound.
#[derive(Clone, Debug)]
pub struct Finding {
    pub requirement: Requirement,
    /// Absent where the figure could not be had.
    pub measured: Option<f64>,
    /// Why the figure could not be had, or why it does not count.
    pub detail: Option<String>,
    pub passed: bool,
}

impl Finding {
    /// The figure in words.
    pub(crate) fn measured_text(&self) -> String {
        self.measured.map_or("–".to_string(), |x| shown(self.requirement.metric, x))
    }

    /// One line: what was required, what was found.
    pub fn sentence(&self) -> String {
        let r = &self.requirement;
        let against = r.against.as_ref().map(|spec| format!(" against {spec}")).unwrap_or_default();
        let detail = self.detail.as_ref().map(|d| format!(" ({d})")).unwrap_or_default();
        let run = format!("{}{against}, {} steps of {} s", r.engine, r.horizon.steps, r.horizon.step);
        format!("{}: {} is {}, required {}{detail}", run, r.metric.name, self.measured_text(), r.limits())
    }
}

/// Compares every requirement with the run of the report that it is about.
pub fn judge(requirements: &[Requirement], report: &Report) -> Vec<Finding> {
    requirements.iter().map(|required| find(required, report)).collect()
}

fn find(required: &Requirement, report: &Report) -> Finding {
    let lost =
        |detail: String| Finding { requirement: required.clone(), measured: None, detail: Some(detail), passed: false };
    let Some(run) = run_of(report, &required.engine, required) else {
        return lost("the run is missing".to_string());
    };
    let measured = match &required.against {
        Some(other) => run_of(report, other, required).and_then(|other| ratio(run, other)),
        None => (required.metric.value)(run),
    };
    let completed = run.outcome == Outcome::Completed;
    let Some(x) = measured.filter(|x| x.is_finite()) else {
        return lost(if completed { absent(required) } else { ended(run) });
    };
    // Written so that what is not a number passes nothing.
    let kept = required.max.is_none_or(|max| x <= max) && required.min.is_none_or(|min| x >= min);
    Finding {
        requirement: required.clone(),
        measured: Some(x),
        detail: if completed { compared_until(run, required) } else { Some(ended(run)) },
        passed: completed && kept,
    }
}

/// The run of an engine over the horizon of a requirement.
fn run_of<'a>(report: &'a Report, engine: &Spec, required: &Requirement) -> Option<&'a Run> {
    let (name, horizon) = (engine.to_string(), required.horizon);
    report.runs.iter().find(|r| {
        let timed = r.time.is_some() || !required.timed();
        r.engine == name && r.step_s == horizon.step && r.steps == horizon.steps && timed
    })
}

/// How far positions were compared with the truth, where that is not to the end.
fn compared_until(run: &Run, required: &Requirement) -> Option<String> {
    let until = run.accuracy.as_ref().filter(|_| required.need().compared)?.until_s;
    let whole = until > required.horizon.end * (1.0 - 1e-9);
    (!whole).then(|| format!("compared up to {until} s, as far as the truth is known"))
}

fn ratio(run: &Run, other: &Run) -> Option<f64> {
    Some(run.time.as_ref()?.us_per_step / other.time.as_ref()?.us_per_step)
}

fn ended(run: &Run) -> String {
    let detail = run.outcome_detail.as_deref().unwrap_or("no detail");
    format!("{}: {detail}", run.outcome.words())
}

fn absent(required: &Requirement) -> String {
    let metric = required.metric.name;
    if metric == TIME_RATIO {
        return "one of the two engines has no timing".to_string();
    }
    if metric.starts_with("energy.") && required.horizon.steps < MIN_STEPS {
        return format!("a run of {} steps is too short to be judged; take {MIN_STEPS}", required.horizon.steps);
    }
    if required.need().compared {
        let budget = TRUTH_BUDGET.as_secs();
        return format!(
            "no truth to compare with: the reference does not take this scene or needs more than {budget} s"
        );
    }
    "this scene has no such figure".to_string()
}
