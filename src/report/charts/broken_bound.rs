//! A run with a bound that it broke: the largest values in `INTERVALS` intervals of time, and the
//! bound drawn in.

use super::axis::Axis;
use super::canvas::{self, ChartError};
use super::panel::{Panel, Words};
use super::style::{BLUE, Look, Marker, VERMILLION};
use super::{legend, time_panels};
use crate::report::record::run::Run;
use crate::report::record::series::Series;
use crate::report::words::number::duration;

/// What the chart tells beside the run.
#[derive(Debug)]
pub(crate) struct Broken<'a> {
    pub scene: &'a str,
    pub metric: &'a str,
    pub unit: &'a str,
    /// In words.
    pub measured: &'a str,
    pub required: &'a str,
    /// The figure and the ends of the bound; a verdict has none.
    pub figure: Option<f64>,
    pub max: Option<f64>,
    pub min: Option<f64>,
}

const FLOOR: i32 = -18;
const CEILING: i32 = 6;
const THIS: Look = Look { colour: BLUE, marker: Marker::Circle };
const BOUND: Look = Look { colour: VERMILLION, marker: Marker::Diamond };

/// Draws the quantity that the figure was taken from, where the run keeps it as a series, else the figure itself as a
/// level.
///
/// # Errors
/// A canvas that cannot be drawn on.
pub(crate) fn draw(run: &Run, broken: &Broken) -> Result<Vec<u8>, ChartError> {
    let curve = curve(run, broken);
    let end = run.duration_s;
    let levels: Vec<Vec<(f64, f64)>> = guides(run, broken, &curve);
    let shown = || curve.iter().chain(levels.iter().flatten()).map(|p| p.1.abs());
    let y = Axis::decades(shown(), FLOOR, CEILING).unwrap_or(Axis::Log { from: -1, to: 1 });
    let x = Axis::Linear { from: 0.0, to: end };
    let title = format!("Bound broken: {} of {}", broken.metric, broken.scene);
    let subtitle = format!(
        "{} over {} steps of {}: {}, required {}",
        run.engine,
        run.steps,
        duration(run.step_s),
        broken.measured,
        broken.required
    );
    let bound = match series_of(broken.metric) {
        Some(_) if is_law(broken.metric) => "the growth that the bound allows",
        _ => "the bound",
    };
    let looks = [(run.engine.as_str(), THIS), (bound, BOUND)];
    let notes: Vec<String> = run.outcome_detail.iter().map(|d| format!("{}: {d}", run.outcome.words())).collect();
    let (words, _) = series_of(broken.metric).unwrap_or((broken.metric, |_| Vec::new()));
    let axis = if broken.unit.is_empty() || series_of(broken.metric).is_some() {
        words.to_string()
    } else {
        format!("{words}, {}", broken.unit)
    };
    canvas::render(|area| {
        let area = legend::frame(area, &title, &subtitle, &looks, &notes)?;
        let panel = Panel::new(&area, x, y, Words { heading: "", x: "time, s", y: Some(&axis) })?;
        for level in &levels {
            panel.line(level, BOUND, 3, true)?;
            for k in [1, 5] {
                let (from, to) = (level[0], level[level.len() - 1]);
                let along = f64::from(k) / 6.0;
                let point = if level.len() == 2 {
                    (from.0 + along * (to.0 - from.0), to.1)
                } else {
                    level[k as usize * level.len() / 6]
                };
                panel.mark(point, BOUND, false)?;
            }
        }
        panel.line(&curve, THIS, 2, false)?;
        for k in 1..4 {
            if let Some(point) = curve.get(k * curve.len() / 4) {
                panel.mark(*point, THIS, false)?;
            }
        }
        if let (Some(last), Some(at)) = (curve.last(), run.ended_at_s) {
            panel.cross((at, last.1), THIS)?;
        }
        Ok(())
    })
}

/// Words for the axis, and the values of a series.
type Of = (&'static str, fn(&Series) -> Vec<f64>);

fn series_of(metric: &str) -> Option<Of> {
    let energy: Of = ("relative energy error", |s| {
        s.energy_min.iter().zip(&s.energy_max).map(|(a, b)| a.abs().max(b.abs())).collect()
    });
    match metric {
        "constraint.max_position" => Some(("joint error, m or rad", |s| s.constraint_position.clone())),
        "constraint.max_velocity" => Some(("joint velocity error, m/s or rad/s", |s| s.constraint_velocity.clone())),
        m if m.starts_with("energy.time_level_corrected") => {
            Some(("corrected relative energy error", |s| s.corrected_energy.clone().unwrap_or_default()))
        }
        m if m.starts_with("energy.") => Some(energy),
        _ => None,
    }
}

/// Figures that bound how an error grows and not how large it is.
fn is_law(metric: &str) -> bool {
    metric == "energy.verdict" || metric.starts_with("energy.growth_exponent") || metric == "energy.slope_per_s"
}

fn curve(run: &Run, broken: &Broken) -> Vec<(f64, f64)> {
    let series = run.series.as_ref().zip(series_of(broken.metric));
    let points = series.map(|(series, (_, values))| {
        time_panels::largest_in_intervals(&series.time_s, &values(series), run.duration_s)
    });
    match points {
        Some(points) if !Vec::is_empty(&points) => points,
        _ => broken.figure.map(|x| vec![(0.0, x.abs()), (run.duration_s, x.abs())]).unwrap_or_default(),
    }
}

/// The ends of the bound as lines: levels, or for a law of growth the error of the run's first tenth carried on by it.
fn guides(run: &Run, broken: &Broken, curve: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
    let end = run.duration_s;
    let ends = broken.max.into_iter().chain(broken.min);
    if !is_law(broken.metric) {
        return ends.map(|x| vec![(0.0, x.abs()), (end, x.abs())]).collect();
    }
    let tenth = curve.iter().filter(|p| p.0 <= 0.1 * end).map(|p| p.1).fold(0.0, f64::max);
    let grown = |power: f64| {
        (1..=60)
            .map(|k| 0.1 * end + 0.9 * end * f64::from(k) / 60.0)
            .map(|t| (t, tenth * (t / (0.1 * end)).powf(power)))
            .collect()
    };
    match broken.metric {
        "energy.slope_per_s" => {
            ends.map(|x| (1..=60).map(|k| end * f64::from(k) / 60.0).map(|t| (t, x.abs() * t)).collect()).collect()
        }
        "energy.verdict" => ends.map(|rank| grown([0.0, 0.5, 1.0][(rank as usize).min(2)])).collect(),
        _ => ends.map(grown).collect(),
    }
}
