//! The turn of a free rigid body over a step, from parts of the rotational energy that can be integrated exactly.
//!
//! ```text
//! 1/2 m . J^-1 m = |m|^2 / (2 J_b) + 1/2 (1/J_a - 1/J_b) m_a^2 + 1/2 (1/J_c - 1/J_b) m_c^2
//! ```
//!
//! in the angular momentum `m` in body axes (McLachlan 1993; Reich 1994; Touma and Wisdom 1994). The first part turns
//! the body by `h m / J_b` and leaves `m` as it is, so it commutes with the others; each of those turns the body about
//! a principal axis and `m` back about the same axis. The symmetric composition of the parts is symplectic,
//! time-reversible, of order 2, and keeps `pi = R m`. Its error is that of the commutator of the last two parts, which
//! is of the size of `(1/J_a - 1/J_b)(1/J_c - 1/J_b)`: the axis `b` is the one that makes this smallest, and with two
//! equal moments the turn is that of the free body (Hairer, Lubich and Wanner 2006, section VII.5).

use nalgebra::{Matrix3, Quaternion, Vector3};

/// The parts for one body.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct Split {
    /// `1 / J_b`, 1/(kg m^2).
    base: f64,
    /// The axes `a`, `c` and their `1/J_k - 1/J_b`; `a` is turned about before and after `c`.
    axes: [(usize, f64); 2],
}

impl Split {
    /// `inertia` holds the principal moments, kg m^2.
    #[inline]
    pub(in crate::variational) fn of(inertia: &Vector3<f64>) -> Split {
        let inverse = inertia.map(|j| 1.0 / j);
        let at = |b: usize| {
            let (a, c) = ((b + 1) % 3, (b + 2) % 3);
            (b, (a, inverse[a] - inverse[b]), (c, inverse[c] - inverse[b]))
        };
        let error = |(_, a, c): &(usize, (usize, f64), (usize, f64))| (a.1 * c.1).abs();
        let mut best = at(0);
        for other in [at(1), at(2)] {
            if error(&other) < error(&best) {
                best = other;
            }
        }
        let (b, a, c) = best;
        // The turn about the larger difference stands in the middle: where one is zero, one turn is left.
        let axes = if a.1.abs() > c.1.abs() { [c, a] } else { [a, c] };
        Split { base: inverse[b], axes }
    }

    /// The turns about principal axes in their order, as axis and `angle / (h m_axis)`.
    fn turns(&self) -> [(usize, f64); 3] {
        let [(a, half), (c, whole)] = self.axes;
        [(a, 0.5 * half), (c, whole), (a, 0.5 * half)]
    }

    /// The rotation `F` of a body with `hm = h m0`, as a quaternion.
    #[inline]
    pub(in crate::variational) fn rotation(&self, hm: &Vector3<f64>) -> Quaternion<f64> {
        let mut f = exponential(&(hm * self.base));
        let mut hm = *hm;
        for (axis, factor) in self.turns() {
            if factor != 0.0 {
                let turn = about(axis, factor * hm[axis]);
                f *= turn;
                hm = rotate_back(&turn, &hm);
            }
        }
        f
    }

    /// The action of [`Split::rotation`] times the step, kg m^2: each part is a flow that keeps its energy, whose
    /// action is that energy times the part's time.
    pub(in crate::variational) fn action(&self, hm: &Vector3<f64>) -> f64 {
        let mut action = 0.5 * self.base * hm.norm_squared();
        let mut hm = *hm;
        for (axis, factor) in self.turns() {
            action += 0.5 * factor * hm[axis] * hm[axis];
            hm = rotate_back(&about(axis, factor * hm[axis]), &hm);
        }
        action
    }

    /// The Cayley vector of [`Split::rotation`]. `None` where the turn is exactly pi, or the momentum is not a number.
    #[inline]
    pub(in crate::variational) fn cayley_vector(&self, hm: &Vector3<f64>) -> Option<Vector3<f64>> {
        let f = self.rotation(hm);
        let s = f.imag() / f.w;
        s.iter().all(|x| x.is_finite()).then_some(s)
    }

    /// `d eta / d(h m0)`, where a change of `m0` turns `F` by the rotation vector `d eta` on its left.
    pub(in crate::variational) fn derivative(&self, hm: &Vector3<f64>) -> Matrix3<f64> {
        // Of the factors so far: their product, its rotation vector on the right, and the momentum, by `h m0`.
        let mut f = exponential(&(hm * self.base));
        let mut turned = right_derivative(&(hm * self.base)) * self.base;
        let (mut hm, mut momentum) = (*hm, Matrix3::identity());
        for (axis, factor) in self.turns() {
            let turn = about(axis, factor * hm[axis]);
            let back = matrix(&turn).transpose();
            f *= turn;
            hm = back * hm;
            let angle = momentum.row(axis) * factor;
            let unit = Vector3::ith(axis, 1.0);
            turned = back * turned + unit * angle;
            momentum = back * momentum - unit.cross(&hm) * angle;
        }
        matrix(&f) * turned
    }
}

/// The rotation by the vector `u`.
#[inline]
fn exponential(u: &Vector3<f64>) -> Quaternion<f64> {
    let angle = u.norm();
    let (sin, cos) = (0.5 * angle).sin_cos();
    let v = u * if angle > 0.0 { sin / angle } else { 0.5 };
    Quaternion::new(cos, v.x, v.y, v.z)
}

/// The rotation about a principal axis.
#[inline]
fn about(axis: usize, angle: f64) -> Quaternion<f64> {
    let (sin, cos) = (0.5 * angle).sin_cos();
    let mut q = Quaternion::new(cos, 0.0, 0.0, 0.0);
    q.coords[axis] = sin;
    q
}

