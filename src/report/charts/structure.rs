//! `structure.png`: symplecticity and reversibility defects of a few steps over the step sizes.

use super::axis::Axis;
use super::canvas::{self, ChartError};
use super::chart::Chart;
use super::panel::{Panel, Words};
use super::{legend, style};
use crate::report::record::report::Report;
use crate::report::record::run::Run;
use crate::report::words::number::duration;

pub(crate) const CHART: Chart = Chart {
    file: "structure.png",
    caption: "How far a few steps of every engine are from symplectic and from reversible, against the step size",
    draw,
};

/// One panel: the defect of a run, the same with positions moved back to the time of the velocities, and what is below
/// the reach of the measurement.
struct Subject {
    heading: &'static str,
    y: &'static str,
    defect: fn(&Run) -> Option<f64>,
    corrected: fn(&Run) -> Option<f64>,
    error: fn(&Run) -> Option<f64>,
}

const SUBJECTS: [Subject; 2] = [
    Subject {
        heading: "symplectic form",
        y: "largest entry of AᵀΩA − Ω",
        defect: |run| Some(run.structure.as_ref()?.symplecticity.as_ref()?.defect),
        corrected: |run| Some(run.structure.as_ref()?.time_level_corrected.as_ref()?.symplecticity.as_ref()?.defect),
        error: |run| Some(run.structure.as_ref()?.symplecticity.as_ref()?.differencing_error),
    },
    Subject {
        heading: "reversal",
        y: "distance from the start, rad, m, rad/s or m/s",
        defect: |run| Some(run.structure.as_ref()?.reversibility.as_ref()?.defect),
        corrected: |run| Some(run.structure.as_ref()?.time_level_corrected.as_ref()?.reversibility.as_ref()?.defect),
        error: |_| None,
    },
];

fn draw(report: &Report) -> Result<Option<Vec<u8>>, ChartError> {
    let with_defect = |subject: &Subject| report.runs.iter().filter(|r| (subject.defect)(r).is_some()).count();
    let panels: Vec<(&Subject, Axis)> = SUBJECTS
        .iter()
        .filter(|subject| with_defect(subject) > 0)
        .filter_map(|subject| {
            let values =
                report.runs.iter().flat_map(|r| [subject.defect, subject.corrected, subject.error].map(|f| f(r)));
            Some((subject, Axis::decades(values.flatten(), -18, 4)?))
        })
        .collect();
    let Some(x) = Axis::decades(report.runs.iter().map(|r| r.step_s), -9, 2).filter(|_| !panels.is_empty()) else {
        return Ok(None);
    };
    let looks = style::looks(report);
    let Some(first) = report.runs.iter().find_map(|run| run.structure.as_ref()) else { return Ok(None) };
    let title = format!("Structure of {} steps: {}", first.steps, report.scene.name);
    let subtitle = format!(
        "{} steps from the state {} into the motion as a map of joint coordinates and momenta. The exact motion has no \
         defect.",
        first.steps,
        duration(first.at_s)
    );
    canvas::render(|area| {
        let area = legend::frame(area, &title, &subtitle, &looks, &notes(report))?;
        let width = area.dim_in_pixel().0 / panels.len() as u32;
        let mut rest = area;
        for (subject, y) in &panels {
            let (panel_area, right) = rest.split_horizontally(width);
            let words = Words { heading: subject.heading, x: "step, s", y: Some(subject.y) };
            let panel = Panel::new(&panel_area, x, *y, words)?;
            for (engine, look) in looks.iter().rev() {
                let runs: Vec<&Run> = report.runs.iter().filter(|r| r.engine == *engine).collect();
                curves(&panel, &runs, *look, subject)?;
            }
            rest = right;
        }
        Ok(())
    })
    .map(Some)
}

/// An engine's defects; hollow and dashed the corrected ones; thin the error of the differences.
fn curves(panel: &Panel, runs: &[&Run], look: style::Look, subject: &Subject) -> Result<(), ChartError> {
    let points = |of: fn(&Run) -> Option<f64>| -> Vec<(f64, f64)> {
        runs.iter().filter_map(|r| Some((r.step_s, of(r)?))).collect()
    };
    panel.line(&points(subject.error), look, 1, false)?;
    for (of, hollow) in [(subject.corrected, true), (subject.defect, false)] {
        let points = points(of);
        panel.line(&points, look, if hollow { 2 } else { 3 }, hollow)?;
        points.iter().try_for_each(|point| panel.mark(*point, look, hollow))?;
    }
    Ok(())
}

fn notes(report: &Report) -> Vec<String> {
    let mut notes = vec![
        "Thin lines without markers: the error of the differences that give the derivative; a defect below it cannot \
         be told from none."
            .to_string(),
    ];
    if report.runs.iter().any(|r| (SUBJECTS[1].corrected)(r).is_some()) {
        notes.push("Hollow, dashed: the same map with positions moved back to the time of the velocities.".to_string());
    }
    notes
}
