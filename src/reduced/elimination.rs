//! Joints eliminated from the equations of the tree.

use super::inertia::Inertia;
use super::number::factor::Factor;
use super::number::linear::{Matrix3, Vector3};
use super::number::real::{Real, reciprocal};
use super::spatial::Spatial;

/// A free motion along or about an axis of the link frame.
#[derive(Clone, Copy, Debug)]
pub(super) enum Direction {
    Along(usize),
    About(usize),
}

impl Direction {
    /// As a twist in world axes, with link axes `r`.
    fn in_world<T: Real>(self, r: &Matrix3<T>) -> Spatial<T> {
        match self {
            Direction::Along(axis) => Spatial::new(*r.column(axis), Vector3::zeros()),
            Direction::About(axis) => Spatial::new(Vector3::zeros(), *r.column(axis)),
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
    free: [Direction; 3],
    s: [Spatial<T>; 3],
    u: [Spatial<T>; 3],
    over_d: Matrix3<T>,
}

impl<T: Real> Elimination<T> {
    /// About z.
    pub(super) fn turn() -> Elimination<T> {
        Elimination::Turn { n: Vector3::zeros(), u: Spatial::zero(), over_d: T::zero() }
    }

    /// Along z.
    pub(super) fn slide() -> Elimination<T> {
        Elimination::Slide { n: Vector3::zeros(), u: Spatial::zero(), over_d: T::zero() }
    }

    pub(super) fn three(free: [Direction; 3]) -> Elimination<T> {
        let zero = [Spatial::zero(); 3];
        Elimination::Three(Box::new(Three { free, s: zero, u: zero, over_d: Matrix3::zeros() }))
    }

    /// All six.
    pub(super) fn free() -> Elimination<T> {
        Elimination::Free { r: Matrix3::identity(), factor: Box::new(Factor::identity()) }
    }

    /// Eliminates the directions of a joint with link axes `r`, and leaves in `inertia` what the parent feels. `None`
    /// where the joint can move without moving any mass.
    #[inline(always)]
    pub(super) fn eliminate(&mut self, r: &Matrix3<T>, inertia: &mut Inertia<T>) -> Option<()> {
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
                let Three { free, s, u, over_d } = three.as_mut();
                *s = free.map(|direction| direction.in_world(r));
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
                let Three { s, u, over_d, .. } = three.as_ref();
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
                let Three { s, u, over_d, .. } = three.as_ref();
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

#[inline(always)]
fn combine<T: Real>(of: &[Spatial<T>; 3], factors: &Vector3<T>) -> Spatial<T> {
    of[0].scaled(factors.x) + of[1].scaled(factors.y) + of[2].scaled(factors.z)
}
