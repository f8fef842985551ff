//! How a body turns over one step: `R1 = R0 F(s)` with the Cayley rotation `F(s)`, the quaternion `(1, s) / sqrt(1 + |s|^2)`.
//!
//! The vector `s` follows from the body's angular momentum `m0 = R0^T pi` (body axes) by the discrete Legendre transform of
//! the rule's discrete Lagrangian. All rules are variational, of order 2 and time-reversible, and leave `pi` as it is.
//!
//! Moser-Veselov makes the step RATTLE proper and has no solution once a body turns by about 1 rad a step; the splitting is
//! explicit, exact for a body with two equal moments, and has no such limit. Measured energy errors of RATTLE with each rule:
//!
//! | motion | step | Moser-Veselov | Cayley | splitting |
//! | --- | --- | --- | --- | --- |
//! | top at 300 rad/s, 1 s | 1 ms | 5.5e-5 | 1.7e-3 | 6.4e-6 |
//! | | 10 ms | no solution | 5.4e-2 | 6.4e-4 |
//! | chain of 10 rods, 2 s | 1 ms | 1.21e-5 | 1.03e-5 | 1.15e-5 |
//! | chain of 5 asymmetric links, 1 s | 10 ms | 1.5e-3 | 9.9e-4 | 1.4e-3 |
//! | whip of 50 rods, 5 s | 2 ms | 1.08e-4 | 9.1e-5 | 1.02e-4 |
//!
//! On ordinary chains the rules differ by 10 to 40 %, so RATTLE proper is the default while it can be solved; a fast body is
//! where they part, and there the splitting is the most accurate.

use nalgebra::{Matrix3, Vector3};

use super::free_body::Split;

/// Newton iterations after which the equation is taken to have no solution nearby.
const MOST_ITERATIONS: usize = 50;

/// A discrete Lagrangian of the free rigid body. A new rule is one variant with its row of each function below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rotation {
    /// RATTLE on `R^(3x3)` with the constraint `R^T R = 1` (Marsden and West 2001, sections 2.1 and 3.5.4; Moser and
    /// Veselov 1991), `L_d = 1/h tr((1 - F) Jd)`:
    ///
    /// ```text
    /// h m0 = 2 / (1 + |s|^2) (J s + s x J s) .
    /// ```
    ///
    /// About a principal axis that is `J sin(theta) / h = m`: there is no solution once `h |Omega|` passes about 1.
    MoserVeselov,
    /// The angular velocity of the Cayley map, `w = 2 s / h`, in `L_d = h/2 w . J w`:
    ///
    /// ```text
    /// h m0 = 2 (J s + s x J s + s (s . J s)) .
    /// ```
    ///
    /// It has a solution for every `m0`: a body may turn as fast as it likes, its angle then lags behind.
    Cayley,
    /// The rotational energy in parts that can be integrated exactly (McLachlan 1993; Reich 1994), composed symmetrically:
    ///
    /// ```text
    /// 1/2 m . J^-1 m = |m|^2 / (2 J_b) + sum_k 1/2 (1/J_k - 1/J_b) m_k^2 ,
    /// F = exp(h m0 / J_b) E_a(1/2) E_c(1) E_a(1/2) ,   E_k(w) = exp(w h (1/J_k - 1/J_b) m_k e_k) .
    /// ```
    ///
    /// The first part commutes with the others, which are rotations about principal axes. `J_b` is the moment that makes
    /// the product of the two differences smallest: a body with two equal moments turns exactly as a free body does.
    Splitting,
}

impl Rotation {
    /// Solves the rule for `s`, to roundoff.
    ///
    /// `inertia` holds the principal moments (kg m^2), `hm` is `h m0` (kg m^2, body axes), `start` a guess for the rules
    /// that are solved by Newton's method. `None` where that does not converge: the step is too long for the angular velocity.
    #[inline]
    pub fn solve(self, inertia: &Vector3<f64>, hm: &Vector3<f64>, start: &Vector3<f64>) -> Option<Vector3<f64>> {
        match self {
            Rotation::MoserVeselov => Implicit::MoserVeselov.solve(inertia, hm, start),
            Rotation::Cayley => Implicit::Cayley.solve(inertia, hm, start),
            Rotation::Splitting => Split::of(inertia).cayley_vector(hm),
        }
    }

    /// `h L_d`, which depends on the turn alone: `L_d` is this over the step, and the discrete energy `-dL_d/dh` at a fixed turn
    /// this over its square, kg m^2.
    pub(super) fn action(self, inertia: &Vector3<f64>, s: &Vector3<f64>, hm: &Vector3<f64>) -> f64 {
        let square = 2.0 * s.dot(&inertia.component_mul(s));
        match self {
            Rotation::MoserVeselov => square / (1.0 + s.norm_squared()),
            Rotation::Cayley => square,
            Rotation::Splitting => Split::of(inertia).action(hm),
        }
    }

