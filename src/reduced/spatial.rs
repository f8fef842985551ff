//! Twists, wrenches and articulated inertias about joint points, in world axes.

use std::ops::{Add, AddAssign};

use super::factor::Factor;
use super::linear::{Matrix3, Vector3};
use super::real::Real;
use crate::mechanics::JointKind;

/// A twist or acceleration (of a point, angular), or a wrench or momentum (force, torque about a point).
#[derive(Clone, Copy, Debug)]
pub(super) struct Spatial<T: Real> {
    pub lin: Vector3<T>,
    pub ang: Vector3<T>,
}

impl<T: Real> Spatial<T> {
    #[inline(always)]
    pub(super) fn zero() -> Spatial<T> {
        Spatial::new(Vector3::zeros(), Vector3::zeros())
    }

    #[inline(always)]
    pub(super) fn new(lin: Vector3<T>, ang: Vector3<T>) -> Spatial<T> {
        Spatial { lin, ang }
    }

    #[inline(always)]
    pub(super) fn dot(&self, other: &Spatial<T>) -> T {
        self.lin.dot(&other.lin) + self.ang.dot(&other.ang)
    }

    #[inline(always)]
    pub(super) fn scaled(&self, factor: T) -> Spatial<T> {
        Spatial::new(self.lin * factor, self.ang * factor)
    }

    /// A twist of the parent's joint point, seen at the joint point that is `d` away.
    #[inline(always)]
    pub(super) fn twist_at(&self, d: &Vector3<T>) -> Spatial<T> {
        Spatial::new(self.lin + self.ang.cross(d), self.ang)
    }

    /// A wrench about a joint point that is `d` away from the parent's, about the parent's.
    #[inline(always)]
    pub(super) fn wrench_from(&self, d: &Vector3<T>) -> Spatial<T> {
        Spatial::new(self.lin, self.ang + d.cross(&self.lin))
    }
}

impl<T: Real> Add for Spatial<T> {
    type Output = Spatial<T>;
    #[inline(always)]
    fn add(self, other: Spatial<T>) -> Spatial<T> {
        Spatial::new(self.lin + other.lin, self.ang + other.ang)
    }
}

impl<T: Real> AddAssign for Spatial<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Spatial<T>) {
        self.lin += other.lin;
        self.ang += other.ang;
    }
}

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
    fn times(&self, v: &Vector3<T>) -> Vector3<T> {
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
    m: Symmetric<T>,
    h: Matrix3<T>,
    j: Symmetric<T>,
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
    fn subtract(&mut self, u: &Spatial<T>, over_d: &Spatial<T>) {
        self.m.subtract(&u.lin, &over_d.lin);
        for k in 0..3 {
            self.h.columns[k] -= u.lin * over_d.ang[k];
        }
        self.j.subtract(&u.ang, &over_d.ang);
    }

    /// The entry in row `i` and column `k` of the 6 x 6 matrix.
    fn entry(&self, i: usize, k: usize) -> T {
        match (i / 3, k / 3) {
            (0, 0) => self.m.entry(i, k),
            (0, _) => self.h.columns[k - 3][i],
            (_, 0) => self.h.columns[i - 3][k],
            _ => self.j.entry(i - 3, k - 3),
        }
    }
}

/// The free directions of a joint, eliminated: `U = I S`, `D = S^T U`.
#[derive(Clone, Debug)]
pub(super) enum Elimination<T: Real> {
    Turn {
        n: Vector3<T>,
        u: Spatial<T>,
        over_d: T,
    },
    Slide {
        n: Vector3<T>,
        u: Spatial<T>,
        over_d: T,
    },
    Three(Box<Three<T>>),
    /// All six directions: no inertia passes to the parent. `r` turns link axes to world axes.
    Free {
        r: Matrix3<T>,
        factor: Box<Factor<T, 6>>,
    },
}

/// Three directions `s` with their `U` and `D^-1`.
#[derive(Clone, Debug)]
pub(super) struct Three<T: Real> {
    s: [Spatial<T>; 3],
    u: [Spatial<T>; 3],
    over_d: Matrix3<T>,
}

impl<T: Real> Elimination<T> {
    pub(super) fn new(kind: JointKind) -> Elimination<T> {
        let (n, u) = (Vector3::zeros(), Spatial::zero());
        match kind {
            JointKind::Revolute => Elimination::Turn { n, u, over_d: T::zero() },
            JointKind::Prismatic => Elimination::Slide { n, u, over_d: T::zero() },
            JointKind::Planar | JointKind::Spherical => Elimination::Three(Box::new(Three {
                s: [Spatial::zero(); 3],
                u: [Spatial::zero(); 3],
                over_d: Matrix3::zeros(),
            })),
            JointKind::Floating => Elimination::Free { r: Matrix3::identity(), factor: Box::new(Factor::identity()) },
        }
    }

