//! `constraint_violation.png`: how far joints come apart, against time.

use super::Chart;
use super::canvas::ChartError;
use super::time_panels::{self, Subject};
use crate::report::record::report::Report;

pub(crate) const CHART: Chart = Chart {
    file: "constraint_violation.png",
    caption: "Joint position error against time for every engine, at a coarse, a middle and a fine step",
    draw,
};

fn draw(report: &Report) -> Result<Option<Vec<u8>>, ChartError> {
    if report.runs.iter().all(|run| run.constraint.is_none()) {
        return Ok(None);
    }
    time_panels::draw(
        report,
        &Subject {
            title: format!("How far the joints come apart: {}", report.scene.name),
            subtitle: format!(
                "Largest displacement (m) or rotation (rad) that a joint does not allow; each line joins the largest \
                 values in {} intervals",
                time_panels::INTERVALS
            ),
            y: "joint error, m or rad",
            ceiling: 2,
            values: |series| series.constraint_position.clone(),
            dashed: None,
        },
    )
}
