//! Articulated inertias about joint points, in world axes.

use super::number::linear::{Matrix3, Vector3};
use super::number::real::Real;
use super::spatial::Spatial;

/// A symmetric 3 x 3 matrix.
#[derive(Clone, Copy, Debug)]
pub(super) struct Symmetric<T: Real> {
    xx: T,
    xy: T,
    xz: T,
    yy: T,
    yz: T,
    zz: T,
}

impl<T: Real> Symmetric<T> {
    #[inline(always)]
    pub(super) fn times(&self, v: &Vector3<T>) -> Vector3<T> {
        Vector3::new(
            self.xx * v.x + self.xy * v.y + self.xz * v.z,
            self.xy * v.x + self.yy * v.y + self.yz * v.z,
            self.xz * v.x + self.yz * v.y + self.zz * v.z,
        )
    }

    /// Takes away `a a^T / d`.
    #[inline(always)]
    fn subtract(&mut self, a: &Vector3<T>, over_d: &Vector3<T>) {
        self.xx -= a.x * over_d.x;
        self.xy -= a.x * over_d.y;
        self.xz -= a.x * over_d.z;
        self.yy -= a.y * over_d.y;
        self.yz -= a.y * over_d.z;
        self.zz -= a.z * over_d.z;
    }

    fn entry(&self, i: usize, k: usize) -> T {
        [[self.xx, self.xy, self.xz], [self.xy, self.yy, self.yz], [self.xz, self.yz, self.zz]][i][k]
    }

    /// `R J R^T`.
    #[inline(always)]
    fn turned(j: &Matrix3<T>, r: &Matrix3<T>) -> Symmetric<T> {
        let (rj, [x, y, z]) = (r.product(j), &r.columns);
        let entry = |a: usize, b: usize| rj.columns[0][a] * x[b] + rj.columns[1][a] * y[b] + rj.columns[2][a] * z[b];
        Symmetric {
            xx: entry(0, 0),
            xy: entry(0, 1),
            xz: entry(0, 2),
            yy: entry(1, 1),
            yz: entry(1, 2),
            zz: entry(2, 2),
        }
    }
}

/// An articulated inertia about a joint point: `f = M a + H alpha`, `n = H^T a + J alpha`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inertia<T: Real> {
    pub(super) m: Symmetric<T>,
    pub(super) h: Matrix3<T>,
    pub(super) j: Symmetric<T>,
}

impl<T: Real> Inertia<T> {
    pub(super) fn zero() -> Inertia<T> {
        let o = T::zero();
        let zero = Symmetric { xx: o, xy: o, xz: o, yy: o, yz: o, zz: o };
        Inertia { m: zero, h: Matrix3::zeros(), j: zero }
    }

    /// A rigid body: `M = m 1`, `H alpha = alpha x mc`.
    #[inline(always)]
    pub(super) fn of_body(mass: f64, first_moment: &Vector3<T>, inertia: &Matrix3<T>, r: &Matrix3<T>) -> Inertia<T> {
        let mc = first_moment;
        let (o, mass) = (T::zero(), T::of(mass));
        let m = Symmetric { xx: mass, xy: o, xz: o, yy: mass, yz: o, zz: mass };
        let h = Matrix3::from_columns([
            Vector3::new(o, -mc.z, mc.y),
            Vector3::new(mc.z, o, -mc.x),
            Vector3::new(-mc.y, mc.x, o),
        ]);
        Inertia { m, h, j: Symmetric::turned(inertia, r) }
    }

    #[inline(always)]
    pub(super) fn times(&self, a: &Spatial<T>) -> Spatial<T> {
        Spatial::new(self.m.times(&a.lin) + self.h.times(&a.ang), self.h.transpose_times(&a.lin) + self.j.times(&a.ang))
    }

    #[inline(always)]
    pub(super) fn add(&mut self, other: &Inertia<T>) {
        let sum = |a: &mut Symmetric<T>, b: &Symmetric<T>| {
            a.xx += b.xx;
            a.xy += b.xy;
            a.xz += b.xz;
            a.yy += b.yy;
            a.yz += b.yz;
            a.zz += b.zz;
        };
        sum(&mut self.m, &other.m);
        for k in 0..3 {
            self.h.columns[k] += other.h.columns[k];
        }
        sum(&mut self.j, &other.j);
    }

    /// Adds an inertia known about a point that is `d` away: `H' = H - M [d]`, `J' = J - H^T [d] + [d] H'`.
    #[inline(always)]
    pub(super) fn add_shifted(&mut self, other: &Inertia<T>, d: &Vector3<T>) {
        let m = &other.m;
        let rows = [
            Vector3::new(m.xx, m.xy, m.xz).cross(d),
            Vector3::new(m.xy, m.yy, m.yz).cross(d),
            Vector3::new(m.xz, m.yz, m.zz).cross(d),
        ];
        let column = |k: usize| *other.h.column(k) - Vector3::new(rows[0][k], rows[1][k], rows[2][k]);
        let h = Matrix3::from_columns([column(0), column(1), column(2)]);
        let (old, new) = (&other.h, &h);
        // (H^T [d])_rk = (h_r x d)_k with the columns h_r of H; ([d] H')_rk = (d x h'_k)_r
        let back = |r: usize| old.column(r).cross(d);
        let forth = |k: usize| d.cross(new.column(k));
        let (b0, b1, b2) = (back(0), back(1), back(2));
        let (f0, f1, f2) = (forth(0), forth(1), forth(2));
        let j = Symmetric {
            xx: other.j.xx - b0.x + f0.x,
            xy: other.j.xy - b0.y + f1.x,
            xz: other.j.xz - b0.z + f2.x,
            yy: other.j.yy - b1.y + f1.y,
            yz: other.j.yz - b1.z + f2.y,
            zz: other.j.zz - b2.z + f2.z,
        };
        self.add(&Inertia { m: other.m, h, j });
    }

    #[inline(always)]
    pub(super) fn subtract(&mut self, u: &Spatial<T>, over_d: &Spatial<T>) {
        self.m.subtract(&u.lin, &over_d.lin);
        for k in 0..3 {
            self.h.columns[k] -= u.lin * over_d.ang[k];
        }
        self.j.subtract(&u.ang, &over_d.ang);
    }

    /// The entry in row `i` and column `k` of the 6 x 6 matrix.
    pub(super) fn entry(&self, i: usize, k: usize) -> T {
        match (i / 3, k / 3) {
            (0, 0) => self.m.entry(i, k),
            (0, _) => self.h.columns[k - 3][i],
            (_, 0) => self.h.columns[i - 3][k],
            _ => self.j.entry(i - 3, k - 3),
        }
    }
}
