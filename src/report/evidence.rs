//! The parts of a report that say how far it can be believed: reference, parity, timing, and the sweep of settings.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::expectation::{Expectation, expectations, over_long_times};
use super::front;
use super::record::Run;
use crate::engines::Spec;
use crate::measure::accuracy::Accuracy as MeasuredAccuracy;
use crate::measure::clock::Effort;
use crate::measure::comparison::Run as MeasuredRun;
use crate::measure::convergence::{self, Verdict};
use crate::measure::parity::Parity as MeasuredParity;
use crate::measure::ranking::{self, Place};
use crate::measure::study::{Findings, Sweep as MeasuredSweep};
use crate::measure::sweep::chooses_steps;
use crate::measure::truth::Truth;
use crate::mechanics::System;

/// The trajectory that positions are compared with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reference {
    pub method: String,
    /// Largest estimated error up to `trusted_until_s`: of positions over the reach of the system, of attitudes in rad.
    pub error_estimate: f64,
    /// Where the estimate passes 1e-8, or the end of the run.
    pub trusted_until_s: f64,
}

/// Position errors against the reference, at common times up to `until_s`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Accuracy {
    /// Largest difference of a joint position, rad or m, and when it was met.
    pub max_joint_error: f64,
    pub at_s: f64,
    /// Over all joints and times.
    pub rms_joint_error: f64,
    /// Of the bodies' centres of mass.
    pub max_position_error_m: f64,
    pub rms_position_error_m: f64,
    /// Of the bodies' attitudes.
    pub max_attitude_error_rad: f64,
    pub rms_attitude_error_rad: f64,
    pub until_s: f64,
    pub samples: usize,
}

/// The evidence that all engines were given one mechanical system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Parity {
    /// Whether every figure of every engine stands within its bound.
    pub agrees: bool,
    pub engines: Vec<EngineParity>,
}

/// Differences between what an engine has at t = 0 and the system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EngineParity {
    pub engine: String,
    pub agrees: bool,
    /// Largest relative differences of masses and principal moments, and distance of a centre of mass, as read back from
    /// the engine; absent for engines that compute on the system itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub com_m: Option<f64>,
    /// Over the energy scale.
    pub energy: f64,
    /// Over `sqrt(2 m E)` and `sqrt(2 I E)`, with the energy scale `E`.
    pub linear_momentum: f64,
    pub angular_momentum: f64,
    /// Largest difference of a joint acceleration from the reference, over the largest of them (or 1 rad/s^2 or m/s^2).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration: Option<f64>,
    /// The same with the constraints solved to the end, where the engine's settings leave them half solved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration_solved: Option<f64>,
    /// What the figures are held to: accelerations, solved where there are two, to the second bound, the others to the first.
    pub bound: f64,
    /// Absent where accelerations are told and not judged: motions that the steps do not resolve, and single precision with
    /// constraints that iterations solve or with velocities whose roundoff hides the accelerations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration_bound: Option<f64>,
}

/// How processor times were measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Timing {
    pub method: String,
    pub rounds: usize,
    /// What the loop around a step takes; it is part of every figure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overhead_us_per_step: Option<f64>,
}

/// Every engine at many settings, over the first part of the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sweep {
    pub until_s: f64,
    /// Largest estimated error of the reference until then.
    pub reference_error: f64,
    /// Without their series.
    pub runs: Vec<Run>,
    pub convergence: Vec<Convergence>,
    /// The cheapest setting of each engine for some accuracies; absent where the runs were not timed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub targets: Vec<Target>,
    /// What is expected of the engines' order, as far as the runs can tell.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub expectations: Vec<Expectation>,
}

/// How the joint position error of an engine falls with its step size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Convergence {
    /// Engine spec.
    pub engine: String,
    pub verdict: Verdict,
    /// Slope of the error over the step size, both logarithmic, at the finest steps whose errors are above the floor,
    /// roundoff and what the reference leaves uncertain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<f64>,
    /// The smallest error, where it has stopped falling, rad or m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floor: Option<f64>,
}

/// What a joint position error costs each engine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Target {
    /// rad or m
    pub max_joint_error: f64,
    pub engines: Vec<Cheapest>,
}

/// The cheapest setting of an engine that reaches a target, or the one that comes nearest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cheapest {
    /// The engine without its settings.
    pub family: String,
    pub reached: bool,
    /// 1 where no engine reaches the target for less. Engines share a rank whose costs differ by less than 15 %.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rank: Option<usize>,
    pub engine: String,
    pub step_s: f64,
    pub max_joint_error: f64,
    /// From the lower decile over the rounds, which other work on the machine moves least.
    pub s_per_simulated_s: f64,
}

