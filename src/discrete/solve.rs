//! Newton's method, iterated until roundoff stops it.

use std::fmt;

use super::{Matrix, Vector};

/// Why an implicit equation could not be solved.
#[derive(Clone, Debug, PartialEq)]
pub enum SolveError {
    /// The steps did not come down to roundoff.
    NotConverged { what: &'static str, iterations: usize, step: f64 },
    /// The Jacobian has no inverse.
    Singular { what: &'static str },
    /// The method is not defined for this system.
    Undefined { what: &'static str },
}

impl fmt::Display for SolveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SolveError::NotConverged { what, iterations, step } => {
                write!(f, "{what}: Newton's method did not converge in {iterations} iterations (last step {step:e})")
            }
            SolveError::Singular { what } => write!(f, "{what}: the Jacobian is singular"),
            SolveError::Undefined { what } => write!(f, "{what}"),
        }
    }
}

impl std::error::Error for SolveError {}

const MOST_ITERATIONS: usize = 60;
/// Relative size below which a step that no longer shrinks counts as roundoff.
const ROUNDOFF_ZONE: f64 = 1e-7;

/// Solves `f(x) = 0` from the guess `x`; `f` returns the residual and its Jacobian.
///
/// There is no tolerance: the iteration ends when the steps have stopped shrinking at the level of roundoff, because
/// the long-time behaviour of a symplectic map rests on it.
///
/// # Errors
/// [`SolveError`] where the steps do not get there or a Jacobian is singular.
pub fn newton<F>(what: &'static str, mut x: Vector, mut f: F) -> Result<Vector, SolveError>
where
    F: FnMut(&Vector) -> Result<(Vector, Matrix), SolveError>,
{
    let mut last_step = f64::INFINITY;
    for _ in 0..MOST_ITERATIONS {
        let (residual, jacobian) = f(&x)?;
        let dx = solve_linear(what, &jacobian, &residual)?;
        let step = dx.amax();
        let scale = x.amax().max(f64::MIN_POSITIVE);
        if !step.is_finite() {
            break;
        }
        let small = step <= ROUNDOFF_ZONE * scale;
        if small && step >= 0.5 * last_step {
            return Ok(x);
        }
        x -= dx;
        if step <= 0.5 * f64::EPSILON * scale {
            return Ok(x);
        }
        last_step = step;
    }
    Err(SolveError::NotConverged { what, iterations: MOST_ITERATIONS, step: last_step })
}

/// Solves `a x = b` by LU.
///
/// # Errors
/// [`SolveError::Singular`] where `a` has a zero pivot.
pub fn solve_linear(what: &'static str, a: &Matrix, b: &Vector) -> Result<Vector, SolveError> {
    if a.nrows() == 0 {
        return Ok(Vector::zeros(0));
    }
    a.clone().lu().solve(b).ok_or(SolveError::Singular { what })
}

/// Solves `a X = b` for all columns of `b`.
///
/// # Errors
/// [`SolveError::Singular`] where `a` has a zero pivot.
pub(crate) fn solve_columns(what: &'static str, a: &Matrix, b: &Matrix) -> Result<Matrix, SolveError> {
    if a.nrows() == 0 {
        return Ok(Matrix::zeros(0, b.ncols()));
    }
    a.clone().lu().solve(b).ok_or(SolveError::Singular { what })
}

/// Derivative of `f` at `x` by the six-point central difference, error `O(step^6)`. Column `j` belongs to `x_j`.
///
/// # Errors
/// Whatever `f` returns.
pub fn central_difference<F>(x: &Vector, step: f64, mut f: F) -> Result<Matrix, SolveError>
where
    F: FnMut(&Vector) -> Result<Vector, SolveError>,
{
    const WEIGHTS: [(f64, f64); 3] = [(1.0, 3.0 / 4.0), (2.0, -3.0 / 20.0), (3.0, 1.0 / 60.0)];
    let mut columns = Vec::with_capacity(x.len());
    for j in 0..x.len() {
        let mut shifted = x.clone();
        let mut column: Option<Vector> = None;
        for (reach, weight) in WEIGHTS {
            shifted[j] = x[j] + reach * step;
            let up = f(&shifted)?;
            shifted[j] = x[j] - reach * step;
            let term = (up - f(&shifted)?) * (weight / step);
            column = Some(column.map_or(term.clone(), |sum| sum + term));
        }
        columns.extend(column);
    }
    Ok(if columns.is_empty() { Matrix::zeros(0, 0) } else { Matrix::from_columns(&columns) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newton_ends_at_the_root_to_the_last_digit() {
        let root = newton("square root", Vector::from_element(1, 1.0), |x| {
            Ok((Vector::from_element(1, x[0] * x[0] - 2.0), Matrix::from_element(1, 1, 2.0 * x[0])))
        });
        assert!((root.map(|x| x[0]).unwrap_or(f64::NAN) - 2f64.sqrt()).abs() <= 4.5e-16);
    }

    #[test]
    fn newton_names_the_equation_that_has_no_root() {
        let error = newton("x^2 + 1", Vector::from_element(1, 0.3), |x| {
            Ok((Vector::from_element(1, x[0] * x[0] + 1.0), Matrix::from_element(1, 1, 2.0 * x[0])))
        });
        assert!(error.is_err_and(|e| e.to_string().starts_with("x^2 + 1: ")));
    }
}
