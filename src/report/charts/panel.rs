//! A panel: axes with lines and markers in them.

use plotters::prelude::*;

use super::axis::Axis;
use super::canvas::{Area, ChartError};
use super::style::{self, FAINT, GRID, INK, Look, Marker, at, px};

/// A panel that can be drawn into.
pub(crate) struct Panel<'a, 'b> {
    context: ChartContext<'a, BitMapBackend<'b>, Cartesian2d<Axis, Axis>>,
    x: Axis,
    y: Axis,
}

/// Words around a panel.
#[derive(Clone, Copy, Debug)]
pub struct Words<'a> {
    pub heading: &'a str,
    pub x: &'a str,
    /// The first panel of a row has one; the others repeat its axis without words.
    pub y: Option<&'a str>,
}

/// Covering a marker is as bad as covering so many squares along a line, and covering other words is worse.
const MARKER: usize = 6;
const WORDS: usize = 20;

/// Words that would cover more than this are left out.
const TOO_MUCH: usize = 2 * MARKER;

/// Words that belong to a point.
pub(crate) struct Label {
    pub point: (f64, f64),
    pub words: String,
    pub look: Look,
}

impl<'a, 'b> Panel<'a, 'b> {
    pub fn new(area: &'a Area<'b>, x: Axis, y: Axis, words: Words) -> Result<Panel<'a, 'b>, ChartError> {
        let mut builder = ChartBuilder::on(area);
        builder.margin_right(px(28)).margin_left(px(8)).margin_bottom(px(6));
        builder.x_label_area_size(px(64)).y_label_area_size(px(if words.y.is_some() { 108 } else { 66 }));
        builder.margin_top(px(38));
        let mut context = builder.build_cartesian_2d(x, y)?;
        context
            .configure_mesh()
            .x_labels(6)
            .y_labels(9)
            .x_desc(words.x)
            .y_desc(words.y.unwrap_or(""))
            .label_style(style::font(style::TICK, INK))
            .axis_desc_style(style::font(style::LABEL, INK))
            .axis_style(INK.stroke_width(px(1)))
            .bold_line_style(GRID.stroke_width(px(1)))
            .light_line_style(FAINT.stroke_width(px(1)))
            .set_all_tick_mark_size(px(5))
            .draw()?;
        let left = context.plotting_area().get_pixel_range().0.start - area.get_pixel_range().0.start;
        area.draw(&Text::new(words.heading.to_string(), (left, at(8)), style::bold(style::HEADING, INK)))?;
        Ok(Panel { context, x, y })
    }

    fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.x.clamped(x), self.y.clamped(y))
    }

    /// A line through the points; what lies outside the axes is drawn on their edge.
    pub fn line(&self, points: &[(f64, f64)], look: Look, width: u32, dashed: bool) -> Result<(), ChartError> {
        let area = self.context.plotting_area();
        let pixels: Vec<(i32, i32)> = points.iter().map(|p| area.map_coordinate(&self.place(*p))).collect();
        let canvas = area.strip_coord_spec();
        let (left, top) = {
            let range = area.get_pixel_range();
            (range.0.start, range.1.start)
        };
        let local: Vec<(i32, i32)> = pixels.iter().map(|(x, y)| (x - left, y - top)).collect();
        let stroke = look.colour.stroke_width(px(width));
        if dashed {
            for dash in dashes(&local) {
                canvas.draw(&PathElement::new(dash, stroke))?;
            }
        } else {
            canvas.draw(&PathElement::new(local, stroke))?;
        }
        Ok(())
    }

    /// The engine's marker at a point.
    pub fn mark(&self, point: (f64, f64), look: Look, hollow: bool) -> Result<(), ChartError> {
        let (centre, canvas) = self.local(point);
        draw_marker(&canvas, centre, look, hollow)
    }

    /// A small pale dot: one setting among many.
    pub fn dot(&self, point: (f64, f64), look: Look) -> Result<(), ChartError> {
        let (centre, canvas) = self.local(point);
        Ok(canvas.draw(&Circle::new(centre, at(4), look.colour.mix(0.35).filled()))?)
    }

    /// A cross: the run ends here.
    pub fn cross(&self, point: (f64, f64), look: Look) -> Result<(), ChartError> {
        let ((x, y), canvas) = self.local(point);
        let r = at(9);
        for (colour, width) in [(WHITE, 7), (look.colour, 4)] {
            let stroke = colour.stroke_width(px(width));
            canvas.draw(&PathElement::new(vec![(x - r, y - r), (x + r, y + r)], stroke))?;
            canvas.draw(&PathElement::new(vec![(x - r, y + r), (x + r, y - r)], stroke))?;
        }
        Ok(())
    }

    /// Small words beside points, each where it covers least of the points, and of the lines through them. Words that
    /// would cover two markers or other words are left out.
    pub(crate) fn labels(&self, labels: &[Label], lines: &[Vec<(f64, f64)>]) -> Result<(), ChartError> {
        let mut covered: Vec<Span> = Vec::new();
        for line in lines {
            let pixels: Vec<(i32, i32)> = line.iter().map(|p| self.local(*p).0).collect();
            covered.extend(pixels.iter().flat_map(|p| [Span::around(*p, at(10)); MARKER]));
            covered.extend(pixels.windows(2).flat_map(along));
        }
        for label in labels {
            let (centre, canvas) = self.local(label.point);
            let style = style::font(style::NOTE, label.look.colour);
            let (width, height) = canvas.estimate_text_size(&label.words, &style)?;
            let (size, room) = ((width as i32, height as i32), canvas.dim_in_pixel());
            let cost = |place: &Span| {
                let inside =
                    place.left >= 0 && place.top >= 0 && place.right <= room.0 as i32 && place.bottom <= room.1 as i32;
                covered.iter().filter(|r| r.overlaps(place)).count() + if inside { 0 } else { 1000 }
            };
            let Some(place) = Span::beside(centre, size, at(14)).into_iter().min_by_key(cost) else { continue };
            if cost(&place) >= TOO_MUCH {
                continue;
            }
            canvas.draw(&Text::new(label.words.clone(), (place.left, place.top), style))?;
            covered.extend([place; WORDS]);
        }
        Ok(())
    }

    /// A point in pixels of the plotting area.
    fn local(&self, point: (f64, f64)) -> ((i32, i32), Area<'b>) {
        let area = self.context.plotting_area();
        let (x, y) = area.map_coordinate(&self.place(point));
        let range = area.get_pixel_range();
        ((x - range.0.start, y - range.1.start), area.strip_coord_spec())
    }
}

