//! Discrete Lagrangians that differ by a null Lagrangian.

use std::sync::Arc;

use crate::discrete::Vector;
use crate::discrete::force::Force;
use crate::discrete::lagrangian::{DiscreteLagrangian, Forced, Jet, SharedLagrangian};
use crate::discrete::solve::SolveError;
use crate::discrete::system::Potential;

/// ```text
/// L_d(q0, q1, h) + h^k (f(q1) - f(q0))                                                  (MW 2.1.2)
/// ```
///
/// The term added is null: it cancels from the discrete Euler-Lagrange equations, so the map in position form is the
/// same (weak equivalence). Momenta shift by `h^k df(q)`, and the discrete Hamiltonian map is conjugate by that shift.
/// With `f = b . q` and `k = 1` it is the example of PC section 2.
pub struct Equivalent {
    pub lagrangian: SharedLagrangian,
    pub null: Arc<dyn Potential>,
    /// k
    pub power: i32,
}

impl DiscreteLagrangian for Equivalent {
    fn dim(&self) -> usize {
        self.lagrangian.dim()
    }

    fn jet(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Jet, SolveError> {
        let c = h.powi(self.power);
        let jet = self.lagrangian.jet(q0, q1, h)?;
        Ok(Jet {
            value: jet.value + c * (self.null.value(q1) - self.null.value(q0)),
            d1: jet.d1 - self.null.gradient(q0) * c,
            d2: jet.d2 + self.null.gradient(q1) * c,
            d11: jet.d11 - self.null.hessian(q0) * c,
            d12: jet.d12,
            d22: jet.d22 + self.null.hessian(q1) * c,
        })
    }

    fn forced(&self, force: &dyn Force, q0: &Vector, q1: &Vector, h: f64) -> Result<Forced, SolveError> {
        let c = h.powi(self.power);
        let mut forced = self.lagrangian.forced(force, q0, q1, h)?;
        forced.legendre.p0 += self.null.gradient(q0) * c;
        forced.legendre.p1 += self.null.gradient(q1) * c;
        forced.legendre.p0_q0 += self.null.hessian(q0) * c;
        forced.legendre.p1_q1 += self.null.hessian(q1) * c;
        Ok(forced)
    }
}
