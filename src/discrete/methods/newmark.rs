//! Newmark's method as a variational integrator.

use crate::discrete::force::Force;
use crate::discrete::lagrangian::{DiscreteLagrangian, Forced, Jet, Legendre};
use crate::discrete::solve::{SolveError, central_difference};
use crate::discrete::system::{Separable, SharedSystem};
use crate::discrete::{Matrix, Vector};

/// Newmark with gamma = 1/2 and any beta (MW 2.6.2):
///
/// ```text
/// q1 = q0 + h v0 + h^2 ((1/2 - beta) a0 + beta a1),     v1 = v0 + h/2 (a0 + a1),     M a = -dV(q)
/// ```
///
/// In `x = q + beta h^2 M^-1 dV(q)`, the inverse of the map `eta^beta` of MW (2.6.3), it is Stoermer-Verlet for the
/// potential `V~(x) = V(q) + 1/2 beta h^2 dV(q)^T M^-1 dV(q)`:
///
/// ```text
/// L_d(q0, q1, h) = h/2 w^T M w - h/2 (V~(x0) + V~(x1)),     w = (x1 - x0)/h .
/// ```
///
/// Its momentum is `p = (dx/dq)^T M v`, not `M v`. Order 2. `D11` and `D22` hold third derivatives of `V` and are
/// taken by central differences of `D1` and `D2` (error about 1e-11 of their size); `D12`, and with it the symplectic
/// form, is exact.
pub struct Newmark {
    system: SharedSystem,
    /// Inverse of the mass matrix.
    inverse_mass: Matrix,
    beta: f64,
}

/// Step of the differences for `D11` and `D22`, in units of `q`.
const DIFFERENCE: f64 = 1e-3;

impl Newmark {
    /// `None` where the system is not of the form `1/2 v^T M v - V(q)` with constant `M`.
    pub fn new(system: SharedSystem, beta: f64) -> Option<Self> {
        let inverse_mass = system.separable()?.mass().clone().try_inverse()?;
        Some(Newmark { system, inverse_mass, beta })
    }

    /// # Errors
    /// [`SolveError::Undefined`] where the system has lost its parts; [`Newmark::new`] has made sure that it has them.
    fn parts(&self) -> Result<&dyn Separable, SolveError> {
        self.system.separable().ok_or(SolveError::Undefined { what: "Newmark needs a constant mass matrix" })
    }

    /// The points `x` and `dx/dq = I + beta h^2 M^-1 V''` that belong to `q`.
    fn shift(&self, parts: &dyn Separable, q: &Vector, h: f64) -> (Vector, Matrix) {
        let c = self.beta * h * h;
        let x = q + &self.inverse_mass * parts.potential_gradient(q) * c;
        let n = q.len();
        (x, Matrix::identity(n, n) + &self.inverse_mass * parts.potential_hessian(q) * c)
    }

    /// Value, `D1`, `D2` and `D12`. Here `dV~/dx = dV(q)`.
    fn first(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<(f64, Vector, Vector, Matrix), SolveError> {
        let parts = self.parts()?;
        let ((x0, slope0), (x1, slope1)) = (self.shift(parts, q0, h), self.shift(parts, q1, h));
        let (g0, g1) = (parts.potential_gradient(q0), parts.potential_gradient(q1));
        let w = (x1 - x0) / h;
        let p = parts.mass() * &w;
        let c = 0.5 * self.beta * h * h;
        let energy0 = parts.potential(q0) + c * g0.dot(&(&self.inverse_mass * &g0));
        let energy1 = parts.potential(q1) + c * g1.dot(&(&self.inverse_mass * &g1));
        Ok((
            0.5 * h * (w.dot(&p) - energy0 - energy1),
            slope0.transpose() * (-&p - &g0 * (0.5 * h)),
            slope1.transpose() * (&p - &g1 * (0.5 * h)),
            slope0.transpose() * parts.mass() * slope1 / -h,
        ))
    }
}

impl DiscreteLagrangian for Newmark {
    fn dim(&self) -> usize {
        self.system.dim()
    }

    fn jet(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Jet, SolveError> {
        let (value, d1, d2, d12) = self.first(q0, q1, h)?;
        let d11 = central_difference(q0, DIFFERENCE, |q0| Ok(self.first(q0, q1, h)?.1))?;
        let d22 = central_difference(q1, DIFFERENCE, |q1| Ok(self.first(q0, q1, h)?.2))?;
        Ok(Jet { value, d1, d2, d11, d12, d22 })
    }

    /// Half of the force at each end, at the velocity of the chord.
    fn forced(&self, force: &dyn Force, q0: &Vector, q1: &Vector, h: f64) -> Result<Forced, SolveError> {
        let jet = self.jet(q0, q1, h)?;
        let v = (q1 - q0) / h;
        let (minus, plus) = (force.value(q0, &v) * (0.5 * h), force.value(q1, &v) * (0.5 * h));
        let ((m_q, m_v), (p_q, p_v)) = (force.jacobian(q0, &v), force.jacobian(q1, &v));
        let legendre = Legendre {
            p0: -jet.d1 - &minus,
            p1: jet.d2 + &plus,
            p0_q0: -jet.d11 - m_q * (0.5 * h) + &m_v * 0.5,
            p1_q0: jet.d12.transpose() - &p_v * 0.5,
            p0_q1: -jet.d12 - m_v * 0.5,
            p1_q1: jet.d22 + p_q * (0.5 * h) + p_v * 0.5,
        };
        Ok(Forced { legendre, minus, plus })
    }
}
