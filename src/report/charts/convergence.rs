//! `convergence.png`: joint position error against the step size, with fitted orders and floors.

use super::axis::Axis;
use super::canvas::{self, ChartError};
use super::chart::Chart;
use super::panel::{Label, Panel, Words};
use super::{legend, style};
use crate::engines;
use crate::measure::convergence::Verdict;
use crate::report::record::report::Report;
use crate::report::record::run::Run;
use crate::report::record::sweep::{Convergence, Sweep};
use crate::report::words::number::{plain, short};

pub(crate) const CHART: Chart = Chart {
    file: "convergence.png",
    caption: "Joint position error against step size for every engine of fixed steps, with the fitted order or the \
              floor at each line",
    draw,
};

const FLOOR: i32 = -16;

fn draw(report: &Report) -> Result<Option<Vec<u8>>, ChartError> {
    let Some(sweep) = &report.sweep else { return Ok(None) };
    let shown = shown(report, sweep);
    let runs = || shown.iter().flat_map(|c| of(sweep, c));
    let Some(x) = Axis::decades(runs().map(|r| r.step_s), -9, 3) else { return Ok(None) };
    let Some(y) = Axis::decades(runs().filter_map(Run::joint_error), FLOOR, 1) else { return Ok(None) };
    let looks = style::looks_of(shown.iter().map(|c| c.engine.as_str()));
    let title = format!("Error against step size: {}", report.scene.name);
    let subtitle = format!(
        "Largest error of a joint position over the first {} s against the reference; at each line the fitted order, \
         or, where it does not converge, the error at which it stops falling",
        plain(sweep.until_s, 4)
    );
    let group = |c: &Convergence| engines::group_of(&c.engine);
    let mut panels = engines::groups();
    panels.retain(|panel| shown.iter().any(|c| group(c) == *panel));
    canvas::render(|area| {
        let area = legend::frame(area, &title, &subtitle, &looks, &[])?;
        let width = area.dim_in_pixel().0 / panels.len() as u32;
        let mut rest = area;
        for (i, panel_group) in panels.iter().enumerate() {
            let (panel_area, right) = rest.split_horizontally(width);
            let y_words = (i == 0).then_some("largest joint position error, rad or m");
            let panel =
                Panel::new(&panel_area, x, y, Words { heading: panel_group.name, x: "step size, s", y: y_words })?;
            let (mut labels, mut lines) = (Vec::new(), Vec::new());
            for (c, (_, look)) in shown.iter().zip(&looks).filter(|(c, _)| group(c) == *panel_group).rev() {
                let points: Vec<(f64, f64)> =
                    of(sweep, c).iter().filter_map(|r| Some((r.step_s, r.joint_error()?))).collect();
                panel.line(&points, *look, 2, false)?;
                points.iter().try_for_each(|point| panel.mark(*point, *look, false))?;
                labels.extend(label(c, &points).map(|(point, words)| Label { point, words, look: *look }));
                lines.push(points);
            }
            panel.labels(&labels, &lines)?;
            rest = right;
        }
        Ok(())
    })
    .map(Some)
}

/// The engines of the report and, but for those that are tuned by many settings, those of the sweep.
fn shown<'a>(report: &Report, sweep: &'a Sweep) -> Vec<&'a Convergence> {
    let compared = |c: &Convergence| report.runs.iter().any(|run| run.engine == c.engine);
    sweep.convergence.iter().filter(|c| engines::tuned(&c.engine).is_none() || compared(c)).collect()
}

fn of<'a>(sweep: &'a Sweep, c: &Convergence) -> Vec<&'a Run> {
    sweep.runs.iter().filter(|r| r.engine == c.engine && r.joint_error().is_some()).collect()
}

/// The floor at the finest step where the engine does not converge, else the order at the coarsest step at which the
/// error is small.
fn label(c: &Convergence, points: &[(f64, f64)]) -> Option<((f64, f64), String)> {
    let coarse = points.iter().copied().find(|p| p.1 < 0.1);
    let floor = match c.verdict {
        Verdict::DoesNotConverge => c.floor,
        Verdict::Converges | Verdict::ToRoundoff | Verdict::NotSmall => None,
    };
    match floor {
        Some(floor) => Some((*points.last()?, format!("floor {}", short(floor)))),
        None => c.order.and_then(|order| Some((coarse?, format!("order {}", plain(order, 2))))),
    }
}