    /// Eliminates the directions of a joint with link axes `r`, and leaves in `inertia` what the parent feels. `None` where
    /// the joint can move without moving any mass.
    #[inline(always)]
    pub(super) fn eliminate(&mut self, kind: JointKind, r: &Matrix3<T>, inertia: &mut Inertia<T>) -> Option<()> {
        match self {
            Elimination::Turn { n, u, over_d } => {
                *n = *r.column(2);
                *u = Spatial::new(inertia.h.times(n), inertia.j.times(n));
                *over_d = reciprocal(n.dot(&u.ang))?;
                inertia.subtract(u, &u.scaled(*over_d));
            }
            Elimination::Slide { n, u, over_d } => {
                *n = *r.column(2);
                *u = Spatial::new(inertia.m.times(n), inertia.h.transpose_times(n));
                *over_d = reciprocal(n.dot(&u.lin))?;
                inertia.subtract(u, &u.scaled(*over_d));
            }
            Elimination::Three(three) => {
                let Three { s, u, over_d } = three.as_mut();
                *s = directions(kind, r);
                *u = s.map(|s| inertia.times(&s));
                let factor = Factor::<T, 3>::new(|i, k| s[i].dot(&u[k]))?;
                *over_d = Matrix3::from_columns(Matrix3::identity().columns.map(|e: Vector3<T>| {
                    let [x, y, z] = factor.solve([e.x, e.y, e.z]);
                    Vector3::new(x, y, z)
                }));
                for k in 0..3 {
                    let scaled = combine(u, over_d.column(k));
                    inertia.subtract(&scaled, &u[k]);
                }
            }
            Elimination::Free { r: axes, factor } => {
                *axes = *r;
                **factor = Factor::new(|i, k| inertia.entry(i, k))?;
                *inertia = Inertia::zero();
            }
        }
        Some(())
    }

    /// On the way to the root: takes the joint's equation `S . (I a + z) = rhs`, leaves `rhs - S . z` in its place, and
    /// gives the wrench that is passed on for a body that needs `z`.
    #[inline(always)]
    pub(super) fn inward(&self, rhs: &mut [T], z: &Spatial<T>) -> Spatial<T> {
        match self {
            Elimination::Turn { n, u, over_d } => {
                rhs[0] -= n.dot(&z.ang);
                *z + u.scaled(*over_d * rhs[0])
            }
            Elimination::Slide { n, u, over_d } => {
                rhs[0] -= n.dot(&z.lin);
                *z + u.scaled(*over_d * rhs[0])
            }
            Elimination::Three(three) => {
                let Three { s, u, over_d } = three.as_ref();
                for k in 0..3 {
                    rhs[k] -= s[k].dot(z);
                }
                *z + combine(u, &over_d.times(&Vector3::new(rhs[0], rhs[1], rhs[2])))
            }
            Elimination::Free { r, .. } => {
                // It passes its own momentum on, although it passes no inertia.
                let whole = Spatial::new(
                    r.times(&Vector3::new(rhs[0], rhs[1], rhs[2])),
                    r.times(&Vector3::new(rhs[3], rhs[4], rhs[5])),
                );
                let (lin, ang) = (r.transpose_times(&z.lin), r.transpose_times(&z.ang));
                for k in 0..3 {
                    rhs[k] -= lin[k];
                    rhs[3 + k] -= ang[k];
                }
                whole
            }
        }
    }

    /// On the way from the root: turns the `rhs` that [`inward`](Self::inward) left into the joint's accelerations and
    /// gives the link's, from what the parent carries it along with.
    #[inline(always)]
    pub(super) fn outward(&self, rhs: &mut [T], carried: &Spatial<T>) -> Spatial<T> {
        match self {
            Elimination::Turn { n, u, over_d } => {
                rhs[0] = *over_d * (rhs[0] - u.dot(carried));
                Spatial::new(carried.lin, carried.ang + *n * rhs[0])
            }
            Elimination::Slide { n, u, over_d } => {
                rhs[0] = *over_d * (rhs[0] - u.dot(carried));
                Spatial::new(carried.lin + *n * rhs[0], carried.ang)
            }
            Elimination::Three(three) => {
                let Three { s, u, over_d } = three.as_ref();
                let part = |k: usize| rhs[k] - u[k].dot(carried);
                let along = Vector3::new(part(0), part(1), part(2));
                let found = over_d.times(&along);
                found.write(rhs);
                *carried + combine(s, &found)
            }
            Elimination::Free { r, factor } => {
                let (lin, ang) =
                    (r.times(&Vector3::new(rhs[0], rhs[1], rhs[2])), r.times(&Vector3::new(rhs[3], rhs[4], rhs[5])));
                let [a, b, c, d, e, f] = factor.solve([lin.x, lin.y, lin.z, ang.x, ang.y, ang.z]);
                let total = Spatial::new(Vector3::new(a, b, c), Vector3::new(d, e, f));
                r.transpose_times(&(total.lin - carried.lin)).write(rhs);
                r.transpose_times(&(total.ang - carried.ang)).write(&mut rhs[3..]);
                total
            }
        }
    }
}

/// `1 / d` for a positive number.
#[inline(always)]
pub(super) fn reciprocal<T: Real>(d: T) -> Option<T> {
    d.is_positive().then(|| T::one() / d)
}

/// The free directions of a joint with three of them, in the order of its velocities.
fn directions<T: Real>(kind: JointKind, r: &Matrix3<T>) -> [Spatial<T>; 3] {
    let slide = |k| Spatial::new(*r.column(k), Vector3::zeros());
    let spin = |k| Spatial::new(Vector3::zeros(), *r.column(k));
    match kind {
        JointKind::Planar => [slide(0), slide(1), spin(2)],
        _ => [spin(0), spin(1), spin(2)],
    }
}

#[inline(always)]
fn combine<T: Real>(of: &[Spatial<T>; 3], factors: &Vector3<T>) -> Spatial<T> {
    of[0].scaled(factors.x) + of[1].scaled(factors.y) + of[2].scaled(factors.z)
}
