//! The inertia of the exact linearisation, which is not symmetric.

use nalgebra::{Matrix3, Matrix6, Vector3};

use super::spatial::{Spatial, Twist, Wrench, cross_times, times_cross};

/// A linear map from twists to wrenches, not symmetric: `f = M v + H omega`, `tau = K v + J omega`.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct Response {
    m: Matrix3<f64>,
    h: Matrix3<f64>,
    k: Matrix3<f64>,
    j: Matrix3<f64>,
}

impl Response {
    pub(in crate::variational) const ZERO: Response = {
        let zero = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        Response { m: zero, h: zero, k: zero, j: zero }
    };

    /// A rigid body of the given mass and inertia about its centre of mass, which answers a twist of the point `r1`
    /// away with a wrench about the point `r0` away, both ways from the centre of mass: `M = m 1`, `H = m [r1]`, `K =
    /// -m [r0]`, `J + m (r0 . r1 1 - r1 r0^T)`.
    #[inline(always)]
    pub(in crate::variational) fn of_body(
        mass: f64,
        inertia: &Matrix3<f64>,
        r0: &Vector3<f64>,
        r1: &Vector3<f64>,
    ) -> Response {
        let mr = mass * r1;
        let mut j = inertia - mr * r0.transpose();
        let parallel = mr.dot(r0);
        j[(0, 0)] += parallel;
        j[(1, 1)] += parallel;
        j[(2, 2)] += parallel;
        let (h, k) = (mr.cross_matrix(), (-mass * r0).cross_matrix());
        Response { m: Matrix3::from_diagonal_element(mass), h, k, j }
    }

    #[inline(always)]
    pub(in crate::variational) fn times(&self, v: &Twist) -> Wrench {
        Spatial::new(self.m * v.linear + self.h * v.angular, self.k * v.linear + self.j * v.angular)
    }

    /// The transpose times a twist.
    #[inline(always)]
    pub(in crate::variational) fn tr_times(&self, v: &Twist) -> Wrench {
        let (l, a) = (&v.linear, &v.angular);
        Spatial::new(self.m.tr_mul(l) + self.k.tr_mul(a), self.h.tr_mul(l) + self.j.tr_mul(a))
    }

    /// [`Response::times`] a twist without a velocity.
    #[inline(always)]
    pub(in crate::variational) fn times_turn(&self, w: &Vector3<f64>) -> Wrench {
        Spatial::new(self.h * w, self.j * w)
    }

    /// [`Response::tr_times`] a twist without a velocity.
    #[inline(always)]
    pub(in crate::variational) fn tr_times_turn(&self, w: &Vector3<f64>) -> Wrench {
        Spatial::new(self.k.tr_mul(w), self.j.tr_mul(w))
    }

    /// Adds a map known for points that are `r0` and `r1` away from those of `self`:
    /// `M`, `H - M [r1]`, `K + [r0] M`, `J - K [r1] + [r0] (H - M [r1])`.
    #[inline(always)]
    pub(in crate::variational) fn add_shifted(&mut self, other: &Response, r0: &Vector3<f64>, r1: &Vector3<f64>) {
        let h = other.h - times_cross(&other.m, r1);
        self.m += other.m;
        self.k += other.k + cross_times(r0, &other.m);
        self.j += other.j - times_cross(&other.k, r1) + cross_times(r0, &h);
        self.h += h;
    }

    /// Takes away `a b^T`.
    #[inline(always)]
    pub(in crate::variational) fn subtract_product(&mut self, a: &Wrench, b: &Spatial) {
        self.m -= a.linear * b.linear.transpose();
        self.h -= a.linear * b.angular.transpose();
        self.k -= a.angular * b.linear.transpose();
        self.j -= a.angular * b.angular.transpose();
    }

    pub(in crate::variational) fn to_matrix(self) -> Matrix6<f64> {
        let mut all = Matrix6::zeros();
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.m);
        all.fixed_view_mut::<3, 3>(0, 3).copy_from(&self.h);
        all.fixed_view_mut::<3, 3>(3, 0).copy_from(&self.k);
        all.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.j);
        all
    }
}