impl Reference {
    pub(super) fn new(truth: &Truth) -> Reference {
        Reference {
            method: truth.method.clone(),
            error_estimate: truth.error_estimate(),
            trusted_until_s: truth.trusted_until,
        }
    }
}

impl Accuracy {
    pub(super) fn new(found: MeasuredAccuracy) -> Accuracy {
        Accuracy {
            max_joint_error: found.joint.max,
            at_s: found.joint.at,
            rms_joint_error: found.joint.rms,
            max_position_error_m: found.position.max,
            rms_position_error_m: found.position.rms,
            max_attitude_error_rad: found.attitude.max,
            rms_attitude_error_rad: found.attitude.rms,
            until_s: found.until,
            samples: found.samples,
        }
    }
}

impl Parity {
    /// `None` where no engine could be looked at.
    pub(super) fn new(found: &[MeasuredParity]) -> Option<Parity> {
        let engines: Vec<EngineParity> = found
            .iter()
            .map(|p| EngineParity {
                engine: p.engine.clone(),
                agrees: p.agrees(),
                mass: p.held.map(|h| h.mass),
                inertia: p.held.map(|h| h.inertia),
                com_m: p.held.map(|h| h.com),
                energy: p.start.energy,
                linear_momentum: p.momentum[0],
                angular_momentum: p.momentum[1],
                acceleration: p.acceleration,
                acceleration_solved: p.acceleration_solved,
                bound: p.bounds.system,
                acceleration_bound: p.bounds.acceleration,
            })
            .collect();
        (!engines.is_empty()).then(|| Parity { agrees: engines.iter().all(|e| e.agrees), engines })
    }
}

impl Timing {
    pub(super) fn new(findings: &Findings) -> Timing {
        Timing {
            method: format!(
                "processor time of the stepping thread, engines in turns round by round, median over the rounds; settings of the \
                 sweep that decide a rank in {} rounds, and costs compared by the lower decile",
                Effort::RANKING.rounds
            ),
            rounds: Effort::FULL.rounds,
            overhead_us_per_step: findings.overhead.map(|seconds| 1e6 * seconds),
        }
    }
}

impl Sweep {
    /// `compared` are the runs of the comparison that the sweep belongs to.
    pub(super) fn new(sweep: &MeasuredSweep, system: &System, compared: &[Run]) -> Sweep {
        let runs: Vec<Run> =
            sweep.runs.iter().map(|run| Run { series: None, start: None, ..Run::new(run, system) }).collect();
        let convergence = convergence(&runs, sweep.error_estimate);
        let targets = targets(sweep);
        let mut expectations = expectations(&runs, sweep.error_estimate);
        expectations.extend(over_long_times(compared));
        Sweep { until_s: sweep.until, reference_error: sweep.error_estimate, runs, convergence, targets, expectations }
    }
}

/// For every engine that was run at several step sizes. One that chooses its own has none.
fn convergence(runs: &[Run], reference_error: f64) -> Vec<Convergence> {
    let fixed_steps = |run: &Run| !Spec::parse(&run.engine).is_ok_and(|spec| chooses_steps(&spec));
    runs.chunk_by(|a, b| a.engine == b.engine)
        .filter(|runs| fixed_steps(&runs[0]))
        .filter_map(|runs| {
            let points: Vec<(f64, f64)> = runs.iter().filter_map(|r| Some((r.step_s, front::error(r)?))).collect();
            let found = convergence::judge(&points, reference_error)?;
            let engine = runs[0].engine.clone();
            Some(Convergence { engine, verdict: found.verdict, order: found.order, floor: found.floor })
        })
        .collect()
}

/// Targets that the reference is good enough to judge.
fn targets(sweep: &MeasuredSweep) -> Vec<Target> {
    let judged = ranking::TARGETS.into_iter().filter(|target| ranking::is_judged(*target, sweep.error_estimate));
    let found = judged.map(|target| {
        let places = ranking::rank(&sweep.runs, target);
        Target {
            max_joint_error: target,
            engines: places.iter().map(|p| Cheapest::new(p, &sweep.runs[p.run])).collect(),
        }
    });
    found.filter(|target| !target.engines.is_empty()).collect()
}

impl Cheapest {
    fn new(place: &Place, run: &MeasuredRun) -> Cheapest {
        Cheapest {
            family: run.engine.entry().name.to_string(),
            reached: place.reached,
            rank: place.rank,
            engine: run.engine.to_string(),
            step_s: run.horizon.step,
            max_joint_error: place.error,
            s_per_simulated_s: place.cost,
        }
    }
}
