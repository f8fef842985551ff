//! The classical Runge-Kutta method of order 4 on the equations of motion in joint coordinates: accurate, explicit, and
//! not symplectic.

use rattlebench::discrete::solve::central_difference;
use rattlebench::discrete::{Matrix, Vector};
use rattlebench::measure::structure::{PhaseChart, body_momenta, twists};
use rattlebench::mechanics::{State, System};

/// One step of size `h`.
pub fn step(system: &System, state: &State, h: f64) -> State {
    let chart = PhaseChart::about(system, state);
    let theta = chart.coordinates(state);
    let jacobian = chart.jacobian(&theta);
    let rate = jacobian.svd(true, true).solve(&twists(state), 1e-12).expect("both sides of the decomposition");
    let slope = |theta: Vector, rate: Vector| {
        let acceleration = acceleration(&chart, system, &theta, &rate);
        (rate, acceleration)
    };
    let (v1, a1) = slope(theta.clone(), rate.clone());
    let (v2, a2) = slope(&theta + &v1 * (0.5 * h), &rate + &a1 * (0.5 * h));
    let (v3, a3) = slope(&theta + &v2 * (0.5 * h), &rate + &a2 * (0.5 * h));
    let (v4, a4) = slope(&theta + &v3 * h, &rate + &a3 * h);
    let mean = |k1: Vector, k2: Vector, k3: Vector, k4: Vector| (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
    chart.state(&(theta + mean(v1, v2, v3, v4)), &(rate + mean(a1, a2, a3, a4)))
}

/// `thetaddot` from d'Alembert's principle `J^T (d(M v)/dt - f) = 0` with `v = J thetadot`: the momenta of the bodies at
/// constant rates are differenced along the motion, and `J^T M J thetaddot` makes up for what they lack.
fn acceleration(chart: &PhaseChart, system: &System, theta: &Vector, rate: &Vector) -> Vector {
    let momenta = |t: f64| {
        let state = chart.state(&(theta + rate * t), rate);
        body_momenta(system, &state, &twists(&state))
    };
    let start = Vector::zeros(1);
    let change: Matrix = central_difference(&start, 1e-3, |t| Ok(momenta(t[0]))).expect("nothing fails");
    let mut force = -change.column(0);
    for (i, body) in system.bodies.iter().enumerate() {
        let mut linear = force.fixed_rows_mut::<3>(6 * i);
        linear += body.mass * system.gravity;
    }
    let generalised = chart.jacobian(theta).tr_mul(&force);
    chart.mass_matrix(theta).cholesky().expect("a positive mass matrix").solve(&generalised)
}
