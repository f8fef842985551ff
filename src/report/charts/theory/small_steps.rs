//! `small-steps.png`: error of the acceleration from one step, in (q, v) and in positions, against the step size.

use super::super::axis::Axis;
use super::super::canvas::{self, ChartError};
use super::super::legend;
use super::super::panel::{Panel, Words};
use super::super::style::{BLUE, GREEN, Look, Marker, VERMILLION};
use crate::report::record::theory::small_steps::{SmallStepRecord, SmallStepsRecord};

const IN_VELOCITY: (&str, Look) = ("(q, v) form of the midpoint rule", Look { colour: BLUE, marker: Marker::Circle });
const CURVED: (&str, Look) = ("(q, v) form on parabolas", Look { colour: GREEN, marker: Marker::Triangle });
const IN_POSITION: (&str, Look) =
    ("its position form, (q₂ − 2q₁ + q₀)/h²", Look { colour: VERMILLION, marker: Marker::Square });

pub fn draw(problems: &[SmallStepsRecord]) -> Result<Vec<u8>, ChartError> {
    let steps = || problems.iter().flat_map(|p| &p.steps);
    let errors = steps().flat_map(|s| [s.blown_up, s.curved, s.position_form]);
    let x = Axis::decades(steps().map(|s| s.step_s), -14, 0).unwrap_or(Axis::Log { from: -12, to: 0 });
    let y = Axis::decades(errors, -17, 12).unwrap_or(Axis::Log { from: -17, to: 2 });
    let subtitle = "Error of the acceleration from one step; the error of the methods themselves is O(h²)";
    let mut note =
        "From 10⁻³ s up the two forms of the midpoint rule agree. Where the error of the position form stops \
         growing, its second difference is below roundoff and reads 0."
            .to_string();
    if steps().any(|s| s.blown_up == 0.0 || s.curved == 0.0) {
        note += " A point on the lower edge: an error of exactly 0.";
    }
    canvas::render(|area| {
        let area = legend::frame(
            area,
            "Accuracy as the step goes to zero",
            subtitle,
            &[IN_VELOCITY, IN_POSITION, CURVED],
            &[note],
        )?;
        let width = area.dim_in_pixel().0 / problems.len().max(1) as u32;
        let mut rest = area;
        for (i, problem) in problems.iter().enumerate() {
            let (panel_area, right) = rest.split_horizontally(width);
            let y_words = (i == 0).then_some("error of the acceleration, s⁻²");
            let panel = Panel::new(&panel_area, x, y, Words { heading: &problem.problem, x: "step, s", y: y_words })?;
            curve(&panel, problem, IN_POSITION.1, |s| s.position_form)?;
            curve(&panel, problem, CURVED.1, |s| s.curved)?;
            curve(&panel, problem, IN_VELOCITY.1, |s| s.blown_up)?;
            rest = right;
        }
        Ok(())
    })
}

fn curve(
    panel: &Panel,
    problem: &SmallStepsRecord,
    look: Look,
    error: fn(&SmallStepRecord) -> f64,
) -> Result<(), ChartError> {
    let points: Vec<(f64, f64)> = problem.steps.iter().map(|s| (s.step_s, error(s))).collect();
    panel.line(&points, look, 2, false)?;
    points.iter().try_for_each(|point| panel.mark(*point, look, false))
}
