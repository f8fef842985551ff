//! A canvas with an embedded font that ends as a PNG.
//!
//! Charts are drawn three times as large as they are kept, then averaged down, which smooths lines and markers.

use std::sync::OnceLock;

use plotters::coord::Shift;
use plotters::prelude::*;

use super::style::{HEIGHT, SCALE, WIDTH};

/// What charts draw on.
pub(crate) type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

/// Why a chart could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum ChartError {
    #[error("a chart could not be drawn: {0}")]
    Draw(String),
    #[error("a chart could not be written as PNG: {0}")]
    Encode(#[from] png::EncodingError),
}

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for ChartError {
    fn from(error: DrawingAreaErrorKind<E>) -> ChartError {
        ChartError::Draw(error.to_string())
    }
}

/// Draws on a white canvas of [`WIDTH`] x [`HEIGHT`] and encodes it.
pub(crate) fn render(draw: impl FnOnce(&Area) -> Result<(), ChartError>) -> Result<Vec<u8>, ChartError> {
    render_of_height(HEIGHT, draw)
}

/// Draws on a white canvas of [`WIDTH`] and a height of its own, for charts with a line for each of many things.
pub(crate) fn render_of_height(
    pixels_high: u32,
    draw: impl FnOnce(&Area) -> Result<(), ChartError>,
) -> Result<Vec<u8>, ChartError> {
    register_fonts()?;
    let (width, height) = (WIDTH * SCALE, pixels_high * SCALE);
    let mut pixels = vec![255; (width * height * 3) as usize];
    {
        let area = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
        draw(&area)?;
        area.present()?;
    }
    encode(&reduced(&pixels, pixels_high), pixels_high)
}

/// DejaVu Sans, from the program itself, so that a chart looks the same everywhere.
fn register_fonts() -> Result<(), ChartError> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let registered = REGISTERED.get_or_init(|| {
        [(FontStyle::Normal, dejavu::sans::regular()), (FontStyle::Bold, dejavu::sans::bold())]
            .into_iter()
            .all(|(style, bytes)| plotters::style::register_font("sans-serif", style, bytes).is_ok())
    });
    if *registered { Ok(()) } else { Err(ChartError::Draw("the embedded font cannot be read".to_string())) }
}

/// Each pixel becomes the mean of the square of pixels that it stands for.
fn reduced(pixels: &[u8], height: u32) -> Vec<u8> {
    let (scale, wide) = (SCALE as usize, (WIDTH * SCALE) as usize);
    let mut small = Vec::with_capacity((WIDTH * height * 3) as usize);
    for y in 0..height as usize {
        for x in 0..WIDTH as usize {
            for channel in 0..3 {
                let sum: usize = (0..scale * scale)
                    .map(|k| {
                        let (dx, dy) = (k % scale, k / scale);
                        usize::from(pixels[((y * scale + dy) * wide + x * scale + dx) * 3 + channel])
                    })
                    .sum();
                small.push((sum / (scale * scale)) as u8);
            }
        }
    }
    small
}

fn encode(pixels: &[u8], height: u32) -> Result<Vec<u8>, ChartError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, WIDTH, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Best);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}
