//! `stability_<family>.png`: the class of every cell, the parameter against the step, engines side by side.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{self, Area, ChartError};
use super::legend;
use super::style::{self, BLACK, BLUE, GREY, GRID, INK, ORANGE, PURPLE, VERMILLION, WIDTH, at, px};
use crate::measure::stability::Class;
use crate::report::record::stability::{CellRecord, FamilyRecord, ScanRecord};
use crate::report::words::number::{compact, duration, plain};

const LEFT: u32 = 24;
/// Room for the words of the steps.
const STEPS: u32 = 100;
const GAP: u32 = 14;
const CELL_HEIGHT: u32 = 27;
/// Above the cells of a scan: its title; below: the values of its parameter.
const TITLE_HEIGHT: u32 = 34;
const VALUES_HEIGHT: u32 = 40;
/// Title, question, legend and names of engines.
const ABOVE: u32 = 232;
const LEGEND_TOP: u32 = 98;
const SMALL: u32 = 15;

/// How a class looks: fill, colour of its letter, letter.
fn look(class: Class) -> (RGBColor, RGBColor, &'static str) {
    match class {
        Class::Accurate => (BLUE, WHITE, "A"),
        Class::Bounded => (RGBColor(160, 210, 240), INK, "B"),
        Class::Drifting => (RGBColor(240, 228, 66), INK, "D"),
        Class::Dissipating => (ORANGE, INK, "L"),
        Class::Gaining => (VERMILLION, WHITE, "G"),
        Class::ConstraintBroken => (PURPLE, INK, "J"),
        Class::BlowUp => (BLACK, WHITE, "X"),
        Class::Refused => (WHITE, INK, "R"),
        Class::OverBudget => (GRID, GREY, "–"),
    }
}

/// What the legend says of a class.
fn meaning(class: Class) -> &'static str {
    match class {
        Class::Accurate => "accurate",
        Class::Bounded => "bounded energy error",
        Class::Drifting => "drifting",
        Class::Dissipating => "loses energy",
        Class::Gaining => "gains energy",
        Class::ConstraintBroken => "joints apart",
        Class::BlowUp => "blow-up",
        Class::Refused => "refused with a reason",
        Class::OverBudget => "over budget, not run",
    }
}

pub fn draw(family: &FamilyRecord) -> Result<Vec<u8>, ChartError> {
    let engines = &family.engines;
    let scan_height = |scan: &ScanRecord| TITLE_HEIGHT + CELL_HEIGHT * scan.steps.len() as u32 + VALUES_HEIGHT;
    let height = ABOVE + family.scans.iter().map(scan_height).sum::<u32>() + 8;
    let count = engines.len().max(1) as u32;
    let width = (WIDTH - 2 * LEFT - STEPS - GAP * (count - 1)) / count;
    let left = |column: usize| LEFT + STEPS + column as u32 * (width + GAP);
    canvas::render_of_height(height, |area| {
        let subtitle = format!("{} An exclamation mark: the program warns of the run.", sentence(&family.question));
        legend::frame(area, &family.title, &subtitle, &[], &[])?;
        classes(area)?;
        for (column, engine) in engines.iter().enumerate() {
            heading(area, engine, left(column))?;
        }
        let mut top = ABOVE;
        for scan in &family.scans {
            let upwards = if scan.clock.is_empty() { String::new() } else { format!("; step in {}", scan.clock) };
            let title = format!("{}; across: {}{upwards}", scan.title, scan.parameter);
            area.draw(&Text::new(title, (at(LEFT), at(top + 6)), style::bold(style::NOTE, INK)))?;
            for (row, step) in scan.steps.iter().enumerate() {
                let middle = top + TITLE_HEIGHT + row as u32 * CELL_HEIGHT + CELL_HEIGHT / 2;
                let place = (at(LEFT + STEPS - 8), at(middle));
                let right = style::font(SMALL, INK).pos(Pos::new(HPos::Right, VPos::Center));
                let words = if scan.clock.is_empty() { duration(*step) } else { plain(*step, 3) };
                area.draw(&Text::new(words, place, right))?;
            }
            for (column, engine) in engines.iter().enumerate() {
                panel(area, scan, engine, (left(column), top + TITLE_HEIGHT), width)?;
            }
            top += scan_height(scan);
        }
        Ok(())
    })
}

