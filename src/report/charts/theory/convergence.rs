//! `convergence.png`: the error of one step of the map and of F+ against the step size, for one method of each order.

use super::super::axis::Axis;
use super::super::canvas::{self, ChartError};
use super::super::legend;
use super::super::panel::{Label, Panel, Words};
use super::super::style::{BLACK, BLUE, GREEN, Look, Marker, ORANGE, PURPLE, VERMILLION};
use crate::report::record::theory::orders::{ErrorRecord, OrderRecord, OrdersRecord};
use crate::report::words::number::two_decimals;

/// One method of each order of the list.
const METHODS: [(&str, Look); 6] = [
    ("symplectic Euler A (alpha = 1)", Look { colour: VERMILLION, marker: Marker::Square }),
    ("Stoermer-Verlet", Look { colour: BLUE, marker: Marker::Circle }),
    ("Ruth 3", Look { colour: ORANGE, marker: Marker::Triangle }),
    ("Lobatto IIIA-IIIB 3", Look { colour: GREEN, marker: Marker::TriangleDown }),
    ("Gauss-Legendre 3", Look { colour: PURPLE, marker: Marker::Diamond }),
    ("Gauss-Legendre 4", Look { colour: BLACK, marker: Marker::Circle }),
];

/// Errors below this are roundoff of the solves and not shown.
const FLOOR: f64 = 3e-14;

/// A panel: what errs, and its measured order.
struct Subject {
    heading: &'static str,
    error: fn(&ErrorRecord) -> f64,
    order: fn(&OrderRecord) -> Option<f64>,
}

const SUBJECTS: [Subject; 2] = [
    Subject { heading: "discrete Hamiltonian map", error: |e| e.map, order: |r| r.measured.map },
    Subject {
        heading: "discrete Legendre transform F+",
        error: |e| e.legendre_plus,
        order: |r| r.measured.legendre_plus,
    },
];

pub fn draw(problem: &OrdersRecord) -> Result<Vec<u8>, ChartError> {
    let shown: Vec<(&OrderRecord, Look)> = METHODS
        .iter()
        .filter_map(|(name, look)| Some((problem.methods.iter().find(|r| r.method == *name)?, *look)))
        .collect();
    let looks: Vec<(&str, Look)> = shown.iter().map(|(r, look)| (r.method.as_str(), *look)).collect();
    let errors = || shown.iter().flat_map(|(r, _)| &r.errors);
    let x = Axis::decades(errors().map(|e| e.step_s), -4, 0).unwrap_or(Axis::Log { from: -3, to: 0 });
    let values = errors().flat_map(|e| [e.map, e.legendre_plus]).filter(|e| *e > FLOOR);
    let y = Axis::decades(values, -15, 2).unwrap_or(Axis::Log { from: -15, to: 0 });
    let title = format!("Error of one step: {}", problem.problem);
    let subtitle = "Order r means an error of O(h^(r+1)) in one step; the fitted order stands at each line";
    canvas::render(|area| {
        let area = legend::frame(area, &title, subtitle, &looks, &[])?;
        let width = area.dim_in_pixel().0 / SUBJECTS.len() as u32;
        let mut rest = area;
        for (i, subject) in SUBJECTS.iter().enumerate() {
            let (panel_area, right) = rest.split_horizontally(width);
            let words = Words { heading: subject.heading, x: "step, s", y: (i == 0).then_some("error of one step") };
            let panel = Panel::new(&panel_area, x, y, words)?;
            let (mut labels, mut lines) = (Vec::new(), Vec::new());
            for (row, look) in &shown {
                let points: Vec<(f64, f64)> = row
                    .errors
                    .iter()
                    .map(|e| (e.step_s, (subject.error)(e)))
                    .take_while(|(_, error)| *error > FLOOR)
                    .collect();
                panel.line(&points, *look, 2, false)?;
                points.iter().try_for_each(|point| panel.mark(*point, *look, false))?;
                if let (Some(order), Some(point)) = ((subject.order)(row), points.last()) {
                    labels.push(Label { point: *point, words: two_decimals(order), look: *look });
                }
                lines.push(points);
            }
            panel.labels(&labels, &lines)?;
            rest = right;
        }
        Ok(())
    })
}
