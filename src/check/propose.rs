//! Bounds from what is measured: the smallest of 1, 2, 5 times a power of ten that is at least twice the figure.

use crate::engines::{Spec, SpecError};
use crate::measure::growth::Verdict;
use crate::measure::{Horizon, HorizonError};
use crate::model::scene::{BoundFile, BoundsFile};
use crate::model::{Limit, Scene};
use crate::report::Report;
use crate::report::record::metrics::{METRICS, VERDICT};
use crate::report::record::run::{Outcome, Run};

use super::need::Need;
use super::run::{self, Unit};
use super::scope::QUICK_STEPS;

/// Figures of this size are roundoff of the arithmetic; no bound is proposed below.
const FLOOR: f64 = 1e-15;

/// Figures that others bound already, that are intervals, or that depend on the machine.
const LEFT_OUT: [&str; 6] = [
    "energy.final_relative_error",
    "energy.time_level_corrected.final_relative_error",
    "energy.slope_per_s",
    "energy.growth_exponent",
    "energy.growth_exponent_low",
    "energy.growth_exponent_high",
];

/// A bound for a figure: `0.5 -> 1`, `1.1e-6 -> 5e-6`.
pub(crate) fn rounded_up(figure: f64) -> f64 {
    let target = (2.0 * figure.abs()).max(FLOOR);
    let exponent = target.log10().floor() as i32;
    // Read from decimal text, so that the number is the one that a file spells.
    let candidates = (exponent - 1..=exponent + 1)
        .flat_map(|e| [1, 2, 5].map(|m| format!("{m}e{e}").parse::<f64>().unwrap_or(f64::INFINITY)));
    candidates.into_iter().find(|c| *c >= target).unwrap_or(target)
}

/// The runs that a proposal measures for a scene without bounds: `rattle` over 1e5 steps, at the scene's step that is
/// nearest to 1 ms.
///
/// # Errors
/// None that the scenes of this program meet.
pub(crate) fn default_units(scene: &Scene) -> Result<Vec<Unit>, ProposeError> {
    let far = |step: &f64| (step / 1e-3).ln().abs();
    let step = scene.steps.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(1e-3);
    let horizon = Horizon::nearest(step, step * QUICK_STEPS as f64)?;
    let mut units = Vec::new();
    run::add(&mut units, &Spec::parse("rattle")?, horizon, Need::default());
    Ok(units)
}

/// Why there is nothing to propose.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ProposeError {
    #[error(transparent)]
    Spec(#[from] SpecError),
    #[error(transparent)]
    Horizon(#[from] HorizonError),
}

/// A bound for every figure of every completed run, except for processor time and signed figures.
pub fn bounds(report: &Report) -> BoundsFile {
    let completed = report.runs.iter().filter(|run| run.outcome == Outcome::Completed);
    BoundsFile { bounds: completed.flat_map(of_run).collect() }
}

fn of_run(run: &Run) -> Vec<BoundFile> {
    let proposed = |name: &str| !name.starts_with("time.") && !name.starts_with("start.") && !LEFT_OUT.contains(&name);
    METRICS
        .iter()
        .filter(|metric| proposed(metric.name))
        .filter_map(|metric| {
            let figure = (metric.value)(run).filter(|x| x.is_finite())?;
            let max = match metric.name == VERDICT {
                true => Limit::Word(Verdict::ALL.get(figure as usize)?.name().to_owned()),
                false => Limit::Number(rounded_up(figure)),
            };
            Some(BoundFile {
                engine: run.engine.clone(),
                step: run.step_s,
                duration: run.duration_s,
                metric: metric.name.to_owned(),
                against: None,
                max: Some(max),
                min: None,
            })
        })
        .collect()
}

/// One bound a line, as scene files have them.
///
/// # Errors
/// None that bounds of this program can meet.
pub fn json(file: &BoundsFile) -> serde_json::Result<String> {
    let lines = file.bounds.iter().map(serde_json::to_string).collect::<serde_json::Result<Vec<String>>>()?;
    Ok(format!("{{\n  \"bounds\": [\n    {}\n  ]\n}}\n", lines.join(",\n    ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_round_and_at_least_twice_the_figure() {
        let pairs =
            [(0.5, 1.0), (0.51, 2.0), (1.1e-6, 5e-6), (2.5e-6, 5e-6), (2.6e-6, 1e-5), (-3e-4, 1e-3), (0.0, 1e-15)];
        for (figure, bound) in pairs {
            assert_eq!(rounded_up(figure), bound, "{figure}");
        }
        let mut figure = 1e-14;
        while figure < 1e3 {
            let bound = rounded_up(figure);
            assert!(bound >= 2.0 * figure && bound <= 5.0 * figure * (1.0 + 1e-12), "{figure} {bound}");
            figure *= 1.07;
        }
    }
}
