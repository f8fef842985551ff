//! Twists, wrenches and articulated inertias about joint points, in world axes.

use std::ops::{Add, AddAssign};

use nalgebra::{Cholesky, Const, Matrix3, Matrix6, Vector3, Vector6};

use crate::mechanics::JointKind;

/// A twist or acceleration (of a point, angular), or a wrench or momentum (force, torque about a point).
#[derive(Clone, Copy, Debug)]
pub(super) struct Spatial {
    pub lin: Vector3<f64>,
    pub ang: Vector3<f64>,
}

impl Spatial {
    pub(super) const ZERO: Spatial = Spatial { lin: Vector3::new(0.0, 0.0, 0.0), ang: Vector3::new(0.0, 0.0, 0.0) };

    #[inline(always)]
    pub(super) fn new(lin: Vector3<f64>, ang: Vector3<f64>) -> Spatial {
        Spatial { lin, ang }
    }

    #[inline(always)]
    pub(super) fn dot(&self, other: &Spatial) -> f64 {
        self.lin.dot(&other.lin) + self.ang.dot(&other.ang)
    }

    #[inline(always)]
    pub(super) fn scaled(&self, factor: f64) -> Spatial {
        Spatial::new(self.lin * factor, self.ang * factor)
    }

    /// A twist of the parent's joint point, seen at the joint point that is `d` away.
    #[inline(always)]
    pub(super) fn twist_at(&self, d: &Vector3<f64>) -> Spatial {
        Spatial::new(self.lin + self.ang.cross(d), self.ang)
    }

    /// A wrench about a joint point that is `d` away from the parent's, about the parent's.
    #[inline(always)]
    pub(super) fn wrench_from(&self, d: &Vector3<f64>) -> Spatial {
        Spatial::new(self.lin, self.ang + d.cross(&self.lin))
    }

    fn vector(&self) -> Vector6<f64> {
        Vector6::new(self.lin.x, self.lin.y, self.lin.z, self.ang.x, self.ang.y, self.ang.z)
    }
}

impl Add for Spatial {
    type Output = Spatial;
    #[inline(always)]
    fn add(self, other: Spatial) -> Spatial {
        Spatial::new(self.lin + other.lin, self.ang + other.ang)
    }
}

impl AddAssign for Spatial {
    #[inline(always)]
    fn add_assign(&mut self, other: Spatial) {
        self.lin += other.lin;
        self.ang += other.ang;
    }
}

/// A symmetric 3 x 3 matrix.
#[derive(Clone, Copy, Debug)]
pub(super) struct Symmetric {
    xx: f64,
    xy: f64,
    xz: f64,
    yy: f64,
    yz: f64,
    zz: f64,
}