/// A question as a sentence of its own.
fn sentence(question: &str) -> String {
    let mut letters = question.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// The legend: every class with its colour, letter and meaning.
fn classes(area: &Area) -> Result<(), ChartError> {
    let style = style::font(style::NOTE, INK);
    let (mut x, mut y) = (at(LEFT), at(LEGEND_TOP));
    for class in Class::ALL {
        let width = area.estimate_text_size(meaning(class), &style)?.0 as i32;
        if x + at(34) + width > at(WIDTH - LEFT) {
            (x, y) = (at(LEFT), y + at(32));
        }
        square(area, class, false, (x, y), (at(26), at(24)))?;
        area.draw(&Text::new(meaning(class), (x + at(34), y + at(2)), style.clone()))?;
        x += at(34) + width + at(28);
    }
    Ok(())
}

/// An engine's name over its column, a setting a line.
fn heading(area: &Area, engine: &str, left: u32) -> Result<(), ChartError> {
    let lines: Vec<&str> = engine.split_inclusive([':', ',']).collect();
    let mut y = ABOVE - 4 - 22 * lines.len() as u32;
    for line in lines {
        area.draw(&Text::new(line.to_string(), (at(left), at(y)), style::bold(17, INK)))?;
        y += 22;
    }
    Ok(())
}

/// The cells of one scan and engine.
fn panel(area: &Area, scan: &ScanRecord, engine: &str, (left, top): (u32, u32), width: u32) -> Result<(), ChartError> {
    let count = scan.values.len().max(1) as u32;
    let edge = |i: usize| at(left) + (px(width) * i as u32 / count) as i32;
    let find = |value: f64, step: f64| -> Option<&CellRecord> {
        scan.cells.iter().find(|c| c.engine == engine && c.value == value && c.step == step)
    };
    for (i, &value) in scan.values.iter().enumerate() {
        for (row, &step) in scan.steps.iter().enumerate() {
            let Some(cell) = find(value, step) else { continue };
            let y = at(top + row as u32 * CELL_HEIGHT);
            square(
                area,
                cell.class,
                cell.warning.is_some(),
                (edge(i) + 2, y + 2),
                (edge(i + 1) - edge(i) - 4, at(CELL_HEIGHT) - 4),
            )?;
        }
    }
    values(area, scan, edge, at(top + scan.steps.len() as u32 * CELL_HEIGHT + 6))
}

/// Every value or, where there is no room for that, every second, third, ... of them.
fn values(area: &Area, scan: &ScanRecord, edge: impl Fn(usize) -> i32, y: i32) -> Result<(), ChartError> {
    let style = style::font(SMALL, INK).pos(Pos::new(HPos::Center, VPos::Top));
    let mut places = Vec::new();
    for (i, value) in scan.values.iter().enumerate() {
        let words = compact(*value);
        let half = area.estimate_text_size(&words, &style)?.0 as i32 / 2;
        places.push(((edge(i) + edge(i + 1)) / 2, half, words));
    }
    let fit = |stride: &usize| {
        let shown: Vec<_> = places.iter().step_by(*stride).collect();
        shown.windows(2).all(|pair| pair[0].0 + pair[0].1 + at(6) < pair[1].0 - pair[1].1)
    };
    let stride = (1..=places.len()).find(fit).unwrap_or(1);
    for (middle, _, words) in places.into_iter().step_by(stride) {
        area.draw(&Text::new(words, (middle, y), style.clone()))?;
    }
    Ok(())
}

/// A cell with its letter, and an exclamation mark where there is a warning.
fn square(
    area: &Area,
    class: Class,
    warning: bool,
    (x, y): (i32, i32),
    (width, height): (i32, i32),
) -> Result<(), ChartError> {
    let (fill, ink, letter) = look(class);
    let corners = [(x, y), (x + width, y + height)];
    area.draw(&Rectangle::new(corners, fill.filled()))?;
    area.draw(&Rectangle::new(corners, GREY.stroke_width(px(1))))?;
    let style = style::bold(SMALL, ink).pos(Pos::new(HPos::Center, VPos::Center));
    let letter = if warning { format!("{letter}\u{2009}!") } else { letter.to_string() };
    area.draw(&Text::new(letter, (x + width / 2, y + height / 2), style))?;
    Ok(())
}
