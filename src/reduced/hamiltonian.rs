//! Hamilton's equations in joint coordinates, O(n), in world axes.
//!
//! Canonical coordinates of the joints are their positions: an angle or length, x, y and angle of a planar joint in the axes
//! of the joint frame in the parent, and a quaternion `q` in R^4 for a ball joint, after the position for a free one. The
//! momentum `p` of a quaternion enters by the angular momentum in link axes `m = 1/2 vec(q^* p)` alone, and the attitude by
//! `q / |q|` alone, so the Hamiltonian on R^4 x R^4 leaves `|q|^2` and `q . p` invariant. Both are quadratic: a Gauss method
//! keeps them exactly, and what it does on `|q| = 1`, `q . p = 0` is a symplectic method on the cotangent bundle of the
//! rotations (Betsch and Siebert 2009 for the equations; Hairer, Lubich and Wanner 2006, theorem IV.2.1 for the invariants).
//!
//! With the velocities `u` in link axes, the momentum `P`, `L` of the links beyond a joint about its joint point, moving with
//! `v` and turning with `omega`, the moment `N` and force `F` of gravity and of springs between points on them, and the effort
//! `f(t)` of drives, the equations are
//!
//! ```text
//! m = S^T (P, L) = H(q) u
//! pdot = n . (L x omega_parent + P x v + N) - k (q - rest) + f(t) - c u   angle about n
//! pdot = n . (P x omega_parent + F) - k (q - rest) + f(t) - c u           length along n
//! qdot = 1/2 q u ,   pdot = 1/2 p u + 2 q tau / |q|^2 ,    quaternion,
//! tau  = L x omega_parent + P x v + N - c u   in link axes .
//! ```

use nalgebra::{Matrix3, Quaternion, Vector3};

use super::Model;
use super::place::{Place, relative_twist};
use super::spatial::{Elimination, Inertia, Spatial};
use super::springs::Seen;
use crate::mechanics::JointKind;

/// The equations at one point of the phase space.
#[derive(Clone, Debug)]
pub(super) struct Point {
    places: Vec<Place>,
    twists: Vec<Spatial>,
    /// Momentum of the links beyond each joint about its joint point.
    momenta: Vec<Spatial>,
    /// First moment of these links about it.
    moments: Vec<Vector3<f64>>,
    /// Joint points, m, world, and what springs between points exert on the links beyond about them; empty without any.
    origins: Vec<Vector3<f64>>,
    loads: Vec<Spatial>,
    /// The mass matrix, factorised where `factorise` was called last.
    inertias: Vec<Inertia>,
    eliminations: Vec<Elimination>,
    offsets: Vec<Vector3<f64>>,
    sums: Vec<Spatial>,
}

impl Point {
    pub(super) fn new(model: &Model) -> Point {
        let n = model.links.len();
        let sprung = if model.springs.is_empty() { 0 } else { n };
        Point {
            places: vec![Place::GROUND; n],
            twists: vec![Spatial::ZERO; n],
            momenta: vec![Spatial::ZERO; n],
            moments: vec![Vector3::zeros(); n],
            origins: vec![Vector3::zeros(); sprung],
            loads: vec![Spatial::ZERO; sprung],
            inertias: vec![Inertia::ZERO; n],
            eliminations: model.links.iter().map(|link| Elimination::new(link.kind)).collect(),
            offsets: vec![Vector3::zeros(); n],
            sums: vec![Spatial::ZERO; n],
        }
    }