    /// `K` in `d(h m0) = K ds / (1 + |s|^2)` at a solution.
    pub(super) fn derivative(self, inertia: &Vector3<f64>, s: &Vector3<f64>, hm: &Vector3<f64>) -> Matrix3<f64> {
        let jacobian = |rule: Implicit| rule.jacobian(inertia, s, &inertia.component_mul(s), hm);
        match self {
            Rotation::MoserVeselov => jacobian(Implicit::MoserVeselov),
            Rotation::Cayley => jacobian(Implicit::Cayley) * (1.0 + s.norm_squared()),
            Rotation::Splitting => {
                // d eta = 2 / (1 + |s|^2) (ds + s x ds)
                let by_turn = Split::of(inertia).derivative(hm).try_inverse().unwrap_or_else(Matrix3::zeros);
                2.0 * by_turn * (Matrix3::identity() + s.cross_matrix())
            }
        }
    }
}

/// The rules that are equations for `s`.
#[derive(Clone, Copy, Debug)]
enum Implicit {
    MoserVeselov,
    Cayley,
}

impl Implicit {
    /// Newton's method.
    #[inline]
    fn solve(self, inertia: &Vector3<f64>, hm: &Vector3<f64>, start: &Vector3<f64>) -> Option<Vector3<f64>> {
        let mut s = *start;
        // The error after a Newton update is about the update squared, times the ratio of the moments.
        let ratio = inertia.x.max(inertia.y).max(inertia.z) / inertia.x.min(inertia.y).min(inertia.z);
        for _ in 0..MOST_ITERATIONS {
            let js = inertia.component_mul(&s);
            let update = solve(&self.jacobian(inertia, &s, &js, hm), &self.residual(&s, &js, hm))?;
            s -= update;
            if update.norm_squared() * ratio <= 1e-17 * s.norm() {
                return self.on_branch(&s).then_some(s);
            }
        }
        // Near the limit the last bits keep moving; a residual at roundoff is a solution all the same.
        let js = inertia.component_mul(&s);
        (self.residual(&s, &js, hm).norm() <= 1e-14 * (hm.norm() + js.norm()) && self.on_branch(&s)).then_some(s)
    }

    /// Moser-Veselov has a second solution that does not shrink with the step: about a principal axis, the turn by
    /// `pi - theta` beside `theta`. A run that slips over to it goes on with a wrong motion. The two meet at `|s| = 1`.
    #[inline(always)]
    fn on_branch(self, s: &Vector3<f64>) -> bool {
        matches!(self, Implicit::Cayley) || s.norm_squared() < 1.0
    }

    /// Left minus right side of the rule, for Moser-Veselov times `1 + |s|^2`. `js` is `J s`.
    #[inline(always)]
    fn residual(self, s: &Vector3<f64>, js: &Vector3<f64>, hm: &Vector3<f64>) -> Vector3<f64> {
        let turned = js + s.cross(js);
        match self {
            Implicit::MoserVeselov => 2.0 * turned - (1.0 + s.norm_squared()) * hm,
            Implicit::Cayley => 2.0 * (turned + s * s.dot(js)) - hm,
        }
    }

    /// Derivative of the residual in `s`.
    #[inline(always)]
    fn jacobian(self, inertia: &Vector3<f64>, s: &Vector3<f64>, js: &Vector3<f64>, hm: &Vector3<f64>) -> Matrix3<f64> {
        // J + [s] J - [J s]
        let (a, b, c) = (inertia.x, inertia.y, inertia.z);
        let turned = Matrix3::new(
            a,
            js.z - b * s.z,
            c * s.y - js.y,
            a * s.z - js.z,
            b,
            js.x - c * s.x,
            js.y - a * s.y,
            b * s.x - js.x,
            c,
        );
        2.0 * match self {
            Implicit::MoserVeselov => turned - hm * s.transpose(),
            Implicit::Cayley => turned + Matrix3::from_diagonal_element(s.dot(js)) + 2.0 * s * js.transpose(),
        }
    }
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

    use Rotation::{Cayley, MoserVeselov};

    fn cayley(s: &Vector3<f64>) -> Matrix3<f64> {
        UnitQuaternion::from_quaternion(Quaternion::new(1.0, s.x, s.y, s.z)).to_rotation_matrix().into_inner()
    }

    /// The equation as Moser and Veselov write it: `skew(h m0) = F Jd - Jd F^T` with `Jd = 1/2 tr(J) 1 - J`.
    #[test]
    fn the_cayley_form_solves_the_matrix_equation() {
        let inertia = Vector3::new(1.0, 2.3, 2.9);
        let hm = Vector3::new(0.11, -0.23, 0.31);
        let s = MoserVeselov.solve(&inertia, &hm, &Vector3::zeros()).unwrap();
        let jd = Matrix3::from_diagonal(&inertia.map(|j| 0.5 * inertia.sum() - j));
        let f = cayley(&s);
        // measured 2e-16
        assert_relative_eq!(f * jd - jd * f.transpose(), hm.cross_matrix(), epsilon = 5e-16);
    }

