//! Holonomic constraints `phi(q) = 0` (MW section 3.3).

use super::{Matrix, Vector};

/// A constraint `phi: R^n -> R^m` with its first and second derivatives; the manifold is `N = phi^-1(0)`.
pub trait Constraint: Send + Sync {
    /// m
    fn count(&self) -> usize;

    /// `phi(q)`, m
    fn residual(&self, q: &Vector) -> Vector;

    /// `G(q) = d phi / d q`, m x n
    fn jacobian(&self, q: &Vector) -> Matrix;

    /// `sum_k lambda_k d2 phi_k / dq2`, n x n
    fn hessian(&self, q: &Vector, lambda: &Vector) -> Matrix;
}

/// A particle at a fixed distance from the origin: `phi = 1/2 (|q|^2 - l^2)`.
#[derive(Clone, Debug)]
pub struct Sphere {
    pub radius: f64,
}

impl Constraint for Sphere {
    fn count(&self) -> usize {
        1
    }

    fn residual(&self, q: &Vector) -> Vector {
        Vector::from_element(1, 0.5 * (q.norm_squared() - self.radius * self.radius))
    }

    fn jacobian(&self, q: &Vector) -> Matrix {
        Matrix::from_row_slice(1, q.len(), q.as_slice())
    }

    fn hessian(&self, q: &Vector, lambda: &Vector) -> Matrix {
        Matrix::identity(q.len(), q.len()) * lambda[0]
    }
}

/// Two particles in the plane, `q = (x1, y1, x2, y2)`: the first at distance `l1` from the origin, the second at
/// distance `l2` from the first (a double pendulum).
#[derive(Clone, Debug)]
pub struct TwoRods {
    pub lengths: [f64; 2],
}

impl TwoRods {
    fn between(q: &Vector) -> [f64; 2] {
        [q[2] - q[0], q[3] - q[1]]
    }
}

impl Constraint for TwoRods {
    fn count(&self) -> usize {
        2
    }

    fn residual(&self, q: &Vector) -> Vector {
        let [dx, dy] = Self::between(q);
        let [l1, l2] = self.lengths;
        Vector::from_vec(vec![
            0.5 * (q[0] * q[0] + q[1] * q[1] - l1 * l1),
            0.5 * (dx * dx + dy * dy - l2 * l2), //
        ])
    }

    fn jacobian(&self, q: &Vector) -> Matrix {
        let [dx, dy] = Self::between(q);
        Matrix::from_row_slice(2, 4, &[q[0], q[1], 0.0, 0.0, -dx, -dy, dx, dy])
    }

    fn hessian(&self, _q: &Vector, lambda: &Vector) -> Matrix {
        let (a, b) = (lambda[0], lambda[1]);
        Matrix::from_row_slice(4, 4, &[a + b, 0.0, -b, 0.0, 0.0, a + b, 0.0, -b, -b, 0.0, b, 0.0, 0.0, -b, 0.0, b])
    }
}
