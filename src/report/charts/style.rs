//! Sizes, colours and markers: the same engine has the same colour and marker in every chart.

use plotters::prelude::*;

use super::super::Report;

/// Size of a finished chart, pixels.
pub const WIDTH: u32 = 1200;
pub const HEIGHT: u32 = 760;

/// Charts are drawn this many times larger.
pub const SCALE: u32 = 3;

/// Font sizes, in pixels of the finished chart; two thirds of that at the width of a README.
pub const TITLE: u32 = 30;
pub const HEADING: u32 = 24;
pub const LABEL: u32 = 22;
pub const TICK: u32 = 21;
pub const NOTE: u32 = 19;

pub const INK: RGBColor = RGBColor(30, 30, 30);
pub const GREY: RGBColor = RGBColor(95, 95, 95);
pub const GRID: RGBColor = RGBColor(222, 222, 222);
pub const FAINT: RGBColor = RGBColor(241, 241, 241);

/// Pixels of the canvas for pixels of the finished chart.
pub fn px(pixels: u32) -> u32 {
    pixels * SCALE
}

/// A length on the canvas, for coordinates.
pub fn at(pixels: u32) -> i32 {
    px(pixels) as i32
}

/// Text of a size and colour.
pub fn font(size: u32, colour: RGBColor) -> TextStyle<'static> {
    FontDesc::new(FontFamily::SansSerif, f64::from(px(size)), FontStyle::Normal).color(&colour)
}

/// Bold text.
pub fn bold(size: u32, colour: RGBColor) -> TextStyle<'static> {
    FontDesc::new(FontFamily::SansSerif, f64::from(px(size)), FontStyle::Bold).color(&colour)
}

/// How an engine looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    pub colour: RGBColor,
    pub marker: Marker,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
    TriangleDown,
}

// The palette of Okabe and Ito, without its yellow, which is too pale on white.
const BLUE: RGBColor = RGBColor(0, 114, 178);
const SKY: RGBColor = RGBColor(86, 180, 233);
const GREEN: RGBColor = RGBColor(0, 158, 115);
const VERMILLION: RGBColor = RGBColor(213, 94, 0);
const ORANGE: RGBColor = RGBColor(230, 159, 0);
const PURPLE: RGBColor = RGBColor(204, 121, 167);
const BLACK: RGBColor = RGBColor(0, 0, 0);

/// Engines with a place of their own, so that they look the same in every report.
const KNOWN: [(&str, Look); 4] = [
    ("rattle", Look { colour: BLUE, marker: Marker::Circle }),
    ("rapier", Look { colour: VERMILLION, marker: Marker::Square }),
    ("rapier:preset=strong", Look { colour: ORANGE, marker: Marker::Triangle }),
    ("rapier:joints=multibody,precision=f64", Look { colour: PURPLE, marker: Marker::Diamond }),
];

/// Cool colours for variational engines, warm ones for rapier, taken in turn by engines without a place of their own.
const COOL: [RGBColor; 4] = [GREEN, SKY, BLACK, BLUE];
const WARM: [RGBColor; 3] = [ORANGE, PURPLE, VERMILLION];
const MARKERS: [Marker; 5] = [Marker::TriangleDown, Marker::Diamond, Marker::Triangle, Marker::Square, Marker::Circle];

/// The engines of a report in its order, each with its look; no two look the same while there are fewer than a dozen.
pub fn looks(report: &Report) -> Vec<(&str, Look)> {
    let mut looks: Vec<(&str, Look)> = Vec::new();
    let mut taken = 0;
    for run in &report.runs {
        let engine = run.engine.as_str();
        if looks.iter().any(|(name, _)| *name == engine) {
            continue;
        }
        let look = match KNOWN.iter().find(|(name, _)| *name == engine) {
            Some((_, look)) => *look,
            None => {
                let palette: &[RGBColor] = if engine.starts_with("rapier") { &WARM } else { &COOL };
                taken += 1;
                Look { colour: palette[(taken - 1) % palette.len()], marker: MARKERS[(taken - 1) % MARKERS.len()] }
            }
        };
        looks.push((engine, look));
    }
    looks
}
