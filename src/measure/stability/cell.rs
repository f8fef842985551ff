//! One cell of a suite: a scene at a value of its parameter, an engine, a step.

use std::sync::atomic::{AtomicBool, AtomicU64};
use std::time::Duration;

use super::budget;
use super::class::{Class, Evidence, classify};
use super::scan::{Family, Scan};
use super::true_samples::{self, TrueSamples};
use super::watch::Watched;
use crate::engines::{self, Spec};
use crate::measure::Horizon;
use crate::measure::growth::Stretch;
use crate::measure::outcome::{Limits, Outcome};
use crate::measure::trace::{CORRECTED_ENERGY, EnergyError, Trace, trace};
use crate::mechanics::{CompileError, System};

/// A scan at one value of its parameter.
#[derive(Debug)]
pub struct Case {
    pub family: &'static Family,
    pub scan: &'static Scan,
    pub value: f64,
    /// The system, or why there is none.
    pub system: Result<System, CompileError>,
}

/// What is run.
#[derive(Clone, Copy, Debug)]
pub struct Cell<'a> {
    pub case: &'a Case,
    pub engine: &'a Spec,
    /// In units of the scan's clock.
    pub step: f64,
}

/// What came out. A figure that could not be had is `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    pub class: Class,
    /// Why a run was refused, or not begun, or where it was lost.
    pub reason: Option<String>,
    /// s
    pub step: f64,
    pub steps_taken: u64,
    /// s
    pub ended_at: f64,
    /// Energy error over the energy scale, time-level-corrected where the engine has a lag.
    pub energy: Option<EnergyError>,
    /// Over the length of a link, or rad.
    pub joint_gap: Option<f64>,
    /// Over the reach of the scene, or rad.
    pub pose_error: Option<f64>,
    /// s up to which the truth was known, and how it was found; `None` where it was not.
    pub truth_until: Option<f64>,
    pub truth: Option<String>,
    /// Largest turn of a body in a step, rad.
    pub turn_per_step: Option<f64>,
    /// Why the figures may mislead although the run went through.
    pub warning: Option<String>,
}

impl Case {
    pub fn new(family: &'static Family, scan: &'static Scan, value: f64) -> Case {
        Case { family, scan, value, system: System::compile(&(scan.scene)(value)) }
    }

    /// What finding the truth will cost, nominal s.
    #[cfg(test)]
    pub(super) fn truth_cost(&self) -> f64 {
        self.system.as_ref().map_or(0.0, |system| true_samples::cost(self.scan, self.value, system.bodies.len()))
    }

    /// `None` where it was interrupted.
    pub fn truth(&self, interrupted: &AtomicBool) -> Option<TrueSamples> {
        match &self.system {
            Ok(system) => true_samples::find(self.scan, self.value, system, interrupted),
            Err(_) => Some(TrueSamples::nothing()),
        }
    }
}

impl Cell<'_> {
    /// The run's steps.
    pub fn horizon(&self) -> Horizon {
        let Case { scan, value, .. } = self.case;
        let (step, end) = (self.step * (scan.clock)(*value), scan.duration(*value, self.step));
        Horizon { step, steps: (end / step).round().max(1.0) as u64, end }
    }

    /// What the run will cost, nominal s; nothing where it will not be begun.
    pub fn cost(&self) -> f64 {
        let Ok(system) = &self.case.system else { return 0.0 };
        let cost = budget::seconds(self.engine, system.bodies.len(), self.horizon().steps);
        if cost > budget::ALLOWANCE { 0.0 } else { cost }
    }

    /// Runs the cell. `None` where it was interrupted.
    pub fn run(&self, truth: &TrueSamples, interrupted: &AtomicBool) -> Option<Finding> {
        let horizon = self.horizon();
        let nothing = |class, reason| Some(Finding::without_run(class, reason, horizon.step));
        let system = match &self.case.system {
            Ok(system) => system,
            Err(error) => return nothing(Class::Refused, Some(error.to_string())),
        };
        if let Err(reason) = budget::check(self.engine, system.bodies.len(), horizon.steps) {
            return nothing(Class::OverBudget, Some(reason));
        }
        let engine = match engines::build(self.engine, system, horizon.step) {
            Ok(engine) => engine,
            Err(unsupported) => return nothing(Class::Refused, Some(unsupported.to_string())),
        };
        let mut watched = Watched::new(engine, system, horizon);
        let limits = Limits { budget: Duration::MAX, interrupted, taken: &AtomicU64::new(0) };
        let trace = trace(system, &mut watched, horizon, &limits)?;
        let measured = trace.steps > 0;
        let pose_error = truth.error(&watched.samples);
        let class = classify(&Evidence {
            outcome: Some(&trace.outcome),
            energy: &stretches(&trace),
            joint_gap: watched.joint_gap,
            pose_error,
        });
        Some(Finding {
            steps_taken: trace.steps,
            ended_at: trace.ended_at,
            energy: trace.time_level_corrected.or(trace.energy),
            joint_gap: measured.then_some(watched.joint_gap),
            pose_error,
            truth_until: pose_error.map(|_| truth.part() * horizon.end),
            truth: pose_error.map(|_| truth.method.clone()),
            turn_per_step: trace.turn_per_step,
            warning: trace.warning,
            ..Finding::without_run(class, reason(&trace.outcome), horizon.step)
        })
    }
}

impl Finding {
    fn without_run(class: Class, reason: Option<String>, step: f64) -> Finding {
        Finding {
            class,
            reason,
            step,
            steps_taken: 0,
            ended_at: 0.0,
            energy: None,
            joint_gap: None,
            pose_error: None,
            truth_until: None,
            truth: None,
            turn_per_step: None,
            warning: None,
        }
    }
}

fn stretches(trace: &Trace) -> Vec<Stretch> {
    let blocks = trace.series.blocks.iter();
    blocks.map(|b| Stretch { to: b.to, count: b.count, error: b.values[CORRECTED_ENERGY] }).collect()
}

fn reason(outcome: &Outcome) -> Option<String> {
    match outcome {
        Outcome::Completed => None,
        Outcome::Diverged { detail }
        | Outcome::NotConverged { detail }
        | Outcome::Unsupported { detail }
        | Outcome::OverBudget { detail } => Some(detail.clone()),
    }
}
