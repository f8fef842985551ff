//! Quaternions `(x, y, z, w)` of any length, as four numbers.

use nalgebra::{Quaternion, UnitQuaternion};

use super::linear::{Matrix3, Vector3};
use super::real::Real;

/// The rotation of a quaternion `(x, y, z, w)` of any length.
pub(in crate::reduced) fn rotation(q: &[f64]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_normalize(Quaternion::new(q[3], q[0], q[1], q[2]))
}

/// The rotation of a quaternion `(x, y, z, w)` of any length.
#[inline(always)]
pub(in crate::reduced) fn matrix<T: Real>(q: &[T]) -> Matrix3<T> {
    let (x, y, z, w) = (q[0], q[1], q[2], q[3]);
    let (one, s) = (T::one(), T::of(2.0) / (x * x + y * y + z * z + w * w));
    Matrix3::from_columns([
        Vector3::new(one - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)),
        Vector3::new(s * (x * y - w * z), one - s * (x * x + z * z), s * (y * z + w * x)),
        Vector3::new(s * (x * z + w * y), s * (y * z - w * x), one - s * (x * x + y * y)),
    ])
}

/// The product of two quaternions `(x, y, z, w)`.
#[inline(always)]
fn product<T: Real>(a: &[T; 4], b: &[T; 4]) -> [T; 4] {
    [
        a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
        a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
        a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
        a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
    ]
}

/// The rate of `q` at an angular velocity in link axes, `1/2 q (0, omega)` as `(x, y, z, w)`.
pub(in crate::reduced) fn rate<T: Real>(q: &[T], omega: &[T], out: &mut [T]) {
    let rate = product(&[q[0], q[1], q[2], q[3]], &[omega[0], omega[1], omega[2], T::zero()]);
    out.iter_mut().zip(rate).for_each(|(out, rate)| *out = T::of(0.5) * rate);
}

/// The canonical momentum of an angular momentum in link axes, `2 q m / |q|^2`
pub(in crate::reduced) fn canonical_momentum<T: Real>(q: &[T], m: &[T], out: &mut [T]) {
    let q = four(q);
    let factor = T::of(2.0) / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    out.iter_mut().zip(product(&q, &pure(m))).for_each(|(out, found)| *out = factor * found);
}

/// The angular momentum in link axes of a canonical momentum, `1/2 vec(q^* p)`.
pub(in crate::reduced) fn body_momentum<T: Real>(q: &[T], p: &[T], m: &mut [T]) {
    let turned = product(&[-q[0], -q[1], -q[2], q[3]], &four(p));
    m.iter_mut().zip(turned).for_each(|(m, turned)| *m = T::of(0.5) * turned);
}

fn four<T: Real>(q: &[T]) -> [T; 4] {
    [q[0], q[1], q[2], q[3]]
}

fn pure<T: Real>(v: &[T]) -> [T; 4] {
    [v[0], v[1], v[2], T::zero()]
}

/// `pdot = 1/2 p u + 2 q tau / |q|^2` with the angular velocity `u` and the torque `tau` in link axes.
#[inline(always)]
pub(in crate::reduced) fn momentum_rate<T: Real>(q: &[T], p: &[T], u: &[T], tau: &[T], rate: &mut [T]) {
    canonical_momentum(q, tau, rate);
    let turned = product(&four(p), &pure(u));
    rate.iter_mut().zip(turned).for_each(|(rate, turned)| *rate += T::of(0.5) * turned);
}

/// Turns at a constant angular velocity in link axes for a time `h`.
pub(in crate::reduced) fn turn(q: &mut [f64], omega: &[f64], h: f64) {
    let by = UnitQuaternion::from_scaled_axis(nalgebra::Vector3::new(omega[0], omega[1], omega[2]) * h);
    q.copy_from_slice((rotation(q) * by).coords.as_slice());
}

/// Gives back the unit length.
pub(in crate::reduced) fn normalise(q: &mut [f64]) {
    let unit = rotation(q);
    q.copy_from_slice(unit.coords.as_slice());
}
