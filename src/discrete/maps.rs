//! The discrete Euler-Lagrange equations and the two maps that solve them (MW sections 1.3, 1.5 and 2.1).

use super::lagrangian::DiscreteLegendre;
use super::solve::{SolveError, newton, solve_columns};
use super::{Matrix, Vector};

/// Residual of the discrete Euler-Lagrange equations at the middle point,
/// `D2 L_d(q0, q1) + D1 L_d(q1, q2)` (MW 1.3.3; with forces 3.2.2: `+ f_d+(q0, q1) + f_d-(q1, q2)`).
///
/// # Errors
/// Those of the discrete Lagrangian.
pub fn euler_lagrange_residual(
    ld: &(impl DiscreteLegendre + ?Sized),
    q0: &Vector,
    q1: &Vector,
    q2: &Vector,
    h: f64,
) -> Result<Vector, SolveError> {
    Ok(ld.legendre(q0, q1, h)?.p1 - ld.legendre(q1, q2, h)?.p0)
}

/// Position form, the discrete Lagrangian map `(q0, q1) -> (q1, q2)` (MW 1.3.3, 2.1.1): returns `q2`.
///
/// The guess is the straight continuation `2 q1 - q0`.
///
/// # Errors
/// [`SolveError`] where `q2` is not found.
pub fn lagrangian_map(
    ld: &(impl DiscreteLegendre + ?Sized),
    q0: &Vector,
    q1: &Vector,
    h: f64,
) -> Result<Vector, SolveError> {
    let p1 = ld.legendre(q0, q1, h)?.p1;
    newton("discrete Lagrangian map", q1 * 2.0 - q0, |q2| {
        let next = ld.legendre(q1, q2, h)?;
        Ok((next.p0 - &p1, next.p0_q1))
    })
}

/// Momentum form, the discrete Hamiltonian map `(q0, p0) -> (q1, p1)` (MW 2.1.2):
///
/// ```text
/// p0 = -D1 L_d(q0, q1)      implicit in q1
/// p1 =  D2 L_d(q0, q1)
/// ```
///
/// `guess` starts the iteration for `q1`; MW 2.1.1 takes an explicit method for it. From `q0` itself the first Newton
/// step is such a method, since `D12 L_d = -M/h` to leading order.
///
/// # Errors
/// [`SolveError`] where `q1` is not found.
pub(crate) fn hamiltonian_map_from(
    ld: &(impl DiscreteLegendre + ?Sized),
    q0: &Vector,
    p0: &Vector,
    guess: Vector,
    h: f64,
) -> Result<(Vector, Vector), SolveError> {
    let q1 = newton("discrete Hamiltonian map", guess, |q1| {
        let at = ld.legendre(q0, q1, h)?;
        Ok((at.p0 - p0, at.p0_q1))
    })?;
    let p1 = ld.legendre(q0, &q1, h)?.p1;
    Ok((q1, p1))
}

/// `hamiltonian_map_from` with the guess `q0`.
///
/// # Errors
/// [`SolveError`] where `q1` is not found.
pub fn hamiltonian_map(
    ld: &(impl DiscreteLegendre + ?Sized),
    q0: &Vector,
    p0: &Vector,
    h: f64,
) -> Result<(Vector, Vector), SolveError> {
    hamiltonian_map_from(ld, q0, p0, q0.clone(), h)
}

/// Derivative of the discrete Hamiltonian map by the implicit function theorem, 2n x 2n, in the order `(q, p)`.
///
/// # Errors
/// [`SolveError`] where `q1` is not found or `D12 L_d` is singular.
pub fn hamiltonian_map_derivative(
    ld: &(impl DiscreteLegendre + ?Sized),
    q0: &Vector,
    p0: &Vector,
    h: f64,
) -> Result<Matrix, SolveError> {
    let n = q0.len();
    let (q1, _) = hamiltonian_map(ld, q0, p0, h)?;
    let at = ld.legendre(q0, &q1, h)?;
    // p0 = P(q0, q1) gives dq1 = P_q1^-1 (dp0 - P_q0 dq0).
    let mut right = Matrix::zeros(n, 2 * n);
    right.view_mut((0, 0), (n, n)).copy_from(&-&at.p0_q0);
    right.view_mut((0, n), (n, n)).fill_with_identity();
    let q1_by = solve_columns("derivative of the map", &at.p0_q1, &right)?;
    let mut p1_by = &at.p1_q1 * &q1_by;
    let mut left = p1_by.view_mut((0, 0), (n, n));
    left += &at.p1_q0;
    let mut derivative = Matrix::zeros(2 * n, 2 * n);
    derivative.view_mut((0, 0), (n, 2 * n)).copy_from(&q1_by);
    derivative.view_mut((n, 0), (n, 2 * n)).copy_from(&p1_by);
    Ok(derivative)
}