    #[test]
    fn about_a_principal_axis_the_sine_of_the_angle_is_h_omega() {
        let inertia = Vector3::new(1.0, 2.3, 2.9);
        let s = MoserVeselov.solve(&inertia, &Vector3::new(0.0, 2.3 * 0.5, 0.0), &Vector3::zeros()).unwrap();
        assert_relative_eq!((2.0 * s.y.atan()).sin(), 0.5, epsilon = 1e-15);
    }

    #[test]
    fn the_turn_by_more_than_a_right_angle_is_not_taken_for_a_solution() {
        let (inertia, hm) = (Vector3::new(1.0, 2.3, 2.9), Vector3::new(0.0, 2.3 * 0.9, 0.0));
        // sin(theta) = 0.9 twice: theta = 1.12 and theta = 2.02.
        let far = Vector3::new(0.0, (0.5 * (std::f64::consts::PI - 0.9_f64.asin())).tan(), 0.0);
        let residual = Implicit::MoserVeselov.residual(&far, &inertia.component_mul(&far), &hm);
        assert!(residual.norm() <= 1e-14, "it is a solution: {residual}");
        assert_eq!(MoserVeselov.solve(&inertia, &hm, &far), None);
        assert!(MoserVeselov.solve(&inertia, &hm, &Vector3::zeros()).is_some());
    }

    #[test]
    fn past_h_omega_one_there_is_no_solution() {
        let inertia = Vector3::new(1.0, 2.3, 2.9);
        assert_eq!(MoserVeselov.solve(&inertia, &Vector3::new(0.0, 2.3 * 1.01, 0.0), &Vector3::zeros()), None);
    }

    /// `m0` is the derivative of `L_d` with respect to the start: turning `R0` by a small `eta` (body axes) turns `F` to
    /// `exp(-eta) F` and changes `L_d` by `-m0 . eta`.
    #[test]
    fn both_equations_are_the_legendre_transforms_of_their_lagrangians() {
        let (inertia, hm) = (Vector3::new(1.0, 2.3, 2.9), Vector3::new(0.11, -0.23, 0.31));
        let jd = Matrix3::from_diagonal(&inertia.map(|j| 0.5 * inertia.sum() - j));
        for rule in [Implicit::MoserVeselov, Implicit::Cayley] {
            let s = rule.solve(&inertia, &hm, &Vector3::zeros()).unwrap();
            // h L_d
            let lagrangian = |f: &UnitQuaternion<f64>| match rule {
                Implicit::MoserVeselov => ((Matrix3::identity() - f.to_rotation_matrix().into_inner()) * jd).trace(),
                Implicit::Cayley => {
                    let s = f.imag() / f.w;
                    2.0 * s.dot(&inertia.component_mul(&s))
                }
            };
            let f = UnitQuaternion::from_quaternion(Quaternion::new(1.0, s.x, s.y, s.z));
            for axis in 0..3 {
                let eta = UnitQuaternion::from_scaled_axis(Vector3::ith(axis, 1e-5));
                let slope = (lagrangian(&(eta.inverse() * f)) - lagrangian(&(eta * f))) / 2e-5;
                // measured 3e-11
                assert!((slope + hm[axis]).abs() <= 1e-10, "{rule:?} {axis}: {slope} {}", hm[axis]);
            }
        }
    }

    #[test]
    fn the_cayley_rule_has_a_solution_however_fast_the_body_turns() {
        let inertia = Vector3::new(1e-2, 2.3, 2.305);
        for scale in [1.0, 10.0, 1e3, 1e6] {
            let hm = inertia.component_mul(&Vector3::new(0.3, -0.5, 0.8)) * scale;
            let s = Cayley.solve(&inertia, &hm, &Vector3::zeros()).unwrap();
            let residual = Implicit::Cayley.residual(&s, &inertia.component_mul(&s), &hm);
            assert!(residual.norm() <= 1e-14 * hm.norm(), "{scale}: {:e}", residual.norm() / hm.norm());
        }
    }

    #[test]
    fn the_jacobian_is_the_derivative() {
        let (inertia, hm) = (Vector3::new(1.0, 2.3, 2.9), Vector3::new(0.11, -0.23, 0.31));
        let s = Vector3::new(0.2, 0.3, -0.4);
        for rule in [Implicit::MoserVeselov, Implicit::Cayley] {
            let f = |s: &Vector3<f64>| rule.residual(s, &inertia.component_mul(s), &hm);
            let exact = rule.jacobian(&inertia, &s, &inertia.component_mul(&s), &hm);
            for i in 0..3 {
                let step = Vector3::ith(i, 1e-5);
                let central = (f(&(s + step)) - f(&(s - step))) / 2e-5;
                // measured 7.9e-10 (third derivatives of the Cayley rule)
                assert_relative_eq!(exact.column(i).into_owned(), central, epsilon = 2e-9);
            }
        }
    }
}
