//! The adjoint of a discrete Lagrangian.

use crate::discrete::Vector;
use crate::discrete::force::Force;
use crate::discrete::lagrangian::{DiscreteLagrangian, Forced, Jet, Legendre, SharedLagrangian};
use crate::discrete::solve::SolveError;

/// ```text
/// L_d*(q0, q1, h) = -L_d(q1, q0, -h)                                                   (MW 2.4.1)
/// f_d*+(q0, q1, h) = -f_d-(q1, q0, -h),     f_d*-(q0, q1, h) = -f_d+(q1, q0, -h)        (MW 3.2)
/// ```
///
/// Its discrete Hamiltonian map is the inverse of that of `L_d` with `-h` (MW theorem 2.4.1).
pub struct Adjoint(pub SharedLagrangian);

impl DiscreteLagrangian for Adjoint {
    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn jet(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Jet, SolveError> {
        let back = self.0.jet(q1, q0, -h)?;
        Ok(Jet {
            value: -back.value,
            d1: -back.d2,
            d2: -back.d1,
            d11: -back.d22,
            d12: -back.d12.transpose(),
            d22: -back.d11,
        })
    }

    fn forced(&self, force: &dyn Force, q0: &Vector, q1: &Vector, h: f64) -> Result<Forced, SolveError> {
        let back = self.0.forced(force, q1, q0, -h)?;
        let Legendre { p0, p1, p0_q0, p0_q1, p1_q0, p1_q1 } = back.legendre;
        // The two ends change places, and the momenta with them.
        let legendre = Legendre { p0: p1, p1: p0, p0_q0: p1_q1, p0_q1: p1_q0, p1_q0: p0_q1, p1_q1: p0_q0 };
        Ok(Forced { legendre, minus: -back.plus, plus: -back.minus })
    }
}
