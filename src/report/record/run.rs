//! One engine at one step size.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::reference::Accuracy;
use super::series::{Series, series};
use super::solver::Solver;
use super::structure::Structure;
use super::time::{Time, time};
use crate::measure::growth::Verdict;
use crate::measure::outcome::Outcome as Ended;
use crate::measure::run::Run as MeasuredRun;
use crate::measure::trace::{MomentumError, Trace};
use crate::mechanics::System;

/// One engine at one step size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Run {
    /// Engine spec.
    pub engine: String,
    pub step_s: f64,
    /// Time that the run was to end at; the duration asked for, or the nearest whole number of steps.
    pub duration_s: f64,
    pub steps: u64,
    pub outcome: Outcome,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outcome_detail: Option<String>,
    /// Where the run ended, if before `duration_s`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ended_at_s: Option<f64>,
    /// Differences between the engine's state before the first step and the scene's initial state.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<Start>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energy: Option<Energy>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub constraint: Option<Constraint>,
    /// Only where the scene conserves a component of momentum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub momentum: Option<Momentum>,
    /// Largest turn of a body in a step, rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn_per_step: Option<f64>,
    /// Why the figures may mislead although the run went through.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warning: Option<String>,
    /// What the constraint solver took, for engines that count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solver: Option<Solver>,
    /// Position errors against the reference.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<Accuracy>,
    /// What a few steps preserve of the structure of the motion; only where it was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub structure: Option<Structure>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<Time>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub series: Option<Series>,
}

/// The engine of a spec without its settings.
pub fn family(engine: &str) -> &str {
    engine.split(':').next().unwrap_or_default()
}

impl Run {
    /// Largest joint position error of a completed run, rad or m.
    pub(crate) fn joint_error(&self) -> Option<f64> {
        self.accuracy.as_ref().filter(|_| self.outcome == Outcome::Completed).map(|a| a.max_joint_error)
    }

    /// Processor seconds a simulated second of a completed run, from the lower decile over the rounds.
    pub fn cost(&self) -> Option<f64> {
        let time = self.time.as_ref().filter(|_| self.outcome == Outcome::Completed)?;
        Some(1e-6 * time.us_per_step_low.unwrap_or(time.us_per_step) / self.step_s)
    }
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    Completed,
    Diverged,
    NotConverged,
    Unsupported,
    OverBudget,
}

impl Outcome {
    /// For tables.
    pub fn words(self) -> &'static str {
        match self {
            Outcome::Completed => "completed",
            Outcome::Diverged => "diverged",
            Outcome::NotConverged => "not converged",
            Outcome::Unsupported => "unsupported",
            Outcome::OverBudget => "over budget",
        }
    }
}

/// Largest differences of the first state; sizes of vectors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Start {
    pub position_m: f64,
    pub attitude_rad: f64,
    pub velocity_m_per_s: f64,
    pub angular_velocity_rad_per_s: f64,
    /// Over the energy scale.
    pub relative_energy: f64,
}

/// Energy errors over the energy scale. In damped scenes the work of the dampers is added first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Energy {
    #[serde(rename = "scale_J")]
    pub scale_j: f64,
    /// Largest absolute value over all steps.
    pub max_relative_error: f64,
    /// At the end of the run, negative where energy was lost.
    pub final_relative_error: f64,
    /// Slope of a straight line through the error, 1/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slope_per_s: Option<f64>,
    /// The error grows like this power of time; 0 where no growth was established.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub growth_exponent: Option<f64>,
    /// Its 95 % confidence interval.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub growth_exponent_interval: Option<[f64; 2]>,
    /// Absent where the run was too short to be judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    /// For an engine whose positions and velocities belong to different times: the same errors with the positions moved
    /// back to the time of the velocities. Slope, exponent and verdict above are of these then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_level_corrected: Option<CorrectedEnergy>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CorrectedEnergy {
    pub max_relative_error: f64,
    pub final_relative_error: f64,
}

/// Largest joint residuals over all steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Constraint {
    /// m or rad
    pub max_position: f64,
    /// m/s or rad/s
    pub max_velocity: f64,
}

/// Errors of the conserved components of momentum.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Momentum {
    pub max_relative_error: f64,
    pub components: Vec<MomentumComponent>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MomentumComponent {
    pub name: String,
    /// What the error is divided by, kg m/s or kg m^2/s.
    pub scale: f64,
    pub max_relative_error: f64,
}

impl Run {
    pub(super) fn new(run: &MeasuredRun, system: &System) -> Run {
        let trace = &run.trace;
        let (outcome, outcome_detail) = match &trace.outcome {
            Ended::Completed => (Outcome::Completed, None),
            Ended::Diverged { detail } => (Outcome::Diverged, Some(detail.clone())),
            Ended::NotConverged { detail } => (Outcome::NotConverged, Some(detail.clone())),
            Ended::Unsupported { detail } => (Outcome::Unsupported, Some(detail.clone())),
            Ended::OverBudget { detail } => (Outcome::OverBudget, Some(detail.clone())),
        };
        Run {
            engine: run.engine.to_string(),
            step_s: run.horizon.step,
            duration_s: run.horizon.end,
            steps: run.horizon.steps,
            outcome,
            outcome_detail,
            ended_at_s: (outcome != Outcome::Completed).then_some(trace.ended_at),
            start: trace.start.map(|s| Start {
                position_m: s.position,
                attitude_rad: s.attitude,
                velocity_m_per_s: s.velocity,
                angular_velocity_rad_per_s: s.angular_velocity,
                relative_energy: s.energy,
            }),
            energy: energy(trace, system.energy_scale),
            constraint: trace
                .residual
                .map(|r| Constraint { max_position: r.position, max_velocity: r.velocity })
                .filter(|_| system.bodies.iter().any(|b| b.joint.kind.degrees_of_freedom() < 6)),
            momentum: momentum(&trace.momentum),
            turn_per_step: trace.turn_per_step,
            warning: trace.warning.clone(),
            solver: trace.solver.as_ref().map(Solver::from),
            accuracy: trace.accuracy.map(Accuracy::new),
            structure: run.structure.as_ref().map(Structure::from),
            time: run.timing.map(|t| time(t, run.horizon.step)),
            series: (!trace.series.blocks.is_empty()).then(|| series(trace)),
        }
    }
}

fn energy(trace: &Trace, scale_j: f64) -> Option<Energy> {
    let growth = trace.growth;
    trace.energy.map(|e| Energy {
        scale_j,
        max_relative_error: e.max,
        final_relative_error: e.last,
        slope_per_s: growth.and_then(|g| g.slope_per_s),
        growth_exponent: growth.and_then(|g| g.exponent).map(|e| e.value),
        growth_exponent_interval: growth.and_then(|g| g.exponent).map(|e| [e.low, e.high]),
        verdict: growth.map(|g| g.verdict),
        time_level_corrected: trace
            .time_level_corrected
            .map(|e| CorrectedEnergy { max_relative_error: e.max, final_relative_error: e.last }),
    })
}

fn momentum(errors: &[MomentumError]) -> Option<Momentum> {
    let components: Vec<MomentumComponent> = errors
        .iter()
        .map(|e| MomentumComponent { name: e.name.clone(), scale: e.scale, max_relative_error: e.max })
        .collect();
    let max_relative_error = components.iter().map(|c| c.max_relative_error).reduce(f64::max)?;
    Some(Momentum { max_relative_error, components })
}
