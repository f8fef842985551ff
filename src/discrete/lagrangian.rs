//! Discrete Lagrangians and their Legendre transforms (MW sections 1.3 and 1.5, with forces 3.2).

use std::sync::Arc;

use super::force::Force;
use super::solve::SolveError;
use super::{Matrix, Vector};

/// A discrete Lagrangian at `(q0, q1)` with its first and second derivatives; `D1`, `D2` are those in `q0`, `q1`.
#[derive(Clone, Debug)]
pub struct Jet {
    /// `L_d(q0, q1, h)`, J s
    pub value: f64,
    pub d1: Vector,
    pub d2: Vector,
    pub d11: Matrix,
    /// Row `i`, column `j`: `d2 L_d / dq0_i dq1_j`.
    pub d12: Matrix,
    pub d22: Matrix,
}

/// Both discrete Legendre transforms at `(q0, q1)`, with their derivatives.
///
/// Without forces (MW 1.5): `F- L_d: p0 = -D1 L_d(q0, q1)` and `F+ L_d: p1 = D2 L_d(q0, q1)`.
/// With forces (MW 3.2): `p0 = -D1 L_d - f_d-` and `p1 = D2 L_d + f_d+`.
#[derive(Clone, Debug)]
pub struct Legendre {
    pub p0: Vector,
    pub p1: Vector,
    /// `dp0/dq0`, and so on; row `i` belongs to component `i` of the momentum.
    pub p0_q0: Matrix,
    pub p0_q1: Matrix,
    pub p1_q0: Matrix,
    pub p1_q1: Matrix,
}

/// The Legendre transforms under a force, and the discrete forces that enter them.
#[derive(Clone, Debug)]
pub struct Forced {
    pub legendre: Legendre,
    /// `f_d-(q0, q1)`, a covector at `q0`
    pub minus: Vector,
    /// `f_d+(q0, q1)`, a covector at `q1`
    pub plus: Vector,
}

/// Something with two discrete Legendre transforms: all that the maps of `maps` and `constrained` need.
pub trait DiscreteLegendre {
    /// `F-` and `F+` at `(q0, q1)` for the step `h`.
    ///
    /// # Errors
    /// [`SolveError`] where internal points of the discrete Lagrangian cannot be found.
    fn legendre(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Legendre, SolveError>;
}

/// A discrete Lagrangian `L_d(q0, q1, h)`: an approximation of the action along the motion from `q0` to `q1` in time
/// `h` (MW 1.3 and 1.6). `h` may be negative.
pub trait DiscreteLagrangian: Send + Sync {
    /// n
    fn dim(&self) -> usize;

    /// Value and derivatives up to order two.
    ///
    /// # Errors
    /// [`SolveError`] where internal points cannot be found.
    fn jet(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Jet, SolveError>;

    /// The Legendre transforms and the discrete forces under `force` (MW 3.2).
    ///
    /// # Errors
    /// [`SolveError`] where internal points cannot be found.
    fn forced(&self, force: &dyn Force, q0: &Vector, q1: &Vector, h: f64) -> Result<Forced, SolveError>;

    /// `L_d(q0, q1, h)`
    ///
    /// # Errors
    /// [`SolveError`] where internal points cannot be found.
    fn value(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<f64, SolveError> {
        Ok(self.jet(q0, q1, h)?.value)
    }
}

/// A discrete Lagrangian that others are built from.
pub type SharedLagrangian = Arc<dyn DiscreteLagrangian>;

impl<L: DiscreteLagrangian + ?Sized> DiscreteLegendre for L {
    fn legendre(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Legendre, SolveError> {
        let jet = self.jet(q0, q1, h)?;
        Ok(Legendre {
            p0: -jet.d1,
            p1: jet.d2,
            p0_q0: -jet.d11,
            p1_q0: jet.d12.transpose(),
            p0_q1: -jet.d12,
            p1_q1: jet.d22,
        })
    }
}

/// A discrete Lagrangian with the discrete forces of a force: the forced Legendre transforms of MW 3.2.
pub struct WithForce<'a> {
    pub lagrangian: &'a dyn DiscreteLagrangian,
    pub force: &'a dyn Force,
}

impl DiscreteLegendre for WithForce<'_> {
    fn legendre(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Legendre, SolveError> {
        Ok(self.lagrangian.forced(self.force, q0, q1, h)?.legendre)
    }
}
