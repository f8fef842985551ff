//! The rules.

use nalgebra::{Matrix3, Vector3};

use super::free_body::Split;
use super::implicit::Implicit;

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
    /// The rotational energy in parts that can be integrated exactly (McLachlan 1993; Reich 1994), composed
    /// symmetrically:
    ///
    /// ```text
    /// 1/2 m . J^-1 m = |m|^2 / (2 J_b) + sum_k 1/2 (1/J_k - 1/J_b) m_k^2 ,
    /// F = exp(h m0 / J_b) E_a(1/2) E_c(1) E_a(1/2) ,   E_k(w) = exp(w h (1/J_k - 1/J_b) m_k e_k) .
    /// ```
    ///
    /// The first part commutes with the others, which are rotations about principal axes. `J_b` is the moment that
    /// makes the product of the two differences smallest: a body with two equal moments turns exactly as a free body
    /// does.
    Splitting,
}

impl Rotation {
    /// Solves the rule for `s`, to roundoff.
    ///
    /// `inertia` holds the principal moments (kg m^2), `hm` is `h m0` (kg m^2, body axes), `start` a guess for the
    /// rules that are solved by Newton's method. `None` where that does not converge: the step is too long for the
    /// angular velocity.
    #[inline]
    pub fn solve(self, inertia: &Vector3<f64>, hm: &Vector3<f64>, start: &Vector3<f64>) -> Option<Vector3<f64>> {
        match self {
            Rotation::MoserVeselov => Implicit::MoserVeselov.solve(inertia, hm, start),
            Rotation::Cayley => Implicit::Cayley.solve(inertia, hm, start),
            Rotation::Splitting => Split::of(inertia).cayley_vector(hm),
        }
    }

    /// `h L_d`, which depends on the turn alone: `L_d` is this over the step, and the discrete energy `-dL_d/dh` at a
    /// fixed turn this over its square, kg m^2.
    pub(in crate::variational) fn action(self, inertia: &Vector3<f64>, s: &Vector3<f64>, hm: &Vector3<f64>) -> f64 {
        let square = 2.0 * s.dot(&inertia.component_mul(s));
        match self {
            Rotation::MoserVeselov => square / (1.0 + s.norm_squared()),
            Rotation::Cayley => square,
            Rotation::Splitting => Split::of(inertia).action(hm),
        }
    }

    /// `d(h m0) / d eta` at a solution, where `eta` turns `F` on its left: the body's inertia for changes of its turn
    /// in a step, body axes, kg m^2.
    #[inline(always)]
    pub(in crate::variational) fn inertia(
        self,
        inertia: &Vector3<f64>,
        s: &Vector3<f64>,
        hm: &Vector3<f64>,
    ) -> Matrix3<f64> {
        match self {
            Rotation::MoserVeselov => {
                // Of `[h m0] = F Jd - Jd F^T` with `Jd = 1/2 tr(J) 1 - J`, since `[eta] A + A^T [eta] = [(tr(A) 1 - A)
                // eta]`.
                let (half, cross) = (0.5 * inertia.sum(), s.cross_matrix());
                let turned = (2.0 / (1.0 + s.norm_squared())) * (cross + cross * cross);
                let mut negative = turned + Matrix3::identity();
                for k in 0..3 {
                    negative.column_mut(k).scale_mut(inertia[k] - half);
                }
                negative - Matrix3::from_diagonal_element(negative.trace())
            }
            Rotation::Cayley => {
                // d eta = 2 / (1 + |s|^2) (1 + [s]) ds , and (1 + [s])^-1 = (1 - [s] + s s^T) / (1 + |s|^2)
                let by_s = Implicit::Cayley.jacobian(inertia, s, &inertia.component_mul(s), hm);
                0.5 * by_s * (Matrix3::identity() - s.cross_matrix() + s * s.transpose())
            }
            Rotation::Splitting => Split::of(inertia).derivative(hm).try_inverse().unwrap_or_else(Matrix3::zeros),
        }
    }
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

    /// `m0` is the derivative of `L_d` with respect to the start: turning `R0` by a small `eta` (body axes) turns `F`
    /// to `exp(-eta) F` and changes `L_d` by `-m0 . eta`.
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
    fn the_inertia_of_a_turn_is_the_derivative() {
        let (inertia, hm) = (Vector3::new(1.0, 2.3, 2.9), Vector3::new(0.11, -0.23, 0.31));
        for rule in [MoserVeselov, Cayley, Rotation::Splitting] {
            let solve = |hm: &Vector3<f64>| rule.solve(&inertia, hm, &Vector3::zeros()).unwrap();
            let s = solve(&hm);
            let exact = rule.inertia(&inertia, &s, &hm).try_inverse().unwrap();
            for i in 0..3 {
                let step = Vector3::ith(i, 1e-5);
                let f = |hm: &Vector3<f64>| {
                    let s = solve(hm);
                    UnitQuaternion::from_quaternion(Quaternion::new(1.0, s.x, s.y, s.z))
                };
                let central = (f(&(hm + step)) * f(&(hm - step)).inverse()).scaled_axis() / 2e-5;
                // measured 2e-11
                assert_relative_eq!(exact.column(i).into_owned(), central, epsilon = 1e-10);
            }
        }
    }
}
