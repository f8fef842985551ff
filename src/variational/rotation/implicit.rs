//! The rules that are equations for `s`, by Newton's method.

use nalgebra::{Matrix3, Vector3};

/// Newton iterations after which the equation is taken to have no solution nearby.
const MOST_ITERATIONS: usize = 50;

/// The rules that are equations for `s`.
#[derive(Clone, Copy, Debug)]
pub(super) enum Implicit {
    MoserVeselov,
    Cayley,
}

impl Implicit {
    /// Newton's method.
    #[inline]
    pub(super) fn solve(self, inertia: &Vector3<f64>, hm: &Vector3<f64>, start: &Vector3<f64>) -> Option<Vector3<f64>> {
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
    pub(super) fn residual(self, s: &Vector3<f64>, js: &Vector3<f64>, hm: &Vector3<f64>) -> Vector3<f64> {
        let turned = js + s.cross(js);
        match self {
            Implicit::MoserVeselov => 2.0 * turned - (1.0 + s.norm_squared()) * hm,
            Implicit::Cayley => 2.0 * (turned + s * s.dot(js)) - hm,
        }
    }

    /// Derivative of the residual in `s`.
    #[inline(always)]
    pub(super) fn jacobian(
        self,
        inertia: &Vector3<f64>,
        s: &Vector3<f64>,
        js: &Vector3<f64>,
        hm: &Vector3<f64>,
    ) -> Matrix3<f64> {
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
