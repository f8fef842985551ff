//! `energy_drift.png`: the energy error against time.

use super::Chart;
use super::canvas::ChartError;
use super::time_panels::{self, Subject};
use crate::report::record::report::Report;
use crate::report::words::number::written;

pub(crate) const CHART: Chart = Chart {
    file: "energy_drift.png",
    caption: "Energy error against time for every engine, at a coarse, a middle and a fine step",
    draw,
};

fn draw(report: &Report) -> Result<Option<Vec<u8>>, ChartError> {
    let scene = &report.scene;
    time_panels::draw(
        report,
        &Subject {
            title: format!("Energy error over time: {}", scene.name),
            subtitle: format!(
                "|E(t) − E(0)| over the energy scale of the scene, {} J; each line joins the largest values in {} \
                 intervals",
                written(scene.energy_scale_j),
                time_panels::INTERVALS
            ),
            y: "relative energy error",
            ceiling: 2,
            values: |series| {
                series.energy_min.iter().zip(&series.energy_max).map(|(a, b)| a.abs().max(b.abs())).collect()
            },
            dashed: Some((
                |series| series.corrected_energy.as_ref(),
                "Dashed: the same run with its positions moved back to the time of its velocities.",
            )),
        },
    )
}
