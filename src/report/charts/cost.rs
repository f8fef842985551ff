//! `cost.png`: processor time a step against the number of links of a chain.

use super::axis::Axis;
use super::canvas::{self, ChartError};
use super::panel::{Label, Panel, Words};
use super::{legend, style};
use crate::report::record::cost::{Cost, CostPoint};
use crate::report::words::number::{duration, plain};

pub const FILE: &str = "cost.png";

pub(crate) const CAPTION: &str = "CPU time a step against the number of links for every engine";

pub fn draw(cost: &Cost) -> Result<Option<Vec<u8>>, ChartError> {
    let Some(x) = Axis::around(cost.points.iter().map(|p| p.links as f64)) else { return Ok(None) };
    let Some(y) = Axis::decades(cost.points.iter().map(|p| p.us_per_step), -4, 9) else { return Ok(None) };
    let looks = style::looks_of(cost.points.iter().map(|p| p.engine.as_str()));
    let subtitle = format!(
        "{}; step {}, one thread; at the end of each line the time of its longest chain, a link",
        cost.model,
        duration(cost.step_s)
    );
    canvas::render(|area| {
        let area = legend::frame(area, "CPU time a step against links", &subtitle, &looks, &[])?;
        let words = Words { heading: "", x: "links", y: Some("CPU time a step, µs") };
        let panel = Panel::new(&area, x, y, words)?;
        let (mut labels, mut lines) = (Vec::new(), Vec::new());
        for (engine, look) in looks.iter().rev() {
            let own: Vec<&CostPoint> = cost.points.iter().filter(|p| p.engine == *engine).collect();
            let points: Vec<(f64, f64)> = own.iter().map(|p| (p.links as f64, p.us_per_step)).collect();
            panel.line(&points, *look, 3, false)?;
            points.iter().try_for_each(|point| panel.mark(*point, *look, false))?;
            if let Some(&(links, time)) = points.last() {
                let words = format!("{} µs a link", plain(time / links, 2));
                labels.push(Label { point: (links, time), words, look: *look });
            }
            lines.push(points);
        }
        panel.labels(&labels, &lines)
    })
    .map(Some)
}