impl Symmetric {
    #[inline(always)]
    fn times(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.xx * v.x + self.xy * v.y + self.xz * v.z,
            self.xy * v.x + self.yy * v.y + self.yz * v.z,
            self.xz * v.x + self.yz * v.y + self.zz * v.z,
        )
    }

    /// Takes away `a a^T / d`.
    #[inline(always)]
    fn subtract(&mut self, a: &Vector3<f64>, over_d: &Vector3<f64>) {
        self.xx -= a.x * over_d.x;
        self.xy -= a.x * over_d.y;
        self.xz -= a.x * over_d.z;
        self.yy -= a.y * over_d.y;
        self.yz -= a.y * over_d.z;
        self.zz -= a.z * over_d.z;
    }

    fn matrix(&self) -> Matrix3<f64> {
        Matrix3::new(self.xx, self.xy, self.xz, self.xy, self.yy, self.yz, self.xz, self.yz, self.zz)
    }

    /// `R J R^T`.
    #[inline(always)]
    fn turned(j: &Matrix3<f64>, r: &Matrix3<f64>) -> Symmetric {
        let rj = r * j;
        let entry = |a: usize, b: usize| rj[(a, 0)] * r[(b, 0)] + rj[(a, 1)] * r[(b, 1)] + rj[(a, 2)] * r[(b, 2)];
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
pub(super) struct Inertia {
    m: Symmetric,
    h: Matrix3<f64>,
    j: Symmetric,
}

impl Inertia {
    pub(super) const ZERO: Inertia = {
        let zero = Symmetric { xx: 0.0, xy: 0.0, xz: 0.0, yy: 0.0, yz: 0.0, zz: 0.0 };
        Inertia { m: zero, h: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), j: zero }
    };

    /// A rigid body: `M = m 1`, `H alpha = alpha x mc`.
    #[inline(always)]
    pub(super) fn of_body(mass: f64, first_moment: &Vector3<f64>, inertia: &Matrix3<f64>, r: &Matrix3<f64>) -> Inertia {
        let mc = first_moment;
        let m = Symmetric { xx: mass, xy: 0.0, xz: 0.0, yy: mass, yz: 0.0, zz: mass };
        let h = Matrix3::new(0.0, mc.z, -mc.y, -mc.z, 0.0, mc.x, mc.y, -mc.x, 0.0);
        Inertia { m, h, j: Symmetric::turned(inertia, r) }
    }

    #[inline(always)]
    pub(super) fn times(&self, a: &Spatial) -> Spatial {
        Spatial::new(self.m.times(&a.lin) + self.h * a.ang, self.h.tr_mul(&a.lin) + self.j.times(&a.ang))
    }

    #[inline(always)]
    pub(super) fn add(&mut self, other: &Inertia) {
        let sum = |a: &mut Symmetric, b: &Symmetric| {
            a.xx += b.xx;
            a.xy += b.xy;
            a.xz += b.xz;
            a.yy += b.yy;
            a.yz += b.yz;
            a.zz += b.zz;
        };
        sum(&mut self.m, &other.m);
        self.h += other.h;
        sum(&mut self.j, &other.j);
    }

    /// Adds an inertia known about a point that is `d` away: `H' = H - M [d]`, `J' = J - H^T [d] + [d] H'`.
    #[inline(always)]
    pub(super) fn add_shifted(&mut self, other: &Inertia, d: &Vector3<f64>) {
        let m = &other.m;
        let rows = [
            Vector3::new(m.xx, m.xy, m.xz).cross(d),
            Vector3::new(m.xy, m.yy, m.yz).cross(d),
            Vector3::new(m.xz, m.yz, m.zz).cross(d),
        ];
        let h = other.h
            - Matrix3::new(
                rows[0].x, rows[0].y, rows[0].z, rows[1].x, rows[1].y, rows[1].z, rows[2].x, rows[2].y, rows[2].z,
            );
        let (old, new) = (&other.h, &h);
        // (H^T [d])_rk = (h_r x d)_k with the columns h_r of H; ([d] H')_rk = (d x h'_k)_r
        let back = |r: usize| old.column(r).cross(d);
        let forth = |k: usize| d.cross(&new.column(k));
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
    fn subtract(&mut self, u: &Spatial, over_d: &Spatial) {
        self.m.subtract(&u.lin, &over_d.lin);
        self.h -= u.lin * over_d.ang.transpose();
        self.j.subtract(&u.ang, &over_d.ang);
    }

    fn matrix(&self) -> Matrix6<f64> {
        let mut all = Matrix6::zeros();
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.m.matrix());
        all.fixed_view_mut::<3, 3>(0, 3).copy_from(&self.h);
        all.fixed_view_mut::<3, 3>(3, 0).copy_from(&self.h.transpose());
        all.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.j.matrix());
        all
    }
}

/// The free directions of a joint, eliminated: `U = I S`, `D = S^T U`.
#[derive(Clone, Debug)]
pub(super) enum Elimination {
    Turn {
        n: Vector3<f64>,
        u: Spatial,
        over_d: f64,
    },
    Slide {
        n: Vector3<f64>,
        u: Spatial,
        over_d: f64,
    },
    Three(Box<Three>),
    /// All six directions: no inertia passes to the parent. `r` turns link axes to world axes.
    Free {
        r: Matrix3<f64>,
        factor: Box<Cholesky<f64, Const<6>>>,
    },
}

/// Three directions `s` with their `U` and `D^-1`.
#[derive(Clone, Debug)]
pub(super) struct Three {
    s: [Spatial; 3],
    u: [Spatial; 3],
    over_d: Matrix3<f64>,
}

impl Elimination {
    pub(super) fn new(kind: JointKind) -> Elimination {
        let (n, u) = (Vector3::zeros(), Spatial::ZERO);
        match kind {
            JointKind::Revolute => Elimination::Turn { n, u, over_d: 0.0 },
            JointKind::Prismatic => Elimination::Slide { n, u, over_d: 0.0 },
            JointKind::Planar | JointKind::Spherical => Elimination::Three(Box::new(Three {
                s: [Spatial::ZERO; 3],
                u: [Spatial::ZERO; 3],
                over_d: Matrix3::zeros(),
            })),
            JointKind::Floating => {
                let factor = Cholesky::new_unchecked(Matrix6::identity());
                Elimination::Free { r: Matrix3::identity(), factor: Box::new(factor) }
            }
        }
    }