/// A marker with a white rim, or white with a coloured rim.
pub(crate) fn draw_marker(area: &Area, (x, y): (i32, i32), look: Look, hollow: bool) -> Result<(), ChartError> {
    let layers: &[(i32, RGBColor)] =
        if hollow { &[(8, look.colour), (5, WHITE)] } else { &[(10, WHITE), (8, look.colour)] };
    for (radius, colour) in layers {
        let r = radius * style::SCALE as i32;
        let fill = colour.filled();
        match look.marker {
            Marker::Circle => area.draw(&Circle::new((x, y), r, fill))?,
            Marker::Square => {
                area.draw(&Rectangle::new([(x - r * 9 / 10, y - r * 9 / 10), (x + r * 9 / 10, y + r * 9 / 10)], fill))?
            }
            Marker::Triangle => area
                .draw(&Polygon::new(vec![(x, y - r * 5 / 4), (x + r * 6 / 5, y + r), (x - r * 6 / 5, y + r)], fill))?,
            Marker::TriangleDown => area
                .draw(&Polygon::new(vec![(x, y + r * 5 / 4), (x + r * 6 / 5, y - r), (x - r * 6 / 5, y - r)], fill))?,
            Marker::Diamond => {
                let r = r * 5 / 4;
                area.draw(&Polygon::new(vec![(x, y - r), (x + r, y), (x, y + r), (x - r, y)], fill))?;
            }
        }
    }
    Ok(())
}

/// Small squares along a stretch of a line.
fn along(ends: &[(i32, i32)]) -> Vec<Span> {
    let ((ax, ay), (bx, by)) = (ends[0], ends[1]);
    let count = f64::from(bx - ax).hypot(f64::from(by - ay)) as i32 / at(6);
    (1..count).map(|k| Span::around((ax + (bx - ax) * k / count, ay + (by - ay) * k / count), at(2))).collect()
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug)]
struct Span {
    left: i32,
    top: i32,
    right: i32,
    bottom: i32,
}

impl Span {
    fn around((x, y): (i32, i32), r: i32) -> Span {
        Span { left: x - r, top: y - r, right: x + r, bottom: y + r }
    }

    /// The places for words of a size around a point, the best first.
    fn beside((x, y): (i32, i32), (width, height): (i32, i32), gap: i32) -> Vec<Span> {
        let (left, centre, right) = (x - gap - width, x - width / 2, x + gap);
        let (above, middle, below) = (y - gap - height, y - height / 2, y + gap);
        let places = [
            (centre, above),
            (x, above),
            (right, middle),
            (right, above + gap / 2),
            (left, middle),
            (left, above + gap / 2),
            (centre, below),
            (x, below),
            (x - width, above),
            (x - width, below),
            (centre, above - height),
            (centre, below + height),
        ];
        places.into_iter().map(|(left, top)| Span { left, top, right: left + width, bottom: top + height }).collect()
    }

    fn overlaps(&self, other: &Span) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.bottom && other.top < self.bottom
    }
}

/// Cuts a path into dashes of 11 pixels with gaps of 7.
fn dashes(path: &[(i32, i32)]) -> Vec<Vec<(i32, i32)>> {
    let (dash, gap) = (f64::from(at(11)), f64::from(at(7)));
    let mut pieces: Vec<Vec<(i32, i32)>> = Vec::new();
    let (mut drawing, mut left) = (true, dash);
    let mut piece: Vec<(i32, i32)> = path.first().copied().into_iter().collect();
    for ends in path.windows(2) {
        let (a, b) = ((f64::from(ends[0].0), f64::from(ends[0].1)), (f64::from(ends[1].0), f64::from(ends[1].1)));
        let length = (b.0 - a.0).hypot(b.1 - a.1);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let t = done / length;
            let cut = ((a.0 + t * (b.0 - a.0)).round() as i32, (a.1 + t * (b.1 - a.1)).round() as i32);
            if drawing {
                piece.push(cut);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![cut];
            }
            drawing = !drawing;
            left = if drawing { dash } else { gap };
        }
        left -= length - done;
        if drawing {
            piece.push(ends[1]);
        }
    }
    if drawing && piece.len() > 1 {
        pieces.push(piece);
    }
    pieces
}
