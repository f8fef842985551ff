//! Sizes, colours and markers: the same engine has the same colour and marker in every chart.

use plotters::prelude::*;

use super::super::Report;
use crate::engines::{self, Colour, Origin};

pub(crate) use crate::engines::Marker;

/// Size of a finished chart, pixels.
pub const WIDTH: u32 = 1200;
pub(crate) const HEIGHT: u32 = 760;

/// Charts are drawn this many times larger.
pub(crate) const SCALE: u32 = 3;

/// Font sizes, in pixels of the finished chart; two thirds of that at the width of a README.
pub(crate) const TITLE: u32 = 30;
pub(crate) const HEADING: u32 = 24;
pub(crate) const LABEL: u32 = 22;
pub(crate) const TICK: u32 = 21;
pub(crate) const NOTE: u32 = 19;

pub(crate) const INK: RGBColor = RGBColor(30, 30, 30);
pub(crate) const GREY: RGBColor = RGBColor(95, 95, 95);
pub(crate) const GRID: RGBColor = RGBColor(222, 222, 222);
pub(crate) const FAINT: RGBColor = RGBColor(241, 241, 241);

/// Pixels of the canvas for pixels of the finished chart.
pub(crate) fn px(pixels: u32) -> u32 {
    pixels * SCALE
}

/// A length on the canvas, for coordinates.
pub fn at(pixels: u32) -> i32 {
    px(pixels) as i32
}

/// Text of a size and colour.
pub(crate) fn font(size: u32, colour: RGBColor) -> TextStyle<'static> {
    FontDesc::new(FontFamily::SansSerif, f64::from(px(size)), FontStyle::Normal).color(&colour)
}

/// Bold text.
pub(crate) fn bold(size: u32, colour: RGBColor) -> TextStyle<'static> {
    FontDesc::new(FontFamily::SansSerif, f64::from(px(size)), FontStyle::Bold).color(&colour)
}

/// How an engine looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Look {
    pub colour: RGBColor,
    pub marker: Marker,
}

// The palette of Okabe and Ito, without its yellow, which is too pale on white.
pub(crate) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(crate) const SKY: RGBColor = RGBColor(86, 180, 233);
pub(crate) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(crate) const VERMILLION: RGBColor = RGBColor(213, 94, 0);
pub(crate) const ORANGE: RGBColor = RGBColor(230, 159, 0);
pub(crate) const PURPLE: RGBColor = RGBColor(204, 121, 167);
pub(crate) const BLACK: RGBColor = RGBColor(0, 0, 0);

// More for when those are taken.
const BROWN: RGBColor = RGBColor(122, 62, 16);
const OLIVE: RGBColor = RGBColor(150, 138, 10);
const STONE: RGBColor = RGBColor(125, 125, 125);
const NAVY: RGBColor = RGBColor(45, 45, 130);
const TEAL: RGBColor = RGBColor(0, 125, 135);
const LIME: RGBColor = RGBColor(130, 175, 20);

/// The look that an engine's entry gives to a setting, so that it is the same in every report.
fn own(name: &str) -> Option<Look> {
    let look = engines::look_of(name)?;
    let colour = match look.colour {
        Colour::Blue => BLUE,
        Colour::Sky => SKY,
        Colour::Green => GREEN,
        Colour::Vermillion => VERMILLION,
        Colour::Orange => ORANGE,
        Colour::Purple => PURPLE,
        Colour::Black => BLACK,
        Colour::Olive => OLIVE,
        Colour::Stone => STONE,
    };
    Some(Look { colour, marker: look.marker })
}

// For settings without a look of their own: cool colours for our engines, warm ones for those of other programs, and
// for engines of other versions what these have least of.
const COOL: [RGBColor; 7] = [GREEN, SKY, BLACK, NAVY, TEAL, LIME, BLUE];
const WARM: [RGBColor; 6] = [BROWN, OLIVE, STONE, ORANGE, PURPLE, VERMILLION];
const NEUTRAL: [RGBColor; 6] = [STONE, TEAL, BROWN, LIME, NAVY, OLIVE];
const MARKERS: [Marker; 5] = [Marker::TriangleDown, Marker::Diamond, Marker::Triangle, Marker::Square, Marker::Circle];

/// The engines of a report in its order, each with its look; no two look the same while there are fewer than twenty of
/// a family.
pub(crate) fn looks(report: &Report) -> Vec<(&str, Look)> {
    looks_of(report.runs.iter().map(|run| run.engine.as_str()))
}

/// The same for any names, each once.
pub(crate) fn looks_of<'a>(names: impl Iterator<Item = &'a str>) -> Vec<(&'a str, Look)> {
    let mut engines: Vec<&str> = Vec::new();
    for name in names {
        if !engines.contains(&name) {
            engines.push(name);
        }
    }
    let mut taken: Vec<Look> = engines.iter().filter_map(|engine| own(engine)).collect();
    let mut look_of = |engine| {
        own(engine).unwrap_or_else(|| {
            let look = free_look(engine, &taken);
            taken.push(look);
            look
        })
    };
    engines.into_iter().map(|engine| (engine, look_of(engine))).collect()
}

/// A colour that is not taken, else a colour and marker that are not taken together.
fn free_look(engine: &str, taken: &[Look]) -> Look {
    let palette: &[RGBColor] = match engines::group_of(engine).origin {
        Origin::Own => &COOL,
        Origin::Foreign => &WARM,
        Origin::Unknown => &NEUTRAL,
    };
    let free = MARKERS.iter().find(|marker| taken.iter().all(|look| look.marker != **marker));
    let marker = *free.unwrap_or(&MARKERS[taken.len() % MARKERS.len()]);
    let colour = palette.iter().find(|colour| taken.iter().all(|look| look.colour != **colour));
    let pairs = || MARKERS.into_iter().flat_map(|marker| palette.iter().map(move |&colour| Look { colour, marker }));
    match colour {
        Some(&colour) => Look { colour, marker },
        None => pairs().find(|look| !taken.contains(look)).unwrap_or(Look { colour: STONE, marker }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engines::ENGINES;

    #[test]
    fn engines_look_different() {
        let contestants = ENGINES.iter().flat_map(|entry| entry.contestants);
        let mut taken: Vec<Look> = contestants.filter_map(|contestant| own(contestant.spec)).collect();
        for i in 0..16 {
            let look = free_look(if i % 2 == 0 { "rapier:substeps=1" } else { "rattle:order=4" }, &taken);
            assert!(!taken.contains(&look), "{i}: {look:?}");
            taken.push(look);
        }
    }
}
