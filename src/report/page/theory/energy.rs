//! The section of topics `figure1` and `figure2`.

use super::section::Section;
use crate::measure::theory::energy;
use crate::report::charts::{ChartError, theory::energy_of_particle};
use crate::report::page::document::Picture;
use crate::report::record::theory::energy::{CurveRecord, EnergyRecord};

/// Mean of a quarter of a curve (0 to 3) less that of the truth, over the initial energy.
fn offset(record: &EnergyRecord, curve: &CurveRecord, quarter: usize) -> f64 {
    let truth = &record.curves[0].energy_j;
    // The exact energy of the conservative particle is two equal points.
    let true_at = |i: usize| *truth.get(i).unwrap_or(&truth[truth.len() - 1]);
    let count = curve.energy_j.len();
    let range = count * quarter / 4..count * (quarter + 1) / 4;
    let length = range.len() as f64;
    range.map(|i| curve.energy_j[i] - true_at(i)).sum::<f64>() / length / truth[0]
}

/// Words of one of the figures.
struct Wording {
    title: &'static str,
    caption: &'static str,
    system: &'static str,
}

const CONSERVATIVE: Wording = Wording {
    title: "Energy without drag: figure 1 of Marsden and West",
    caption: "Energy of a particle in a radial potential over time: the exact value, variational Newmark and RK4 at \
              the same step",
    system: "A particle in the plane, L = ½|v|² − |q|²(|q|² − 1)², Newmark with β = 0 and γ = ½ against \
             RK4.",
};

const DISSIPATIVE: Wording = Wording {
    title: "Energy under weak drag: figure 2 of Marsden and West",
    caption: "Energy of the particle under weak drag over time: a benchmark, the forced midpoint rule and RK4 at the \
              same step",
    system: "The same particle with the drag force −0.001 v (example 3.2.3); the midpoint rule with discrete forces \
             against RK4. The benchmark is the reference flow, whose error cannot be seen in the figure.",
};

pub(super) fn section(record: &EnergyRecord, topic: &str) -> Result<Section, ChartError> {
    let wording = if topic == energy::FIGURE_1.name { CONSERVATIVE } else { DISSIPATIVE };
    let (variational, runge_kutta) = (&record.curves[1], &record.curves[2]);
    let duration = variational.time_s[variational.time_s.len() - 1];
    let step = variational.step_s.unwrap_or_default();
    let offsets = |curve: &CurveRecord| {
        let percent = |quarter| format!("{:+.1} %", 100.0 * offset(record, curve, quarter)).replace('-', "−");
        format!("{} {} and {}", curve.method, percent(0), percent(3))
    };
    let finding = format!(
        "Mean energy less the true one, over the initial energy, in the first and the last quarter of {duration} s at \
         a step of {step} s: {}; {}.",
        offsets(variational),
        offsets(runge_kutta),
    );
    let explanation = format!(
        "{} One step in 16 is shown. The initial state, q = (0.9, 0), v = (0.2, 0.8), and the step are ours: the paper \
         does not print its own.",
        wording.system
    );
    let picture = Picture { caption: wording.caption, png: energy_of_particle::draw(record, wording.title)? };
    Ok(Section {
        title: wording.title,
        finding,
        explanation,
        charts: vec![(format!("{topic}.png"), picture)],
        tables: vec![],
    })
}
