//! Two evaluations on the chord, symmetric under time reversal.

use super::alpha::node;
use crate::discrete::stencil::{Stencil, StencilLagrangian};
use crate::discrete::system::SharedSystem;

/// ```text
/// L_d^(sym,alpha) = 1/2 L_d^alpha + 1/2 L_d^(1 - alpha)          (MW example 2.3.3)
/// ```
///
/// Self-adjoint and of order 2 for every `alpha`. For `L = 1/2 v^T M v - V(q)` and `alpha` = 0 or 1 it is
/// Stoermer-Verlet (MW 2.6.1), in momentum form velocity Verlet:
///
/// ```text
/// p' = p0 - h/2 dV(q0),     q1 = q0 + h M^-1 p',     p1 = p' - h/2 dV(q1)
/// ```
pub fn symmetrised(system: SharedSystem, alpha: f64) -> StencilLagrangian {
    let nodes = vec![node(0.5, alpha), node(0.5, 1.0 - alpha)];
    StencilLagrangian::new(system, Stencil { nodes, internal: vec![], side_condition: None })
}