    /// Momentum `m = H(q) u` and force of every joint at a time in s, both along its velocities: what `pdot` has beside the turning of a
    /// quaternion. Lengths of planar and free joints have their force in the axes of the joint frame in the parent.
    pub(super) fn evaluate(
        &mut self,
        model: &Model,
        time: f64,
        q: &[f64],
        u: &[f64],
        m: &mut [f64],
        force: &mut [f64],
    ) {
        for (i, link) in model.links.iter().enumerate() {
            let (r, above) = match link.parent {
                Some(p) => (self.places[p].r, self.twists[p]),
                None => (Matrix3::identity(), Spatial::ZERO),
            };
            let place = Place::new(link, &r, &q[link.position..]);
            let twist = above.twist_at(&place.offset) + relative_twist(link.kind, &place.r, &u[link.velocity..]);
            let moment = place.r * link.first_moment;
            let turning = place.r * (link.inertia * place.r.tr_mul(&twist.ang));
            self.momenta[i] =
                Spatial::new(twist.lin * link.mass + twist.ang.cross(&moment), turning + moment.cross(&twist.lin));
            (self.places[i], self.twists[i], self.moments[i]) = (place, twist, moment);
        }
        if !model.springs.is_empty() {
            self.pull(model);
        }
        for (i, link) in model.links.iter().enumerate().rev() {
            let d = &self.places[i].offset;
            let Spatial { lin: p, ang: l } = self.momenta[i];
            let (r, twist, moment) = (&self.places[i].r, &self.twists[i], self.moments[i]);
            let above = link.parent.map_or(Vector3::zeros(), |p| self.twists[p].ang);
            let load = self.loads.get(i).copied().unwrap_or(Spatial::ZERO);
            let pulled = || p.cross(&above) + model.gravity * link.mass_beyond + load.lin;
            let swung =
                |omega: &Vector3<f64>| l.cross(omega) + p.cross(&twist.lin) + moment.cross(&model.gravity) + load.ang;
            let held = |u: f64| link.held(time, q[link.position]) - link.damping * u;
            let u = &u[link.velocity..];
            let (m, force) = (&mut m[link.velocity..], &mut force[link.velocity..]);
            match link.kind {
                JointKind::Revolute => {
                    m[0] = r.column(2).dot(&l);
                    force[0] = r.column(2).dot(&swung(&above)) + held(u[0]);
                }
                JointKind::Prismatic => {
                    m[0] = r.column(2).dot(&p);
                    force[0] = r.column(2).dot(&pulled()) + held(u[0]);
                }
                JointKind::Planar => {
                    let (along, pull) = (r.tr_mul(&p), r.tr_mul(&pulled()));
                    (m[0], m[1], m[2]) = (along.x, along.y, r.column(2).dot(&l));
                    let (s, c) = q[link.position + 2].sin_cos();
                    let (x, y) = (pull.x - link.damping * u[0], pull.y - link.damping * u[1]);
                    (force[0], force[1]) = (c * x - s * y, s * x + c * y);
                    force[2] = r.column(2).dot(&swung(&above)) - link.damping * u[2];
                }
                JointKind::Spherical => {
                    m[..3].copy_from_slice(r.tr_mul(&l).as_slice());
                    let tau = r.tr_mul(&swung(&above));
                    (0..3).for_each(|k| force[k] = tau[k] - link.damping * u[k]);
                }
                JointKind::Floating => {
                    m[..3].copy_from_slice(r.tr_mul(&p).as_slice());
                    m[3..6].copy_from_slice(r.tr_mul(&l).as_slice());
                    let axes = link.parent.map_or(link.parent_axes, |p| self.places[p].r * link.parent_axes);
                    force[..3].copy_from_slice(axes.tr_mul(&pulled()).as_slice());
                    force[3..6].copy_from_slice(r.tr_mul(&swung(&above)).as_slice());
                }
            }
            if let Some(parent) = link.parent {
                let carried = self.momenta[i].wrench_from(d);
                self.momenta[parent] += carried;
                let carried = moment + d * link.mass_beyond;
                self.moments[parent] += carried;
                if let Some(above) = self.loads.get_mut(parent) {
                    *above += load.wrench_from(d);
                }
            }
        }
    }

    /// Leaves what springs between points exert on each link in `loads`.
    fn pull(&mut self, model: &Model) {
        for (i, link) in model.links.iter().enumerate() {
            let above = link.parent.map_or(Vector3::zeros(), |p| self.origins[p]);
            self.origins[i] = above + self.places[i].offset;
        }
        self.loads.fill(Spatial::ZERO);
        for spring in &model.springs {
            let seen = |i: usize| Seen { r: self.places[i].r, origin: self.origins[i], twist: self.twists[i] };
            for (link, wrench) in spring.wrenches(seen) {
                if let Some(i) = link {
                    self.loads[i] += wrench;
                }
            }
        }
    }

    /// Factorises the mass matrix at the positions that were evaluated last. `None` where a joint can move without moving
    /// any mass.
    pub(super) fn factorise(&mut self, model: &Model) -> Option<()> {
        for (i, link) in model.links.iter().enumerate() {
            let r = &self.places[i].r;
            self.inertias[i] = Inertia::of_body(link.mass, &(r * link.first_moment), &link.inertia, r);
            self.offsets[i] = self.places[i].offset;
        }
        for (i, link) in model.links.iter().enumerate().rev() {
            let mut passed = self.inertias[i];
            self.eliminations[i].eliminate(link.kind, &self.places[i].r, &mut passed)?;
            if let Some(parent) = link.parent {
                self.inertias[parent].add_shifted(&passed, &self.offsets[i]);
            }
        }
        Some(())
    }

