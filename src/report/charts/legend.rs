//! Title, subtitle, legend and notes, all outside the panels.

use plotters::prelude::*;

use super::canvas::{Area, ChartError};
use super::panel::draw_marker;
use super::style::{self, GREY, INK, Look, WIDTH, at, px};

/// Distance of words from the left edge.
const MARGIN: u32 = 24;

/// Draws title, subtitle and the engines' looks at the top and the notes at the bottom, and returns what is left.
pub fn frame<'a>(
    area: &Area<'a>,
    title: &str,
    subtitle: &str,
    looks: &[(&str, Look)],
    notes: &[String],
) -> Result<Area<'a>, ChartError> {
    area.draw(&Text::new(title.to_string(), (at(MARGIN), at(18)), style::bold(style::TITLE, INK)))?;
    let mut top = 60;
    for line in wrapped(area, subtitle)? {
        area.draw(&Text::new(line, (at(MARGIN), at(top)), style::font(style::NOTE, GREY)))?;
        top += 25;
    }
    let top = legend(area, looks, top + 8)?;
    let mut lines = Vec::new();
    for note in notes {
        lines.extend(wrapped(area, note)?);
    }
    let bottom = area.dim_in_pixel().1 / style::SCALE - 12 - 25 * lines.len() as u32;
    for (i, line) in lines.into_iter().enumerate() {
        let y = at(bottom + 25 * i as u32);
        area.draw(&Text::new(line, (at(MARGIN), y), style::font(style::NOTE, GREY)))?;
    }
    let (_, rest) = area.split_vertically(px(top));
    let (panels, _) = rest.split_vertically(px(bottom - top - 4));
    Ok(panels)
}

/// One entry an engine, left to right, then on the next line. Returns where the next thing may begin.
fn legend(area: &Area, looks: &[(&str, Look)], top: u32) -> Result<u32, ChartError> {
    let style = style::font(style::LABEL, INK);
    let (line, gap) = (at(48), at(34));
    let (mut x, mut y) = (at(MARGIN), at(top));
    for (name, look) in looks {
        let (width, height) = area.estimate_text_size(name, &style)?;
        if x > at(MARGIN) && x + line + width as i32 + at(MARGIN) > at(WIDTH) {
            x = at(MARGIN);
            y += at(30);
        }
        let middle = y + height as i32 * 2 / 3;
        area.draw(&PathElement::new(vec![(x, middle), (x + at(38), middle)], look.colour.stroke_width(px(3))))?;
        draw_marker(area, (x + at(19), middle), *look, false)?;
        area.draw(&Text::new(name.to_string(), (x + line, y), style.clone()))?;
        x += line + width as i32 + gap;
    }
    Ok(y as u32 / style::SCALE + 34)
}

/// Breaks a text into lines that fit the width of the chart.
fn wrapped(area: &Area, text: &str) -> Result<Vec<String>, ChartError> {
    let style = style::font(style::NOTE, GREY);
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let longer = lines.last().map(|line| format!("{line} {word}"));
        match longer {
            Some(longer) if area.estimate_text_size(&longer, &style)?.0 < px(WIDTH - 2 * MARGIN) => {
                lines.pop();
                lines.push(longer);
            }
            _ => lines.push(word.to_string()),
        }
    }
    Ok(lines)
}
