//! Maps on a constraint manifold N (MW sections 3.4 and 3.5; with forces 3.7).
//!
//! The discrete Lagrangian is one on R^n, restricted to N x N by multipliers. With Stoermer-Verlet the momentum form is
//! RATTLE (MW 3.5.3 and 3.5.4) and the position form is SHAKE (MW 3.5.2).

use super::constraint::Constraint;
use super::lagrangian::DiscreteLegendre;
use super::solve::{SolveError, newton};
use super::system::LagrangianSystem;
use super::{Matrix, Vector};

/// A point of T*N with the multipliers that led to it.
#[derive(Clone, Debug)]
pub struct ConstrainedStep {
    pub q: Vector,
    pub p: Vector,
    /// Impulses of the constraint at the start and at the end of the step.
    pub impulses: (Vector, Vector),
}

/// Constrained discrete Hamiltonian map (MW 3.5.2; with forced Legendre transforms 3.7.2):
///
/// ```text
/// p0 = -D1 L_d(q0, q1) - G(q0)^T lambda0          phi(q1) = 0
/// p1 =  D2 L_d(q0, q1) + G(q1)^T lambda1          G(q1) v1 = 0,   p1 = dL/dv(q1, v1)
/// ```
///
/// for `phi(q0) = 0` and `G(q0) v0 = 0`. The momentum `p1` is the unique representative tangent to N.
///
/// # Errors
/// [`SolveError`] where `q1` or `p1` is not found.
pub fn constrained_map(
    ld: &(impl DiscreteLegendre + ?Sized),
    system: &dyn LagrangianSystem,
    constraint: &dyn Constraint,
    q0: &Vector,
    p0: &Vector,
    h: f64,
) -> Result<ConstrainedStep, SolveError> {
    let (q1, lambda0) = position_step(ld, constraint, q0, p0, q0.clone(), h)?;
    let free = ld.legendre(q0, &q1, h)?.p1;
    let guess = (&q1 - q0) / h;
    let (p, lambda1) = tangent_momentum(system, constraint, &q1, &free, guess)?;
    Ok(ConstrainedStep { q: q1, p, impulses: (lambda0, lambda1) })
}

/// Constrained discrete Lagrangian map `(q0, q1) -> (q1, q2)` (MW 3.4.1; SHAKE for Stoermer-Verlet): returns `q2`.
///
/// ```text
/// D2 L_d(q0, q1) + D1 L_d(q1, q2) + G(q1)^T lambda = 0,     phi(q2) = 0
/// ```
///
/// # Errors
/// [`SolveError`] where `q2` is not found.
pub fn shake(
    ld: &(impl DiscreteLegendre + ?Sized),
    constraint: &dyn Constraint,
    q0: &Vector,
    q1: &Vector,
    h: f64,
) -> Result<Vector, SolveError> {
    let p1 = ld.legendre(q0, q1, h)?.p1;
    Ok(position_step(ld, constraint, q1, &p1, q1 * 2.0 - q0, h)?.0)
}

/// Several constrained maps in a row, of the steps `g_i h` (MW 2.5 and 3.5.3).
///
/// # Errors
/// Those of [`constrained_map`].
pub fn composed(
    ld: &(impl DiscreteLegendre + ?Sized),
    system: &dyn LagrangianSystem,
    constraint: &dyn Constraint,
    start: (&Vector, &Vector),
    h: f64,
    weights: &[f64],
) -> Result<(Vector, Vector), SolveError> {
    let (mut q, mut p) = (start.0.clone(), start.1.clone());
    for weight in weights {
        let step = constrained_map(ld, system, constraint, &q, &p, weight * h)?;
        (q, p) = (step.q, step.p);
    }
    Ok((q, p))
}

/// `q1` on N and the multiplier with `F-(q0, q1) = p0 + G(q0)^T lambda`.
fn position_step(
    ld: &(impl DiscreteLegendre + ?Sized),
    constraint: &dyn Constraint,
    q0: &Vector,
    p0: &Vector,
    guess: Vector,
    h: f64,
) -> Result<(Vector, Vector), SolveError> {
    let (n, m) = (q0.len(), constraint.count());
    let push = constraint.jacobian(q0).transpose();
    let x = newton("constrained step", guess.resize_vertically(n + m, 0.0), |x| {
        let (q1, lambda) = (x.rows(0, n).into_owned(), x.rows(n, m).into_owned());
        let at = ld.legendre(q0, &q1, h)?;
        let top = &at.p0 - p0 - &push * lambda;
        Ok(saddle(&top, &constraint.residual(&q1), &at.p0_q1, &push, &constraint.jacobian(&q1)))
    })?;
    Ok((x.rows(0, n).into_owned(), x.rows(n, m).into_owned()))
}

/// `p + G^T lambda` that belongs to a velocity tangent to N: the projection `T*Q -> T*N` followed by the embedding of
/// T*N by the Legendre transform (MW 3.3).
///
/// # Errors
/// [`SolveError`] where the Lagrangian is not regular along N.
pub fn tangent_momentum(
    system: &dyn LagrangianSystem,
    constraint: &dyn Constraint,
    q: &Vector,
    p: &Vector,
    guess: Vector,
) -> Result<(Vector, Vector), SolveError> {
    let (n, m) = (q.len(), constraint.count());
    let jacobian = constraint.jacobian(q);
    let push = jacobian.transpose();
    let x = newton("momentum on the constraint", guess.resize_vertically(n + m, 0.0), |x| {
        let (v, lambda) = (x.rows(0, n).into_owned(), x.rows(n, m).into_owned());
        let top = system.momentum(q, &v) - p - &push * lambda;
        Ok(saddle(&top, &(&jacobian * &v), &system.hessian(q, &v).vv, &push, &jacobian))
    })?;
    Ok((system.momentum(q, &x.rows(0, n).into_owned()), x.rows(n, m).into_owned()))
}

/// Stacks the residual `(top, bottom)` and the matrix `[[a, -push], [jacobian, 0]]`.
fn saddle(top: &Vector, bottom: &Vector, a: &Matrix, push: &Matrix, jacobian: &Matrix) -> (Vector, Matrix) {
    let (n, m) = (top.len(), bottom.len());
    let mut matrix = Matrix::zeros(n + m, n + m);
    matrix.view_mut((0, 0), (n, n)).copy_from(a);
    matrix.view_mut((0, n), (n, m)).copy_from(&-push);
    matrix.view_mut((n, 0), (m, n)).copy_from(jacobian);
    (super::structure::join(top, bottom), matrix)
}
