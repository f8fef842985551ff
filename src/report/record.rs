//! `report.json`: what was compared, on what, and every figure. A figure that could not be had is absent.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::evidence::{Accuracy, Parity, Reference, Sweep, Timing};
use crate::measure::clock;
use crate::measure::comparison::{Results, Run as MeasuredRun};
use crate::measure::growth::Verdict;
use crate::measure::series::{Block, Extent};
use crate::measure::study::Findings;
use crate::measure::trace::{self, MomentumError, Outcome as Ended, Trace};
use crate::mechanics::System;
use crate::model::{Ignored, Scene};

pub use super::structure::{CorrectedStructure, Memory, MomentumMap, Reversibility, Structure, Symplecticity};

/// Name and version of the format.
pub const SCHEMA: &str = "rattlebench/report/1";

/// A comparison of engines on one scene. Everything but `machine` and what is measured by the clock (`timing`, the
/// `time` of each run, the `targets` of the sweep) is the same, byte for byte, whenever the same program compares the same
/// scene by the same command and no run goes over its budget.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    /// Always `rattlebench/report/1`.
    pub schema: String,
    pub scene: SceneRecord,
    pub machine: Machine,
    pub versions: Versions,
    /// The command line that wrote this report.
    pub command: String,
    /// The comparison was interrupted: runs or their timing are missing.
    #[serde(default, skip_serializing_if = "is_false")]
    pub interrupted: bool,
    /// The evidence that all engines were given one mechanical system.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parity: Option<Parity>,
    /// What positions are compared with; absent where no truth could be found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<Reference>,
    /// How processor times were measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timing: Option<Timing>,
    pub runs: Vec<Run>,
    /// Every engine at many settings, over the first part of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<Sweep>,
}

/// What was simulated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SceneRecord {
    pub name: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
    /// Moving bodies; links that fixed joints hold together are one.
    pub bodies: usize,
    /// Joints between them, the ground's included.
    pub joints: usize,
    pub degrees_of_freedom: usize,
    pub loops: usize,
    /// m/s^2
    pub gravity: [f64; 3],
    /// kg
    pub mass_kg: f64,
    /// What relative energy errors are divided by, J.
    pub energy_scale_j: f64,
    /// What an engine must be able to do.
    pub needs: Vec<String>,
    /// What the files hold and no run used.
    pub ignored: Vec<Ignored>,
    /// What was read but deserves a second look.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<String>,
}

/// The machine that the timings are from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Machine {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub logical_cores: Option<usize>,
    pub os: String,
    pub architecture: String,
}

/// The programs that the figures are from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Versions {
    pub rattlebench: String,
    /// Versions of the crates that the results depend on, as locked.
    pub crates: std::collections::BTreeMap<String, String>,
    /// The compiler.
    pub rustc: String,
    /// `release`, or `dev` for a build without full optimisation, whose timings mean little.
    pub profile: String,
}

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

/// Processor time of the stepping alone, on one thread.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Time {
    /// Median over the repeats.
    pub us_per_step: f64,
    /// A tenth of the repeats took less, none where they are few. Costs are compared by it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub us_per_step_low: Option<f64>,
    pub us_per_step_min: f64,
    pub us_per_step_max: f64,
    /// Processor seconds for a simulated second.
    pub s_per_simulated_s: f64,
    pub repeats: usize,
    /// Steps of one repeat, counted from the start of the run; long runs are timed over their first part.
    pub steps: u64,
}

/// The run in at most 400 blocks of consecutive steps, six digits.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Series {
    /// Middle of each block, s.
    pub time_s: Vec<f64>,
    /// Smallest and largest signed relative energy error in each block.
    pub energy_min: Vec<f64>,
    pub energy_max: Vec<f64>,
    /// Largest absolute time-level-corrected relative energy error in each block.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corrected_energy: Option<Vec<f64>>,
    /// Largest residuals in each block.
    pub constraint_position: Vec<f64>,
    pub constraint_velocity: Vec<f64>,
}

impl Report {
    /// The record of a comparison.
    pub fn new(scene: &Scene, system: &System, results: &Results, command: String) -> Report {
        Report {
            schema: SCHEMA.to_string(),
            scene: SceneRecord::new(scene, system),
            machine: super::environment::machine(),
            versions: super::environment::versions(),
            command,
            interrupted: results.interrupted,
            parity: None,
            reference: None,
            timing: None,
            sweep: None,
            runs: results.runs.iter().map(|run| Run::new(run, system)).collect(),
        }
    }

