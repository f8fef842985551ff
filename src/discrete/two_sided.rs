//! Two discrete Lagrangians, one for each end of a step.

use super::Vector;
use super::lagrangian::{DiscreteLegendre, Legendre};
use super::solve::SolveError;

/// `F-` of one discrete Lagrangian with `F+` of another. Where both have order r the map has only order r - 1 (PC
/// section 4): the momenta that it matches err differently.
pub struct TwoSided<A, B> {
    pub minus: A,
    pub plus: B,
}

impl<A: DiscreteLegendre, B: DiscreteLegendre> DiscreteLegendre for TwoSided<A, B> {
    fn legendre(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Legendre, SolveError> {
        let (at0, at1) = (self.minus.legendre(q0, q1, h)?, self.plus.legendre(q0, q1, h)?);
        Ok(Legendre { p1: at1.p1, p1_q0: at1.p1_q0, p1_q1: at1.p1_q1, ..at0 })
    }
}
