//! Symplectic partitioned Runge-Kutta methods.

use std::sync::Arc;

use crate::discrete::Matrix;
use crate::discrete::constraint::Constraint;
use crate::discrete::quadrature::{Quadrature, collocation_matrix};
use crate::discrete::stencil::{Node, Part, Stencil, StencilLagrangian};
use crate::discrete::system::SharedSystem;

/// ```text
/// L_d(q0, q1, h) = h sum_i b_i L(Q_i, Q'_i),     Q_i = q0 + h sum_j a_ij Q'_j ,          (MW 2.6.8)
/// ```
///
/// with the `Q'_i` that make the sum stationary under `q1 = q0 + h sum_i b_i Q'_i`. The multiplier of that condition is
/// `p1`. The discrete Hamiltonian map is the partitioned Runge-Kutta method (MW theorem 2.6.1)
///
/// ```text
/// P_i = dL/dv(Q_i, Q'_i),  P'_i = dL/dq(Q_i, Q'_i),  P_i = p0 + h sum_j at_ij P'_j,  p1 = p0 + h sum_i b_i P'_i,
/// b_i at_ij + b_j a_ji = b_i b_j .
/// ```
///
/// The unknowns here are `U_j = h Q'_j`. Every `b_i` must differ from 0.
pub fn partitioned_rk(system: SharedSystem, a: &Matrix, b: &[f64]) -> StencilLagrangian {
    let s = b.len();
    let nodes = (0..s).map(|i| {
        let mut position = vec![1.0];
        position.extend(a.row(i).iter());
        position.push(0.0);
        let mut velocity = vec![0.0; s + 2];
        velocity[i + 1] = 1.0;
        Node { part: Part::Lagrangian, weight: b[i], position, velocity }
    });
    let mut closure = vec![-1.0];
    closure.extend(b.iter().map(|b| -b));
    closure.push(1.0);
    let stencil = Stencil { nodes: nodes.collect(), internal: vec![[-1.0, 1.0]; s], side_condition: Some(closure) };
    StencilLagrangian::new(system, stencil)
}

/// Gauss-Legendre collocation with `s` stages, a symplectic Runge-Kutta method of order 2s.
pub fn gauss(system: SharedSystem, s: usize) -> StencilLagrangian {
    let rule = Quadrature::gauss(s);
    partitioned_rk(system, &collocation_matrix(&rule.nodes), &rule.weights)
}

/// The Lobatto IIIA-IIIB pair with `s >= 2` stages, order 2s - 2. Two stages are Stoermer-Verlet.
pub fn lobatto(system: SharedSystem, s: usize) -> StencilLagrangian {
    let rule = Quadrature::lobatto(s);
    partitioned_rk(system, &collocation_matrix(&rule.nodes), &rule.weights)
}

/// The Lobatto IIIA-IIIB pair with its inner stages on a constraint manifold, a discrete Lagrangian on N x N
/// (MW 3.5.5). With the end points held by `constrained` it is Jay's method of order 2s - 2.
pub fn constrained_lobatto(system: SharedSystem, constraint: Arc<dyn Constraint>, s: usize) -> StencilLagrangian {
    StencilLagrangian { constraint: Some((constraint, (1..s - 1).collect())), ..lobatto(system, s) }
}