    /// The record of a comparison with the evidence for it.
    pub fn of_study(scene: &Scene, system: &System, findings: &Findings, command: String) -> Report {
        let plain = Report::new(scene, system, &findings.results, command);
        Report {
            parity: Parity::new(&findings.parity),
            reference: findings.truth.as_ref().map(Reference::new),
            timing: findings.overhead.map(|_| Timing::new(findings)),
            sweep: findings.sweep.as_ref().map(|sweep| Sweep::new(sweep, system, &plain.runs)),
            ..plain
        }
    }

    /// As JSON with a final newline.
    ///
    /// # Errors
    /// None that a report built by this program can meet.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string(self).map(|text| text + "\n")
    }

    /// Reads a report.
    ///
    /// # Errors
    /// Text that is not JSON, another schema, a missing or misshapen field.
    pub fn from_json(text: &str) -> Result<Report, ReadError> {
        #[derive(Deserialize)]
        struct Head {
            schema: Option<String>,
        }
        let head: Head = serde_json::from_str(text)?;
        match head.schema {
            Some(schema) if schema == SCHEMA => Ok(serde_json::from_str(text)?),
            Some(schema) => Err(ReadError::Schema { schema }),
            None => Err(ReadError::NoSchema),
        }
    }
}

/// Why a report could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    #[error("not a report: {0}")]
    Json(#[from] serde_json::Error),
    #[error("not a report: \"schema\" is missing; this program reads \"{SCHEMA}\"")]
    NoSchema,
    #[error("\"schema\" is \"{schema}\"; this program reads \"{SCHEMA}\"")]
    Schema { schema: String },
}

impl SceneRecord {
    fn new(scene: &Scene, system: &System) -> SceneRecord {
        SceneRecord {
            name: scene.name.clone(),
            description: scene.description.clone(),
            bodies: system.bodies.len(),
            joints: system.bodies.len(),
            degrees_of_freedom: system.degrees_of_freedom(),
            loops: scene.loops.len(),
            gravity: system.gravity.into(),
            mass_kg: system.bodies.iter().map(|b| b.mass).sum(),
            energy_scale_j: system.energy_scale,
            needs: scene.needs(),
            ignored: scene.model.ignored.clone(),
            remarks: scene.model.remarks.clone(),
        }
    }
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

fn time(timing: clock::Timing, step: f64) -> Time {
    Time {
        us_per_step: 1e6 * timing.median,
        us_per_step_low: Some(1e6 * timing.low),
        us_per_step_min: 1e6 * timing.min,
        us_per_step_max: 1e6 * timing.max,
        s_per_simulated_s: timing.median / step,
        repeats: timing.rounds,
        steps: timing.steps,
    }
}

fn series(trace: &Trace) -> Series {
    let column = |pick: &dyn Fn(&Block<{ trace::QUANTITIES }>) -> f64| {
        trace.series.blocks.iter().map(|b| six_digits(pick(b))).collect::<Vec<f64>>()
    };
    let of = |quantity: usize, pick: fn(&Extent) -> f64| column(&|b| pick(&b.values[quantity]));
    Series {
        time_s: column(&|b| 0.5 * (b.from + b.to)),
        energy_min: of(trace::ENERGY, |e| e.min),
        energy_max: of(trace::ENERGY, |e| e.max),
        corrected_energy: trace.time_level_corrected.map(|_| of(trace::CORRECTED_ENERGY, |e| e.amplitude())),
        constraint_position: of(trace::POSITION, |e| e.max),
        constraint_velocity: of(trace::VELOCITY, |e| e.max),
    }
}

fn six_digits(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

fn is_false(value: &bool) -> bool {
    !value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_schema_is_refused_by_name() {
        let message = |text: &str| Report::from_json(text).expect_err("refused").to_string();
        assert_eq!(
            message(r#"{"schema":"rattlebench/report/2"}"#),
            r#""schema" is "rattlebench/report/2"; this program reads "rattlebench/report/1""#
        );
        assert_eq!(message("{}"), r#"not a report: "schema" is missing; this program reads "rattlebench/report/1""#);
        assert!(message("{").starts_with("not a report: EOF while parsing"));
        assert!(message(r#"{"schema":"rattlebench/report/1"}"#).starts_with("not a report: missing field `scene`"));
    }

    #[test]
    fn series_keep_six_digits() {
        assert_eq!(six_digits(-1.234_567_89e-7), -1.23457e-7);
        assert_eq!(six_digits(0.0), 0.0);
    }
}
