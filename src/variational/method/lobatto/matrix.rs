//! Rotations as matrices.

use nalgebra::{Matrix3, Vector3};

/// `v` in `hat(v) = X - X^T`.
pub(super) fn twice_skew(x: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(x[(2, 1)] - x[(1, 2)], x[(0, 2)] - x[(2, 0)], x[(1, 0)] - x[(0, 1)])
}

/// The Cayley vector of the rotation `F = 1 + B`: `hat(s) = (F - F^T) / (1 + tr F)`.
pub(super) fn cayley_vector(turn: &Matrix3<f64>) -> Vector3<f64> {
    twice_skew(turn) / (4.0 + turn.trace())
}
