//! Every engine at many settings.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::expectation::Expectation;
use super::run::Run;
use crate::engines::Spec;
use crate::measure::convergence::{self, Verdict};
use crate::measure::cost::expectation::{expectations, over_long_times};
use crate::measure::cost::ranking::{self, Standing};
use crate::measure::run::Run as MeasuredRun;
use crate::measure::study::Sweep as MeasuredSweep;
use crate::mechanics::System;
use crate::report::words::expectation::told;

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

impl Sweep {
    /// `compared` are the runs of the comparison that the sweep belongs to.
    pub(super) fn new(sweep: &MeasuredSweep, system: &System, compared: &[MeasuredRun]) -> Sweep {
        let runs: Vec<Run> =
            sweep.runs.iter().map(|run| Run { series: None, start: None, ..Run::new(run, system) }).collect();
        let convergence = convergence::of_settings(&sweep.runs, sweep.error_estimate).into_iter().map(Convergence::new);
        let targets = ranking::targets(&sweep.runs, sweep.error_estimate).into_iter();
        let target = |(max_joint_error, standings): (f64, Vec<Standing>)| Target {
            max_joint_error,
            engines: standings.iter().map(|p| Cheapest::new(p, &sweep.runs[p.run])).collect(),
        };
        let expected = expectations(&sweep.runs, sweep.error_estimate).into_iter().chain(over_long_times(compared));
        Sweep {
            until_s: sweep.until,
            reference_error: sweep.error_estimate,
            runs,
            convergence: convergence.collect(),
            targets: targets.map(target).collect(),
            expectations: expected.map(|judged| told(&judged)).collect(),
        }
    }
}

impl Convergence {
    fn new((engine, found): (&Spec, convergence::Convergence)) -> Convergence {
        Convergence { engine: engine.to_string(), verdict: found.verdict, order: found.order, floor: found.floor }
    }
}

impl Cheapest {
    fn new(standing: &Standing, run: &MeasuredRun) -> Cheapest {
        Cheapest {
            family: run.engine.entry().name.to_string(),
            reached: standing.reached,
            rank: standing.rank,
            engine: run.engine.to_string(),
            step_s: run.horizon.step,
            max_joint_error: standing.error,
            s_per_simulated_s: standing.cost,
        }
    }
}