/// `E^T v`
#[inline]
fn rotate_back(turn: &Quaternion<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    let u = -turn.imag();
    let once = u.cross(v) * 2.0;
    v + once * turn.w + u.cross(&once)
}

fn matrix(q: &Quaternion<f64>) -> Matrix3<f64> {
    let s = q.imag().cross_matrix();
    Matrix3::identity() + 2.0 * (q.w * s + s * s)
}

/// `D` in `exp(-u) exp(u + du) = exp(D du)` to first order.
fn right_derivative(u: &Vector3<f64>) -> Matrix3<f64> {
    let (angle, cross) = (u.norm(), u.cross_matrix());
    // (1 - cos x) / x^2 and (x - sin x) / x^3; by their series where the quotients cancel.
    let (a, b) = if angle > 1e-2 {
        ((1.0 - angle.cos()) / (angle * angle), (angle - angle.sin()) / (angle * angle * angle))
    } else {
        (0.5 - angle * angle / 24.0, 1.0 / 6.0 - angle * angle / 120.0)
    };
    Matrix3::identity() - cross * a + cross * cross * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::UnitQuaternion;

    /// Body and momentum turned by the exact flow: many short steps of the classical Runge-Kutta method.
    fn exact(inertia: &Vector3<f64>, hm: &Vector3<f64>) -> Quaternion<f64> {
        let slope = |q: &Quaternion<f64>| {
            let omega = rotate_back(q, hm).component_div(inertia);
            q * Quaternion::from_imag(omega) * 0.5
        };
        let (mut q, n) = (Quaternion::identity(), 20_000);
        let dt = 1.0 / n as f64;
        for _ in 0..n {
            let k1 = slope(&q);
            let k2 = slope(&(q + k1 * (0.5 * dt)));
            let k3 = slope(&(q + k2 * (0.5 * dt)));
            let k4 = slope(&(q + k3 * dt));
            q += (k1 + (k2 + k3) * 2.0 + k4) * (dt / 6.0);
        }
        q
    }

    #[test]
    fn a_body_with_two_equal_moments_turns_as_a_free_body_at_any_speed() {
        for inertia in [Vector3::new(1e-2, 2.3, 2.3), Vector3::new(1.7, 0.4, 1.7), Vector3::new(1.0, 1.0, 1.6)] {
            let hm = inertia.component_mul(&Vector3::new(2.1, -1.3, 0.8));
            let error = (Split::of(&inertia).rotation(&hm) - exact(&inertia, &hm)).norm();
            println!("{error:e}");
            // measured at most 2e-13
            assert!(error <= 6e-13, "{error:e}");
        }
    }

    /// `h` only scales the momentum, so half the momentum is half the step.
    #[test]
    fn the_error_of_one_step_of_an_asymmetric_body_is_of_order_three() {
        let (inertia, hm) = (Vector3::new(1.0, 2.3, 2.9), Vector3::new(0.5, -0.8, 0.7));
        let error = |part: f64| (Split::of(&inertia).rotation(&(hm * part)) - exact(&inertia, &(hm * part))).norm();
        let orders: Vec<f64> =
            [0.5, 0.25, 0.125].iter().map(|part| (error(2.0 * part) / error(*part)).log2()).collect();
        // measured 3.06, 3.02, 3.01
        assert!(orders.iter().all(|p| (p - 3.0).abs() <= 0.12), "{orders:?}");
    }

    /// A turn back from the end, with the momentum reversed, is the inverse turn.
    #[test]
    fn the_turn_is_time_reversible() {
        let (inertia, hm) = (Vector3::new(1.0, 2.3, 2.9), Vector3::new(1.5, -4.8, 3.7));
        let split = Split::of(&inertia);
        let f = split.rotation(&hm);
        let back = split.rotation(&-rotate_back(&f, &hm));
        // measured 4e-16
        assert_relative_eq!((f * back).coords, Quaternion::identity().coords, epsilon = 1e-15);
    }

    /// Turning `F` by a small `eta` on its left changes `h L_d` by `h m0 . eta`.
    #[test]
    fn the_action_has_the_momentum_as_its_derivative() {
        let hm = Vector3::new(0.9, -1.8, 2.7);
        for inertia in [Vector3::new(1.0, 2.3, 2.9), Vector3::new(0.9, 2.3, 2.3)] {
            let split = Split::of(&inertia);
            let turn = split.derivative(&hm);
            for i in 0..3 {
                let step = Vector3::ith(i, 1e-4);
                let slope = (split.action(&(hm + step)) - split.action(&(hm - step))) / 2e-4;
                let error = (slope - hm.dot(&turn.column(i))).abs();
                println!("{error:e}");
                // measured 7.5e-11
                assert!(error <= 2e-10, "{error:e}");
            }
        }
    }

    #[test]
    fn the_derivative_is_that_of_central_differences() {
        let hm = Vector3::new(0.9, -1.8, 2.7);
        for inertia in [Vector3::new(1.0, 2.3, 2.9), Vector3::new(0.9, 2.3, 2.3), Vector3::repeat(1.4)] {
            let split = Split::of(&inertia);
            let turn = |hm: &Vector3<f64>| UnitQuaternion::new_unchecked(split.rotation(hm));
            for i in 0..3 {
                let step = Vector3::ith(i, 1e-5);
                let central = (turn(&(hm + step)) * turn(&(hm - step)).inverse()).scaled_axis() / 2e-5;
                // measured 1e-10
                assert_relative_eq!(split.derivative(&hm).column(i).into_owned(), central, epsilon = 3e-10);
            }
        }
    }
}
