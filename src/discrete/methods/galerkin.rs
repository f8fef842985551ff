//! Galerkin methods: the action is stationary within a finite-dimensional space of trajectories.

use crate::discrete::quadrature::{Quadrature, cardinal};
use crate::discrete::stencil::{Node, Part, Stencil, StencilLagrangian};
use crate::discrete::system::SharedSystem;

/// ```text
/// L_d(q0, q1, h) = ext over polynomials q of degree s, q(0) = q0, q(h) = q1, of
///                  h sum_i b_i L(q(c_i h), q'(c_i h))                                  (MW 2.6.10)
/// ```
///
/// The internal points are the values of `q` at the inner Lobatto nodes. Order `min(2s, u)` for a quadrature of order
/// `u`, which must have at least `s` nodes.
pub fn polynomial(system: SharedSystem, degree: usize, quadrature: &Quadrature) -> StencilLagrangian {
    let control = Quadrature::lobatto(degree + 1).nodes;
    let nodes = quadrature.nodes.iter().zip(&quadrature.weights).map(|(&c, &weight)| {
        let (position, velocity) = cardinal(&control, c);
        Node { part: Part::Lagrangian, weight, position, velocity }
    });
    let internal = control[1..degree].iter().map(|&c| [1.0 - c, c]).collect();
    StencilLagrangian::new(system, Stencil { nodes: nodes.collect(), internal, side_condition: None })
}
