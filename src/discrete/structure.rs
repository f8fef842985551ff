//! What a discrete Lagrangian conserves: the symplectic form and the momentum maps (MW sections 1.3.1 to 1.3.5).

use super::lagrangian::DiscreteLegendre;
use super::solve::{SolveError, central_difference};
use super::{Matrix, Vector};

/// Discrete symplectic form `Omega_Ld = d2 L_d / dq0_i dq1_j  dq0_i ^ dq1_j` (MW 1.3.2) as the antisymmetric matrix
/// `W` with `Omega(x, y) = x^T W y`, for `x = (dq0, dq1)`, 2n x 2n.
///
/// # Errors
/// Those of the discrete Lagrangian.
pub fn symplectic_form(
    ld: &(impl DiscreteLegendre + ?Sized),
    q0: &Vector,
    q1: &Vector,
    h: f64,
) -> Result<Matrix, SolveError> {
    let n = q0.len();
    let d12 = -ld.legendre(q0, q1, h)?.p0_q1;
    let mut form = Matrix::zeros(2 * n, 2 * n);
    form.view_mut((0, n), (n, n)).copy_from(&d12);
    form.view_mut((n, 0), (n, n)).copy_from(&-d12.transpose());
    Ok(form)
}

/// The canonical form `dq ^ dp` on T*R^n as a matrix, 2n x 2n.
pub fn canonical_form(n: usize) -> Matrix {
    let mut form = Matrix::zeros(2 * n, 2 * n);
    form.view_mut((0, n), (n, n)).fill_with_identity();
    for i in 0..n {
        form[(n + i, i)] = -1.0;
    }
    form
}

/// How far a map of T*R^n is from symplectic at `(q, p)`: the largest entry of `A^T J A - J`, where `A` is the
/// derivative of the map by central differences with the given step. The map is taken as it is: nothing is known of it.
///
/// # Errors
/// Whatever the map returns.
pub fn symplecticity_defect<F>(q: &Vector, p: &Vector, step: f64, mut map: F) -> Result<f64, SolveError>
where
    F: FnMut(&Vector, &Vector) -> Result<(Vector, Vector), SolveError>,
{
    let n = q.len();
    let derivative = central_difference(&join(q, p), step, |z| {
        let (q, p) = split(z);
        let (q, p) = map(&q, &p)?;
        Ok(join(&q, &p))
    })?;
    let form = canonical_form(n);
    Ok((derivative.transpose() * &form * derivative - form).amax())
}

/// Discrete momentum maps of a symmetry with infinitesimal generator `xi(q)` (MW 1.3.4):
/// `J- = -D1 L_d(q0, q1) . xi(q0)` and `J+ = D2 L_d(q0, q1) . xi(q1)`. They agree where `L_d` is invariant.
///
/// # Errors
/// Those of the discrete Lagrangian.
pub fn momentum_maps(
    ld: &(impl DiscreteLegendre + ?Sized),
    generator: impl Fn(&Vector) -> Vector,
    q0: &Vector,
    q1: &Vector,
    h: f64,
) -> Result<(f64, f64), SolveError> {
    let at = ld.legendre(q0, q1, h)?;
    Ok((at.p0.dot(&generator(q0)), at.p1.dot(&generator(q1))))
}

/// Puts two vectors into one.
pub fn join(a: &Vector, b: &Vector) -> Vector {
    Vector::from_iterator(a.len() + b.len(), a.iter().chain(b.iter()).copied())
}

/// Cuts a vector into halves.
pub fn split(z: &Vector) -> (Vector, Vector) {
    let n = z.len() / 2;
    (z.rows(0, n).into_owned(), z.rows(n, n).into_owned())
}
