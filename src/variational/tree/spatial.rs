//! Twists, wrenches and articulated inertias in world axes.

use std::ops::{Add, AddAssign, Neg, Sub, SubAssign};

use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

/// A twist (velocity of a point, angular velocity) or a wrench (force, torque about a point), in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::variational) struct Spatial {
    pub linear: Vector3<f64>,
    pub angular: Vector3<f64>,
}

/// Velocity of a point of a body, m/s, and the body's angular velocity, rad/s.
pub(in crate::variational) type Twist = Spatial;
/// Impulse, N s, and its moment about a point, N m s.
pub(in crate::variational) type Wrench = Spatial;

impl Spatial {
    pub(in crate::variational) const ZERO: Spatial =
        Spatial { linear: Vector3::new(0.0, 0.0, 0.0), angular: Vector3::new(0.0, 0.0, 0.0) };

    pub(in crate::variational) fn new(linear: Vector3<f64>, angular: Vector3<f64>) -> Spatial {
        Spatial { linear, angular }
    }

    /// A twist, seen at a point that is `r` away: `v + omega x r`.
    #[inline(always)]
    pub(in crate::variational) fn twist_at(&self, r: &Vector3<f64>) -> Twist {
        Spatial::new(self.linear + self.angular.cross(r), self.angular)
    }

    /// A wrench about a point `P`, taken about the point `P - r`: `tau + r x f`.
    #[inline(always)]
    pub(in crate::variational) fn wrench_from(&self, r: &Vector3<f64>) -> Wrench {
        Spatial::new(self.linear, self.angular + r.cross(&self.linear))
    }

    /// Power of a wrench along a twist.
    #[inline(always)]
    pub(in crate::variational) fn dot(&self, other: &Spatial) -> f64 {
        self.linear.dot(&other.linear) + self.angular.dot(&other.angular)
    }

    #[inline(always)]
    pub(in crate::variational) fn scaled(&self, factor: f64) -> Spatial {
        Spatial::new(self.linear * factor, self.angular * factor)
    }

    pub(in crate::variational) fn to_vector(self) -> Vector6<f64> {
        let (l, a) = (self.linear, self.angular);
        Vector6::new(l.x, l.y, l.z, a.x, a.y, a.z)
    }

    pub(in crate::variational) fn from_vector(v: &Vector6<f64>) -> Spatial {
        Spatial::new(Vector3::new(v[0], v[1], v[2]), Vector3::new(v[3], v[4], v[5]))
    }
}

impl Add for Spatial {
    type Output = Spatial;
    #[inline(always)]
    fn add(self, other: Spatial) -> Spatial {
        Spatial::new(self.linear + other.linear, self.angular + other.angular)
    }
}

impl Sub for Spatial {
    type Output = Spatial;
    #[inline(always)]
    fn sub(self, other: Spatial) -> Spatial {
        Spatial::new(self.linear - other.linear, self.angular - other.angular)
    }
}

impl Neg for Spatial {
    type Output = Spatial;
    #[inline(always)]
    fn neg(self) -> Spatial {
        Spatial::new(-self.linear, -self.angular)
    }
}

impl AddAssign for Spatial {
    #[inline(always)]
    fn add_assign(&mut self, other: Spatial) {
        self.linear += other.linear;
        self.angular += other.angular;
    }
}

impl SubAssign for Spatial {
    #[inline(always)]
    fn sub_assign(&mut self, other: Spatial) {
        self.linear -= other.linear;
        self.angular -= other.angular;
    }
}

/// A symmetric 6 x 6 inertia about a point: `f = M v + H omega`, `tau = H^T v + J omega`. Six numbers for each of
/// `M` and `J` are 3 % faster at 10 000 links, but round otherwise: two shipped scenes break bounds
/// (`docs/notes/roundoff.md`).
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct Inertia {
    pub m: Matrix3<f64>,
    pub h: Matrix3<f64>,
    pub j: Matrix3<f64>,
}

impl Inertia {
    /// A rigid body of the given mass and inertia about its centre of mass (world axes), seen at the point `r` away
    /// from the centre of mass: `M = m 1`, `H = m [r]`, `J + m (|r|^2 1 - r r^T)`.
    #[inline(always)]
    pub(in crate::variational) fn of_body(mass: f64, inertia: &Matrix3<f64>, r: &Vector3<f64>) -> Inertia {
        let mr = mass * r;
        let mut j = inertia - mr * r.transpose();
        let parallel = mr.dot(r);
        j[(0, 0)] += parallel;
        j[(1, 1)] += parallel;
        j[(2, 2)] += parallel;
        Inertia { m: Matrix3::from_diagonal_element(mass), h: mr.cross_matrix(), j }
    }

