//! `orders.png`: the order table as a picture, each cell shaded by its order.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::super::canvas::{self, Area, ChartError};
use super::super::legend;
use super::super::style::{self, BLUE, GREY, INK, VERMILLION, at};
use crate::report::record::theory::orders::{OrderRecord, OrdersRecord};
use crate::report::words::number::two_decimals;

/// Height of a row and widths of the columns, pixels.
const ROW: u32 = 27;
const NAMES: u32 = 350;
const CELL: u32 = 98;
const GAP: u32 = 20;
/// Where the table begins, from the left.
const LEFT: u32 = 24;
/// Heights of what is above and below the rows.
const ABOVE: u32 = 160;
const BELOW: u32 = 58;

const COLUMNS: [&str; 4] = ["L_d", "F−", "F+", "map"];
/// The highest order of the list has the deepest shade.
const HIGHEST: f64 = 8.0;
/// The cell of a measured order further from theory than this has another colour.
const TOLERANCE: f64 = 0.15;

pub fn draw(problems: &[OrdersRecord]) -> Result<Vec<u8>, ChartError> {
    let names: Vec<&str> = problems
        .iter()
        .max_by_key(|p| p.methods.len())
        .map_or(vec![], |p| p.methods.iter().map(|r| r.method.as_str()).collect());
    let subtitle = "Order r: an error of O(h^(r+1)) in one step. Deeper shade, higher order";
    let note =
        format!("Orange where further than {TOLERANCE} from theory. Empty: the method needs a constant mass matrix.");
    canvas::render_of_height(ABOVE + ROW * names.len() as u32 + BELOW, |area| {
        legend::frame(area, "Measured orders of all methods", subtitle, &[], &[note])?;
        for (i, problem) in problems.iter().enumerate() {
            let left = LEFT + NAMES + i as u32 * (4 * CELL + GAP);
            let centre = (at(left + 2 * CELL), at(ABOVE - 52));
            area.draw(&Text::new(problem.problem.clone(), centre, centred(style::bold(style::LABEL, INK))))?;
            for (j, column) in COLUMNS.iter().enumerate() {
                let centre = (at(left + j as u32 * CELL + CELL / 2), at(ABOVE - 20));
                area.draw(&Text::new(*column, centre, centred(style::font(style::TICK, GREY))))?;
            }
        }
        for (k, name) in names.iter().enumerate() {
            let top = ABOVE + k as u32 * ROW;
            let place = (at(LEFT), at(top + ROW / 2));
            let beside = style::font(style::NOTE, INK).pos(Pos::new(HPos::Left, VPos::Center));
            area.draw(&Text::new(*name, place, beside))?;
            for (i, problem) in problems.iter().enumerate() {
                let Some(row) = problem.methods.iter().find(|r| r.method == *name) else { continue };
                cells(area, row, LEFT + NAMES + i as u32 * (4 * CELL + GAP), top)?;
            }
        }
        Ok(())
    })
}

fn cells(area: &Area, row: &OrderRecord, left: u32, top: u32) -> Result<(), ChartError> {
    for (j, (measured, theory)) in row.measured.list().into_iter().zip(row.theory.list()).enumerate() {
        let Some(order) = measured else { continue };
        let x = left + j as u32 * CELL;
        let far = !theory.is_some_and(|t| (order - t).abs() <= TOLERANCE);
        let depth = 0.06 + 0.74 * (order / HIGHEST).clamp(0.0, 1.0);
        let shade = if far { VERMILLION.mix(0.45) } else { BLUE.mix(depth) };
        let corners = [(at(x + 1), at(top + 1)), (at(x + CELL - 1), at(top + ROW - 1))];
        area.draw(&Rectangle::new(corners, shade.filled()))?;
        let colour = if !far && order > 0.8 * HIGHEST { WHITE } else { INK };
        let centre = (at(x + CELL / 2), at(top + ROW / 2));
        area.draw(&Text::new(two_decimals(order), centre, centred(style::font(style::NOTE, colour))))?;
    }
    Ok(())
}

fn centred(style: TextStyle<'static>) -> TextStyle<'static> {
    style.pos(Pos::new(HPos::Center, VPos::Center))
}
