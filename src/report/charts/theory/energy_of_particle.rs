//! `figure1.png`, `figure2.png`: the energy of a variational method and of RK4 against the true energy.

use super::super::axis::Axis;
use super::super::canvas::{self, ChartError};
use super::super::panel::{Panel, Words};
use super::super::style::{BLACK, BLUE, Look, Marker, VERMILLION};
use super::super::{legend, style};
use crate::report::record::theory::energy::{CurveRecord, EnergyRecord};
use crate::report::words::number::plain;

/// The truth, the variational method, RK4.
const LOOKS: [Look; 3] = [
    Look { colour: BLACK, marker: Marker::Diamond },
    Look { colour: BLUE, marker: Marker::Circle },
    Look { colour: VERMILLION, marker: Marker::Square },
];

/// Free space above and below the curves, of their height.
const PADDING: f64 = 0.06;

pub fn draw(record: &EnergyRecord, title: &str) -> Result<Vec<u8>, ChartError> {
    let energies = || record.curves.iter().flat_map(|c| &c.energy_j).copied();
    let (low, high) = (energies().fold(f64::INFINITY, f64::min), energies().fold(f64::NEG_INFINITY, f64::max));
    let padding = PADDING * (high - low);
    let y = Axis::Linear { from: low - padding, to: high + padding };
    let end = record.curves.iter().flat_map(|c| &c.time_s).copied().fold(0.0, f64::max);
    let looks: Vec<(&str, Look)> = record.curves.iter().map(|c| c.method.as_str()).zip(LOOKS).collect();
    let step = record.curves.iter().find_map(|c| c.step_s).unwrap_or_default();
    let subtitle = format!("Both methods at a step of {} s; one step in 16 is shown", plain(step, 3));
    canvas::render(|area| {
        let area = legend::frame(area, title, &subtitle, &looks, &[])?;
        let words =
            Words { heading: "particle in the plane, V = |q|²(|q|² − 1)²", x: "time, s", y: Some("energy, J") };
        let panel = Panel::new(&area, Axis::Linear { from: 0.0, to: end }, y, words)?;
        // The truth last: it must be seen where a method lies on it.
        for (turn, (curve, look)) in record.curves.iter().zip(LOOKS).enumerate().rev() {
            draw_curve(&panel, curve, look, turn)?;
        }
        Ok(())
    })
}

fn draw_curve(panel: &Panel, curve: &CurveRecord, look: style::Look, turn: usize) -> Result<(), ChartError> {
    let points: Vec<(f64, f64)> = curve.time_s.iter().copied().zip(curve.energy_j.iter().copied()).collect();
    let truth = curve.step_s.is_none();
    panel.line(&points, look, if truth { 3 } else { 2 }, truth)?;
    // A few markers tell the curves apart without colour.
    for k in 0..5 {
        if let Some(point) = points.get(points.len() * (4 * k + turn + 1) / 22).filter(|_| points.len() > 2) {
            panel.mark(*point, look, false)?;
        }
    }
    Ok(())
}
