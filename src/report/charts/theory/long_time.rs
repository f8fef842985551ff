//! `long-time.png`: what each method conserves, a row each.

use plotters::coord::ranged1d::{BoldPoints, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::super::axis::Axis;
use super::super::canvas::{self, Area, ChartError};
use super::super::legend;
use super::super::panel::draw_marker;
use super::super::style::{
    self, BLACK, BLUE, FAINT, GREEN, GRID, INK, Look, Marker, ORANGE, VERMILLION, WIDTH, at, px,
};
use crate::report::record::theory::long_time::LongTimeRecord;

/// Height of a row, pixels, and where the rows begin.
const ROW: u32 = 27;
const ABOVE: u32 = 130;
const BELOW: u32 = 108;
/// Room for the names, and the margin at the right.
const NAMES: u32 = 360;
const RIGHT: u32 = 40;

struct Quantity {
    name: &'static str,
    look: Look,
    value: fn(&LongTimeRecord) -> f64,
}

const QUANTITIES: [Quantity; 4] = [
    Quantity {
        name: "energy error, J",
        look: Look { colour: BLUE, marker: Marker::Circle },
        value: |r| r.energy_error_j,
    },
    Quantity {
        name: "energy drift, J",
        look: Look { colour: ORANGE, marker: Marker::Diamond },
        value: |r| r.energy_drift_j,
    },
    Quantity {
        name: "momentum error, kg m²/s",
        look: Look { colour: GREEN, marker: Marker::Triangle },
        value: |r| r.momentum_error,
    },
    Quantity {
        name: "form defect",
        look: Look { colour: BLACK, marker: Marker::Square },
        value: |r| r.symplecticity_defect,
    },
];

pub fn draw(rows: &[LongTimeRecord]) -> Result<Vec<u8>, ChartError> {
    let values = rows.iter().flat_map(|r| QUANTITIES.iter().map(|q| (q.value)(r)));
    let x = Axis::decades(values, -17, 2).unwrap_or(Axis::Log { from: -17, to: 0 });
    let looks: Vec<(&str, Look)> = QUANTITIES.iter().map(|q| (q.name, q.look)).collect();
    let length = rows.first().map(|r| format!("{} steps of {} s", r.steps, r.step_s)).unwrap_or_default();
    let title = format!("What is conserved over {length}");
    let subtitle = "Particle in a radial potential; further left is better. RK4, which is not variational, is \
                    the last row";
    let bottom = ABOVE + ROW * rows.len() as u32;
    canvas::render_of_height(bottom + BELOW, |area| {
        legend::frame(area, &title, subtitle, &looks, &[])?;
        grid(area, x, bottom)?;
        for (k, row) in rows.iter().enumerate() {
            let middle = at(ABOVE + k as u32 * ROW + ROW / 2);
            if !row.variational {
                let corners = [(at(12), middle - at(ROW / 2)), (at(WIDTH - 12), middle + at(ROW / 2))];
                area.draw(&Rectangle::new(corners, VERMILLION.mix(0.14).filled()))?;
            }
            let ink = style::font(style::NOTE, INK).pos(Pos::new(HPos::Left, VPos::Center));
            area.draw(&Text::new(row.method.clone(), (at(24), middle), ink))?;
            // Every other quantity stands a little lower: where two figures agree both are seen.
            for (i, quantity) in QUANTITIES.iter().enumerate() {
                let place = (column(x, (quantity.value)(row)), middle + if i % 2 == 0 { -at(4) } else { at(4) });
                draw_marker(area, place, quantity.look, false)?;
            }
        }
        Ok(())
    })
}

fn column(x: Axis, value: f64) -> i32 {
    x.map(&x.clamped(value), (at(NAMES), at(WIDTH - RIGHT)))
}

/// Lines at powers of ten with their names below, and lines between the rows.
fn grid(area: &Area, x: Axis, bottom: u32) -> Result<(), ChartError> {
    let line = |from: (i32, i32), to: (i32, i32), colour: RGBColor| {
        area.draw(&PathElement::new(vec![from, to], colour.stroke_width(px(1))))
    };
    for k in 0..=(bottom - ABOVE) / ROW {
        let y = at(ABOVE + k * ROW);
        line((at(NAMES), y), (at(WIDTH - RIGHT), y), FAINT)?;
    }
    for value in x.key_points(BoldPoints(12)) {
        line((column(x, value), at(ABOVE)), (column(x, value), at(bottom)), GRID)?;
    }
    let below = |y: u32| (at(bottom + y), Pos::new(HPos::Center, VPos::Top));
    for value in x.key_points(BoldPoints(12)) {
        let (y, anchor) = below(8);
        let text = Text::new(x.format_ext(&value), (column(x, value), y), style::font(style::TICK, INK).pos(anchor));
        area.draw(&text)?;
    }
    let (y, anchor) = below(44);
    let centre = (at(NAMES) + at(WIDTH - RIGHT)) / 2;
    area.draw(&Text::new("error or defect", (centre, y), style::font(style::LABEL, INK).pos(anchor)))?;
    Ok(())
}