    /// The wrench that a twist of the same point needs.
    #[inline(always)]
    pub(in crate::variational) fn times(&self, v: &Twist) -> Wrench {
        Spatial::new(self.m * v.linear + self.h * v.angular, self.h.tr_mul(&v.linear) + self.j * v.angular)
    }

    /// Adds an inertia known about a point that is `r` away from the point of `self`:
    /// `M`, `H - M [r]`, `J - H^T [r] + [r] (H - M [r])`.
    #[inline(always)]
    pub(in crate::variational) fn add_shifted(&mut self, other: &Inertia, r: &Vector3<f64>) {
        let h = other.h - times_cross(&other.m, r);
        self.m += other.m;
        self.j += other.j - times_cross(&other.h.transpose(), r) + cross_times(r, &h);
        self.h += h;
    }

    /// Takes away `a b^T`.
    #[inline(always)]
    pub(in crate::variational) fn subtract_product(&mut self, a: &Wrench, b: &Wrench) {
        self.m -= a.linear * b.linear.transpose();
        self.h -= a.linear * b.angular.transpose();
        self.j -= a.angular * b.angular.transpose();
    }

    pub(in crate::variational) fn to_matrix(self) -> Matrix6<f64> {
        let mut all = Matrix6::zeros();
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.m);
        all.fixed_view_mut::<3, 3>(0, 3).copy_from(&self.h);
        all.fixed_view_mut::<3, 3>(3, 0).copy_from(&self.h.transpose());
        all.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.j);
        all
    }
}

/// `A [r]`: each row of A crossed with r.
#[inline(always)]
pub(super) fn times_cross(a: &Matrix3<f64>, r: &Vector3<f64>) -> Matrix3<f64> {
    let (c0, c1, c2) = (a.column(0), a.column(1), a.column(2));
    Matrix3::from_columns(&[c1 * r.z - c2 * r.y, c2 * r.x - c0 * r.z, c0 * r.y - c1 * r.x])
}

/// `[r] A`: r crossed with each column of A.
#[inline(always)]
pub(super) fn cross_times(r: &Vector3<f64>, a: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::from_columns(&[r.cross(&a.column(0)), r.cross(&a.column(1)), r.cross(&a.column(2))])
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_shifted_inertia_gives_the_shifted_wrench_of_the_shifted_twist() {
        let inertia = Matrix3::new(2.0, 0.1, 0.2, 0.1, 3.0, -0.3, 0.2, -0.3, 4.0);
        let (r, far) = (Vector3::new(0.3, -0.2, 0.7), Vector3::new(-1.1, 0.4, 0.5));
        let here = Inertia::of_body(1.7, &inertia, &r);
        let mut there = Inertia { m: Matrix3::zeros(), h: Matrix3::zeros(), j: Matrix3::zeros() };
        there.add_shifted(&here, &far);
        // `far` leads from the new point to the old one.
        let twist = Spatial::new(Vector3::new(0.2, 0.9, -0.4), Vector3::new(1.3, -0.8, 0.6));
        let expected = here.times(&twist.twist_at(&far)).wrench_from(&far);
        let got = there.times(&twist);
        assert_relative_eq!(got.to_vector(), expected.to_vector(), epsilon = 1e-14);
        assert_relative_eq!(there.to_matrix() * twist.to_vector(), expected.to_vector(), epsilon = 1e-14);
    }

    #[test]
    fn a_body_seen_off_its_centre_has_the_momentum_of_its_centre() {
        let inertia = Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 2.5));
        let r = Vector3::new(0.3, -0.2, 0.7);
        let twist = Spatial::new(Vector3::new(0.2, 0.9, -0.4), Vector3::new(1.3, -0.8, 0.6));
        let at_centre = twist.twist_at(&-r);
        let momentum = Spatial::new(1.7 * at_centre.linear, inertia * at_centre.angular).wrench_from(&-r);
        let got = Inertia::of_body(1.7, &inertia, &r).times(&twist);
        assert_relative_eq!(got.to_vector(), momentum.to_vector(), epsilon = 1e-14);
    }
}
