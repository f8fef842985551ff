//! Lagrangian systems on a linear space R^n (MW section 1.2).

use std::sync::Arc;

use super::solve::{SolveError, newton, solve_linear};
use super::{Matrix, Vector};

/// First derivatives of a Lagrangian at `(q, v)`.
#[derive(Clone, Debug)]
pub struct Gradient {
    /// `dL/dq`, n
    pub q: Vector,
    /// `dL/dv`, n
    pub v: Vector,
}

/// Second derivatives of a Lagrangian at `(q, v)`, each n x n.
#[derive(Clone, Debug)]
pub struct Hessian {
    pub qq: Matrix,
    /// Row `i`, column `j`: `d2L / dq_i dv_j`.
    pub qv: Matrix,
    pub vv: Matrix,
}

/// A Lagrangian `L(q, v)` on R^n with its first and second derivatives. The mass `d2L/dv2` may depend on `q`.
pub trait LagrangianSystem: Send + Sync {
    /// n
    fn dim(&self) -> usize;

    /// `L(q, v)`
    fn lagrangian(&self, q: &Vector, v: &Vector) -> f64;

    fn gradient(&self, q: &Vector, v: &Vector) -> Gradient;

    fn hessian(&self, q: &Vector, v: &Vector) -> Hessian;

    /// The parts of `L = 1/2 v^T M v - V(q)`, where `L` has this form with a constant `M`.
    fn separable(&self) -> Option<&dyn Separable> {
        None
    }

    /// Legendre transform FL: `p = dL/dv (q, v)` (MW 1.4).
    fn momentum(&self, q: &Vector, v: &Vector) -> Vector {
        self.gradient(q, v).v
    }

    /// Inverse of the Legendre transform: the `v` with `dL/dv (q, v) = p`.
    ///
    /// # Errors
    /// [`SolveError`] where the Lagrangian is not regular.
    fn velocity(&self, q: &Vector, p: &Vector) -> Result<Vector, SolveError> {
        newton("inverse Legendre transform", Vector::zeros(self.dim()), |v| {
            Ok((self.momentum(q, v) - p, self.hessian(q, v).vv))
        })
    }

    /// Energy `E = dL/dv . v - L`.
    fn energy(&self, q: &Vector, v: &Vector) -> f64 {
        self.momentum(q, v).dot(v) - self.lagrangian(q, v)
    }

    /// Hamiltonian `H(q, p)`: the energy at the velocity that belongs to `p`.
    ///
    /// # Errors
    /// [`SolveError`] where the Lagrangian is not regular.
    fn hamiltonian(&self, q: &Vector, p: &Vector) -> Result<f64, SolveError> {
        Ok(self.energy(q, &self.velocity(q, p)?))
    }

    /// Acceleration from the Euler-Lagrange equations, `L_vv a = L_q - L_vq v` (MW 1.2).
    ///
    /// # Errors
    /// [`SolveError`] where the Lagrangian is not regular.
    fn acceleration(&self, q: &Vector, v: &Vector) -> Result<Vector, SolveError> {
        let hessian = self.hessian(q, v);
        let force = self.gradient(q, v).q - hessian.qv.transpose() * v;
        solve_linear("Euler-Lagrange equations", &hessian.vv, &force)
    }
}

/// The parts of a Lagrangian `1/2 v^T M v - V(q)` with constant `M`.
pub trait Separable: Send + Sync {
    /// `M`, n x n, symmetric and positive definite.
    fn mass(&self) -> &Matrix;
    fn potential(&self, q: &Vector) -> f64;
    fn potential_gradient(&self, q: &Vector) -> Vector;
    fn potential_hessian(&self, q: &Vector) -> Matrix;
}

/// A potential `V(q)` with its first and second derivatives.
pub trait Potential: Send + Sync {
    fn value(&self, q: &Vector) -> f64;
    fn gradient(&self, q: &Vector) -> Vector;
    fn hessian(&self, q: &Vector) -> Matrix;
}

/// `L = 1/2 v^T M v - V(q)` with a constant mass matrix.
#[derive(Clone, Debug)]
pub struct Mechanical<P> {
    pub mass: Matrix,
    pub potential: P,
}

impl<P: Potential> LagrangianSystem for Mechanical<P> {
    fn dim(&self) -> usize {
        self.mass.nrows()
    }

    fn lagrangian(&self, q: &Vector, v: &Vector) -> f64 {
        0.5 * v.dot(&(&self.mass * v)) - self.potential.value(q)
    }

    fn gradient(&self, q: &Vector, v: &Vector) -> Gradient {
        Gradient { q: -self.potential.gradient(q), v: &self.mass * v }
    }

    fn hessian(&self, q: &Vector, _v: &Vector) -> Hessian {
        let n = self.dim();
        Hessian { qq: -self.potential.hessian(q), qv: Matrix::zeros(n, n), vv: self.mass.clone() }
    }

    fn separable(&self) -> Option<&dyn Separable> {
        Some(self)
    }
}

impl<P: Potential> Separable for Mechanical<P> {
    fn mass(&self) -> &Matrix {
        &self.mass
    }

    fn potential(&self, q: &Vector) -> f64 {
        self.potential.value(q)
    }

    fn potential_gradient(&self, q: &Vector) -> Vector {
        self.potential.gradient(q)
    }

    fn potential_hessian(&self, q: &Vector) -> Matrix {
        self.potential.hessian(q)
    }
}

/// A system that several discrete Lagrangians share.
pub type SharedSystem = Arc<dyn LagrangianSystem>;