    /// Eliminates the directions of a joint with link axes `r`, and leaves in `inertia` what the parent feels. `None` where
    /// the joint can move without moving any mass.
    #[inline(always)]
    pub(super) fn eliminate(&mut self, kind: JointKind, r: &Matrix3<f64>, inertia: &mut Inertia) -> Option<()> {
        match self {
            Elimination::Turn { n, u, over_d } => {
                *n = r.column(2).into_owned();
                *u = Spatial::new(inertia.h * *n, inertia.j.times(n));
                *over_d = reciprocal(n.dot(&u.ang))?;
                inertia.subtract(u, &u.scaled(*over_d));
            }
            Elimination::Slide { n, u, over_d } => {
                *n = r.column(2).into_owned();
                *u = Spatial::new(inertia.m.times(n), inertia.h.tr_mul(n));
                *over_d = reciprocal(n.dot(&u.lin))?;
                inertia.subtract(u, &u.scaled(*over_d));
            }
            Elimination::Three(three) => {
                let Three { s, u, over_d } = three.as_mut();
                *s = directions(kind, r);
                *u = s.map(|s| inertia.times(&s));
                let d = Matrix3::from_fn(|i, k| s[i].dot(&u[k]));
                *over_d = Cholesky::new(d)?.inverse();
                for k in 0..3 {
                    let scaled = combine(u, &over_d.column(k).into_owned());
                    inertia.subtract(&scaled, &u[k]);
                }
            }
            Elimination::Free { r: axes, factor } => {
                *axes = *r;
                **factor = Cholesky::new(inertia.matrix())?;
                *inertia = Inertia::ZERO;
            }
        }
        Some(())
    }

    /// On the way to the root: takes the joint's equation `S . (I a + z) = rhs`, leaves `rhs - S . z` in its place, and
    /// gives the wrench that is passed on for a body that needs `z`.
    #[inline(always)]
    pub(super) fn inward(&self, rhs: &mut [f64], z: &Spatial) -> Spatial {
        match self {
            Elimination::Turn { n, u, over_d } => {
                rhs[0] -= n.dot(&z.ang);
                *z + u.scaled(over_d * rhs[0])
            }
            Elimination::Slide { n, u, over_d } => {
                rhs[0] -= n.dot(&z.lin);
                *z + u.scaled(over_d * rhs[0])
            }
            Elimination::Three(three) => {
                let Three { s, u, over_d } = three.as_ref();
                for k in 0..3 {
                    rhs[k] -= s[k].dot(z);
                }
                *z + combine(u, &(over_d * Vector3::new(rhs[0], rhs[1], rhs[2])))
            }
            Elimination::Free { r, .. } => {
                let whole =
                    Spatial::new(r * Vector3::new(rhs[0], rhs[1], rhs[2]), r * Vector3::new(rhs[3], rhs[4], rhs[5]));
                let (lin, ang) = (r.tr_mul(&z.lin), r.tr_mul(&z.ang));
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
    pub(super) fn outward(&self, rhs: &mut [f64], carried: &Spatial) -> Spatial {
        match self {
            Elimination::Turn { n, u, over_d } => {
                rhs[0] = over_d * (rhs[0] - u.dot(carried));
                Spatial::new(carried.lin, carried.ang + n * rhs[0])
            }
            Elimination::Slide { n, u, over_d } => {
                rhs[0] = over_d * (rhs[0] - u.dot(carried));
                Spatial::new(carried.lin + n * rhs[0], carried.ang)
            }
            Elimination::Three(three) => {
                let Three { s, u, over_d } = three.as_ref();
                let along = Vector3::from_fn(|k, _| rhs[k] - u[k].dot(carried));
                let found = over_d * along;
                rhs[..3].copy_from_slice(found.as_slice());
                *carried + combine(s, &found)
            }
            Elimination::Free { r, factor } => {
                let (lin, ang) = (r * Vector3::new(rhs[0], rhs[1], rhs[2]), r * Vector3::new(rhs[3], rhs[4], rhs[5]));
                let total = factor.solve(&Spatial::new(lin, ang).vector());
                let total = Spatial::new(total.fixed_rows::<3>(0).into_owned(), total.fixed_rows::<3>(3).into_owned());
                rhs[..3].copy_from_slice(r.tr_mul(&(total.lin - carried.lin)).as_slice());
                rhs[3..6].copy_from_slice(r.tr_mul(&(total.ang - carried.ang)).as_slice());
                total
            }
        }
    }
}

/// `1 / d` for a positive number.
#[inline(always)]
fn reciprocal(d: f64) -> Option<f64> {
    (d > 0.0 && d.is_finite()).then(|| 1.0 / d)
}

/// The free directions of a joint with three of them, in the order of its velocities.
fn directions(kind: JointKind, r: &Matrix3<f64>) -> [Spatial; 3] {
    let axis = |k: usize| r.column(k).into_owned();
    let slide = |k| Spatial::new(axis(k), Vector3::zeros());
    let turn = |k| Spatial::new(Vector3::zeros(), axis(k));
    match kind {
        JointKind::Planar => [slide(0), slide(1), turn(2)],
        _ => [turn(0), turn(1), turn(2)],
    }
}

#[inline(always)]
fn combine(of: &[Spatial; 3], factors: &Vector3<f64>) -> Spatial {
    of[0].scaled(factors.x) + of[1].scaled(factors.y) + of[2].scaled(factors.z)
}
