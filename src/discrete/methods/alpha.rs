//! One evaluation of the Lagrangian on the chord.

use crate::discrete::stencil::{Node, Part, Stencil, StencilLagrangian};
use crate::discrete::system::SharedSystem;

/// ```text
/// L_d^alpha(q0, q1, h) = h L((1 - alpha) q0 + alpha q1, (q1 - q0)/h)                   (MW example 2.3.2)
/// ```
///
/// `alpha` = 0 and 1 are the two symplectic Euler methods, 1/2 is the midpoint rule. Order 1, and 2 for 1/2.
pub fn alpha(system: SharedSystem, alpha: f64) -> StencilLagrangian {
    StencilLagrangian::new(system, Stencil { nodes: vec![node(1.0, alpha)], internal: vec![], side_condition: None })
}

/// A node at the fraction `alpha` of the chord.
pub(super) fn node(weight: f64, alpha: f64) -> Node {
    Node { part: Part::Lagrangian, weight, position: vec![1.0 - alpha, alpha], velocity: vec![-1.0, 1.0] }
}
