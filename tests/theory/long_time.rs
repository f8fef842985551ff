//! Long runs of all methods, and the figures of Marsden and West (2001).

use rattlebench::discrete::figures::{conservative_particle, long_time_table};

use crate::common::discrete::{at_least, at_most};

/// Over 2000 steps every method keeps its energy error bounded, the angular momentum to roundoff and the symplectic form;
/// RK4, more accurate than most in one step, keeps none of them.
#[test]
fn every_method_keeps_energy_momentum_and_form_over_long_times_and_rk4_does_not() {
    let rows = long_time_table().unwrap();
    let duration = rows[0].step * rows[0].steps as f64;
    for row in rows.iter().filter(|row| row.method != "RK4") {
        let drift = row.energy_slope.abs() * duration;
        // measured 4.6e-03
        at_most(drift / (row.energy_error + 1e-12), 0.02, row.method);
        // measured 3.3e-13
        at_most(row.momentum_error, 8e-13, row.method);
        // measured 2.6e-12
        at_most(row.symplecticity_defect, 6e-12, row.method);
    }
    let rk4 = rows.iter().find(|row| row.method == "RK4").unwrap();
    // measured 1.0e+00
    at_least(rk4.energy_slope.abs() * duration / rk4.energy_error, 0.3, "energy of RK4");
    // measured 2.4e-04
    at_least(rk4.momentum_error, 9e-5, "momentum of RK4");
    // measured 8.6e-07
    at_least(rk4.symplecticity_defect, 3e-7, "form of RK4");
}

/// MW figure 1: the energy of variational Newmark oscillates about its start, that of RK4 decays.
#[test]
fn mw_figure_1_newmark_does_not_dissipate_and_rk4_does() {
    let figure = conservative_particle().unwrap();
    let exact = figure.series[0].energy[0];
    let series = |name: &str| &figure.series.iter().find(|s| s.name.starts_with(name)).unwrap().energy;
    let newmark = series("Newmark");
    let late = &newmark[newmark.len() / 2..];
    let mean = |energies: &[f64]| energies.iter().sum::<f64>() / energies.len() as f64;
    // measured 3.7e-05
    at_most((mean(late) - mean(&newmark[..newmark.len() / 2])).abs() / exact, 9e-5, "Newmark");
    // measured 5.7e-02
    at_most(newmark.iter().map(|e| (e - exact).abs()).fold(0.0, f64::max) / exact, 0.2, "Newmark, amplitude");
    // measured 3.4e-01
    at_least(1.0 - series("RK4").last().unwrap() / exact, 0.1, "RK4");
}
