//! Explicit symplectic partitioned Runge-Kutta methods: kicks and drifts in turn.

use crate::discrete::stencil::{Node, Part, Stencil, StencilLagrangian};
use crate::discrete::system::SharedSystem;

/// ```text
/// L_d(q0, q1, h) = ext over x_1 ... x_(s-1) of
///     sum_(i=1..s) 1/2 (x_i - x_(i-1))^T M (x_i - x_(i-1)) / (a_i h)  -  h sum_(i=0..s) b_i V(x_i)     (MW 2.6.3)
/// ```
///
/// with `x_0 = q0`, `x_s = q1`, drifts `a_1 ... a_s` (none 0, sum 1) and kicks `b_0 ... b_s` (sum 1). `None` where the
/// system is not of the form `1/2 v^T M v - V(q)` with constant `M`. A force acts with the kicks, at the mean velocity
/// of the two drifts beside it: where it depends on the velocity that keeps the order of compositions of
/// Stoermer-Verlet steps, such as Forest and Ruth's, and of no others.
pub(crate) fn explicit_prk(system: SharedSystem, kicks: &[f64], drifts: &[f64]) -> Option<StencilLagrangian> {
    system.separable()?;
    let s = drifts.len();
    let unit = |k: usize| (0..=s).map(|j| if j == k { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
    // Velocity row of drift i, from x_(i-1) to x_i.
    let drift = |i: usize| {
        let mut row = vec![0.0; s + 1];
        row[i - 1] = -1.0 / drifts[i - 1];
        row[i] = 1.0 / drifts[i - 1];
        row
    };
    let mut nodes: Vec<Node> = (1..=s)
        .map(|i| Node { part: Part::Kinetic, weight: drifts[i - 1], position: vec![0.0; s + 1], velocity: drift(i) })
        .collect();
    for (i, &kick) in kicks.iter().enumerate().filter(|(_, b)| **b != 0.0) {
        let (before, after) = (drift(i.max(1)), drift((i + 1).min(s)));
        let velocity = before.iter().zip(&after).map(|(a, b)| 0.5 * (a + b)).collect();
        nodes.push(Node { part: Part::Potential, weight: kick, position: unit(i), velocity });
    }
    let reached = |i: usize| drifts[..i].iter().sum::<f64>();
    let internal = (1..s).map(|i| [1.0 - reached(i), reached(i)]).collect();
    Some(StencilLagrangian::new(system, Stencil { nodes, internal, side_condition: None }))
}

/// Ruth's method of order 3 (Ruth 1983), a kick first.
pub fn ruth(system: SharedSystem) -> Option<StencilLagrangian> {
    explicit_prk(system, &[7.0 / 24.0, 3.0 / 4.0, -1.0 / 24.0, 0.0], &[2.0 / 3.0, -2.0 / 3.0, 1.0])
}

/// The method of order 4 of Forest and Ruth (1990), a drift first.
pub(crate) fn forest_ruth(system: SharedSystem) -> Option<StencilLagrangian> {
    let t = 1.0 / (2.0 - 2f64.cbrt());
    let (outer, inner) = (0.5 * t, 0.5 * (1.0 - t));
    explicit_prk(system, &[0.0, t, 1.0 - 2.0 * t, t, 0.0], &[outer, inner, inner, outer])
}
