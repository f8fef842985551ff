//! How a body turns over one step: the discrete Moser-Veselov equation.
//!
//! RATTLE on `R^(3x3)` with the constraint `R^T R = 1` (Marsden and West 2001, sections 2.1 and 3.5.4; Moser and Veselov
//! 1991) turns a body from `R0` to `R1 = R0 F`. With the Cayley rotation `F(s)`, the quaternion
//! `(1, s) / sqrt(1 + |s|^2)`, and the body's angular momentum `m0 = R0^T pi`, it reads
//!
//! ```text
//! h m0 = 2 / (1 + |s|^2) (J s + s x J s) .
//! ```
//!
//! About a principal axis that is `J sin(theta) / h = m`: there is no solution once `h |Omega|` passes about 1.

use nalgebra::{Matrix3, Vector3};

/// Newton iterations after which the equation is taken to have no solution nearby.
const MOST_ITERATIONS: usize = 30;

/// Solves the Moser-Veselov equation for `s` by Newton's method, to roundoff.
///
/// `inertia` holds the principal moments (kg m^2), `hm` is `h m0` (kg m^2, body axes), `start` a guess.
/// `None` where the iteration does not converge: the step is too long for the angular velocity.
#[inline]
pub fn moser_veselov(inertia: &Vector3<f64>, hm: &Vector3<f64>, start: &Vector3<f64>) -> Option<Vector3<f64>> {
    let mut s = *start;
    // The error after a Newton update is about the update squared, times the ratio of the moments.
    let ratio = inertia.max() / inertia.min();
    for _ in 0..MOST_ITERATIONS {
        let js = inertia.component_mul(&s);
        let residual = 2.0 * (js + s.cross(&js)) - (1.0 + s.norm_squared()) * hm;
        let update = solve(&jacobian(inertia, &s, &js, hm), &residual)?;
        s -= update;
        if update.norm_squared() * ratio <= 1e-17 * s.norm() {
            return Some(s);
        }
    }
    // Near the limit the last bits keep moving; a residual at roundoff is a solution all the same.
    let js = inertia.component_mul(&s);
    let residual = 2.0 * (js + s.cross(&js)) - (1.0 + s.norm_squared()) * hm;
    (residual.norm() <= 1e-14 * (hm.norm() + js.norm())).then_some(s)
}

/// Derivative of `2 (J s + s x J s) - (1 + |s|^2) h m0` in `s`; `js` is `J s`.
#[inline(always)]
pub(super) fn jacobian(inertia: &Vector3<f64>, s: &Vector3<f64>, js: &Vector3<f64>, hm: &Vector3<f64>) -> Matrix3<f64> {
    // 2 (J + [s] J - [J s]) - 2 h m0 s^T
    let (a, b, c) = (inertia.x, inertia.y, inertia.z);
    Matrix3::new(
        a - hm.x * s.x,
        js.z - b * s.z - hm.x * s.y,
        c * s.y - js.y - hm.x * s.z,
        a * s.z - js.z - hm.y * s.x,
        b - hm.y * s.y,
        js.x - c * s.x - hm.y * s.z,
        js.y - a * s.y - hm.z * s.x,
        b * s.x - js.x - hm.z * s.y,
        c - hm.z * s.z,
    ) * 2.0
}

/// Solves a 3 x 3 system by Cramer's rule; `None` where the determinant is zero or not a number.
#[inline(always)]
fn solve(a: &Matrix3<f64>, b: &Vector3<f64>) -> Option<Vector3<f64>> {
    let (c0, c1, c2) = (a.column(0).into_owned(), a.column(1).into_owned(), a.column(2).into_owned());
    let c12 = c1.cross(&c2);
    let determinant = c0.dot(&c12);
    if !(determinant.abs() > 0.0) {
        return None;
    }
    let inverse = 1.0 / determinant;
    Some(Vector3::new(b.dot(&c12) * inverse, b.dot(&c2.cross(&c0)) * inverse, b.dot(&c0.cross(&c1)) * inverse))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::{Quaternion, UnitQuaternion};

    fn cayley(s: &Vector3<f64>) -> Matrix3<f64> {
        UnitQuaternion::from_quaternion(Quaternion::new(1.0, s.x, s.y, s.z)).to_rotation_matrix().into_inner()
    }

    /// The equation as Moser and Veselov write it: `skew(h m0) = F Jd - Jd F^T` with `Jd = 1/2 tr(J) 1 - J`.
    #[test]
    fn the_cayley_form_solves_the_matrix_equation() {
        let inertia = Vector3::new(1.0, 2.3, 2.9);
        let hm = Vector3::new(0.11, -0.23, 0.31);
        let s = moser_veselov(&inertia, &hm, &Vector3::zeros()).unwrap();
        let jd = Matrix3::from_diagonal(&inertia.map(|j| 0.5 * inertia.sum() - j));
        let f = cayley(&s);
        // measured 2e-16
        assert_relative_eq!(f * jd - jd * f.transpose(), hm.cross_matrix(), epsilon = 5e-16);
    }

    #[test]
    fn about_a_principal_axis_the_sine_of_the_angle_is_h_omega() {
        let inertia = Vector3::new(1.0, 2.3, 2.9);
        let s = moser_veselov(&inertia, &Vector3::new(0.0, 2.3 * 0.5, 0.0), &Vector3::zeros()).unwrap();
        assert_relative_eq!((2.0 * s.y.atan()).sin(), 0.5, epsilon = 1e-15);
    }

    #[test]
    fn past_h_omega_one_there_is_no_solution() {
        let inertia = Vector3::new(1.0, 2.3, 2.9);
        assert_eq!(moser_veselov(&inertia, &Vector3::new(0.0, 2.3 * 1.01, 0.0), &Vector3::zeros()), None);
    }

    #[test]
    fn the_jacobian_is_the_derivative() {
        let (inertia, hm) = (Vector3::new(1.0, 2.3, 2.9), Vector3::new(0.11, -0.23, 0.31));
        let s = Vector3::new(0.2, 0.3, -0.4);
        let f = |s: &Vector3<f64>| {
            let js = inertia.component_mul(s);
            2.0 * (js + s.cross(&js)) - (1.0 + s.norm_squared()) * hm
        };
        let exact = jacobian(&inertia, &s, &inertia.component_mul(&s), &hm);
        for i in 0..3 {
            let step = Vector3::ith(i, 1e-5);
            let central = (f(&(s + step)) - f(&(s - step))) / 2e-5;
            // measured 3e-11
            assert_relative_eq!(exact.column(i).into_owned(), central, epsilon = 1e-10);
        }
    }
}
