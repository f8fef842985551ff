//! Negative controls: integrators that should break the bounds, put in the place of the engine that a bound is about.
//!
//! A bound that none of them breaks shows nothing about an integrator. That may be right (coordinates without
//! constraints cannot violate any), but it should be known.

use super::judge::{Finding, judge};
use super::requirement::Requirement;
use crate::engines::{self, Role, Spec};
use crate::mechanics::System;
use crate::report::Report;

/// The engines that serve as controls.
pub(crate) fn available() -> Vec<Spec> {
    engines::line_up(Role::Control).into_iter().filter_map(|text| Spec::parse(text).ok()).collect()
}

/// What the controls made of one bound.
#[derive(Clone, Debug)]
pub(crate) struct Control {
    pub requirement: Requirement,
    /// Controls that broke it, with the figure that they had.
    pub caught: Vec<(String, String)>,
    /// Controls that kept it.
    pub passed: Vec<(String, String)>,
}

/// The bounds that controls can break, each with a control in the place of its engine. Bounds on time are left out.
pub(crate) fn requirements(bounds: &[Requirement], controls: &[Spec], system: &System) -> Vec<Requirement> {
    let able = |spec: &&Spec, step: f64| engines::build(spec, system, step).is_ok();
    let judged = bounds.iter().filter(|r| !r.timed());
    judged
        .flat_map(|r| {
            let specs = controls.iter().filter(move |spec| able(spec, r.horizon.step));
            specs.map(|spec| Requirement { engine: spec.clone(), ..r.clone() })
        })
        .collect()
}

/// Sorts out which control broke which bound.
pub(crate) fn results(bounds: &[Requirement], controlled: &[Requirement], report: &Report) -> Vec<Control> {
    let findings = judge(controlled, report);
    let judged = bounds.iter().filter(|r| !r.timed());
    judged
        .map(|required| {
            let of = |passed: bool| {
                let these = findings.iter().filter(|f| f.requirement.key == required.key && f.passed == passed);
                these.map(|f| (f.requirement.engine.to_string(), figure(f))).collect::<Vec<_>>()
            };
            Control { requirement: required.clone(), caught: of(false), passed: of(true) }
        })
        .collect()
}

fn figure(finding: &Finding) -> String {
    match (&finding.measured, &finding.detail) {
        (None, Some(detail)) => detail.split(':').next().unwrap_or_default().to_string(),
        _ => finding.measured_text(),
    }
}

/// A line for each bound, those that catch nothing last and named as such.
pub(crate) fn text(scene: &str, controls: &[Control]) -> String {
    if available().is_empty() {
        return format!("{scene}: this version has no engine that serves as a control\n");
    }
    let mut text = format!("{scene}: controls\n");
    let (catching, idle): (Vec<&Control>, Vec<&Control>) = controls.iter().partition(|c| !c.caught.is_empty());
    let list =
        |items: &[(String, String)]| items.iter().map(|(e, f)| format!("{e} ({f})")).collect::<Vec<_>>().join(", ");
    for c in catching {
        let missed = if c.passed.is_empty() { String::new() } else { format!("; not by {}", list(&c.passed)) };
        text += &format!("  {}: broken by {}{missed}\n", name(&c.requirement), list(&c.caught));
    }
    for c in idle {
        let kept = if c.passed.is_empty() { "no control can run this scene".to_string() } else { list(&c.passed) };
        text += &format!("  {}: CATCHES NOTHING: {kept}\n", name(&c.requirement));
    }
    text
}

fn name(required: &Requirement) -> String {
    let r = required;
    format!("{} {} {}, {} steps of {} s", r.key, r.metric.name, r.limits(), r.horizon.steps, r.horizon.step)
}