    /// Solves `H u = m` in place, with `H` as factorised last.
    pub(super) fn solve(&mut self, model: &Model, u: &mut [f64]) {
        self.sums.fill(Spatial::ZERO);
        for (i, link) in model.links.iter().enumerate().rev() {
            let passed = self.eliminations[i].inward(&mut u[link.velocity..], &self.sums[i]);
            if let Some(parent) = link.parent {
                self.sums[parent] += passed.wrench_from(&self.offsets[i]);
            }
        }
        for (i, link) in model.links.iter().enumerate() {
            let above = link.parent.map_or(Spatial::ZERO, |p| self.sums[p]);
            self.sums[i] = self.eliminations[i].outward(&mut u[link.velocity..], &above.twist_at(&self.offsets[i]));
        }
    }
}

/// Momenta along the velocities from the canonical ones.
pub(super) fn along_velocities(model: &Model, q: &[f64], p: &[f64], m: &mut [f64]) {
    for link in &model.links {
        let (q, p, m) = (&q[link.position..], &p[link.position..], &mut m[link.velocity..]);
        match link.kind {
            JointKind::Revolute | JointKind::Prismatic => m[0] = p[0],
            JointKind::Planar => {
                let (s, c) = q[2].sin_cos();
                (m[0], m[1], m[2]) = (c * p[0] + s * p[1], c * p[1] - s * p[0], p[2]);
            }
            JointKind::Spherical => half_turn(&q[..4], &p[..4], &mut m[..3]),
            JointKind::Floating => {
                let attitude = quaternion(&q[3..7]);
                let moved = attitude.conjugate() * pure(&p[..3]) * attitude / attitude.norm_squared();
                m[..3].copy_from_slice(&[moved.i, moved.j, moved.k]);
                half_turn(&q[3..7], &p[3..7], &mut m[3..6]);
            }
        }
    }
}

/// Canonical momenta that give the momenta `m` along the velocities, with `q . p = 0`: `p = 2 q m / |q|^2`.
pub(super) fn canonical(model: &Model, q: &[f64], m: &[f64], p: &mut [f64]) {
    let lift = |q: &[f64], m: &[f64], p: &mut [f64]| {
        let q = quaternion(q);
        p.copy_from_slice((q * pure(m) * (2.0 / q.norm_squared())).coords.as_slice());
    };
    for link in &model.links {
        let (q, m, p) = (&q[link.position..], &m[link.velocity..], &mut p[link.position..]);
        match link.kind {
            JointKind::Revolute | JointKind::Prismatic => p[0] = m[0],
            JointKind::Planar => {
                let (s, c) = q[2].sin_cos();
                (p[0], p[1], p[2]) = (c * m[0] - s * m[1], s * m[0] + c * m[1], m[2]);
            }
            JointKind::Spherical => lift(&q[..4], &m[..3], &mut p[..4]),
            JointKind::Floating => {
                let attitude = quaternion(&q[3..7]);
                let moved = attitude * pure(&m[..3]) * attitude.conjugate() / attitude.norm_squared();
                p[..3].copy_from_slice(&[moved.i, moved.j, moved.k]);
                lift(&q[3..7], &m[3..6], &mut p[3..7]);
            }
        }
    }
}

/// `pdot` from the forces of [`Point::evaluate`].
pub(super) fn momentum_rates(model: &Model, q: &[f64], p: &[f64], u: &[f64], force: &[f64], rate: &mut [f64]) {
    let turn = |q: &[f64], p: &[f64], u: &[f64], tau: &[f64], rate: &mut [f64]| {
        let q = quaternion(q);
        let found = quaternion(p) * pure(u) * 0.5 + q * pure(tau) * (2.0 / q.norm_squared());
        rate.copy_from_slice(found.coords.as_slice());
    };
    for link in &model.links {
        let (q, p, rate) = (&q[link.position..], &p[link.position..], &mut rate[link.position..]);
        let (u, force) = (&u[link.velocity..], &force[link.velocity..]);
        match link.kind {
            JointKind::Revolute | JointKind::Prismatic => rate[0] = force[0],
            JointKind::Planar => rate[..3].copy_from_slice(&force[..3]),
            JointKind::Spherical => turn(&q[..4], &p[..4], &u[..3], &force[..3], &mut rate[..4]),
            JointKind::Floating => {
                rate[..3].copy_from_slice(&force[..3]);
                turn(&q[3..7], &p[3..7], &u[3..6], &force[3..6], &mut rate[3..7]);
            }
        }
    }
}

/// `1/2 vec(q^* p)`.
fn half_turn(q: &[f64], p: &[f64], m: &mut [f64]) {
    let turned = quaternion(q).conjugate() * quaternion(p) * 0.5;
    m.copy_from_slice(&[turned.i, turned.j, turned.k]);
}

fn quaternion(q: &[f64]) -> Quaternion<f64> {
    Quaternion::new(q[3], q[0], q[1], q[2])
}

fn pure(v: &[f64]) -> Quaternion<f64> {
    Quaternion::new(0.0, v[0], v[1], v[2])
}
