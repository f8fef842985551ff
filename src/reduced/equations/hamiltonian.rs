//! Hamilton's equations in joint coordinates, O(n), in world axes.
//!
//! Canonical coordinates of the joints are their positions: an angle or length, x, y and angle of a planar joint in the
//! axes of the joint frame in the parent, and a quaternion `q` in R^4 for a ball joint, after the position for a free
//! one. The momentum `p` of a quaternion enters by the angular momentum in link axes `m = 1/2 vec(q^* p)` alone, and
//! the attitude by `q / |q|` alone, so the Hamiltonian on R^4 x R^4 leaves `|q|^2` and `q . p` invariant. Both are
//! quadratic: a Gauss method keeps them exactly, and what it does on `|q| = 1`, `q . p = 0` is a symplectic method on
//! the cotangent bundle of the rotations (Betsch and Siebert 2009 for the equations; Hairer, Lubich and Wanner 2006,
//! theorem IV.2.1 for the invariants). Collocation of the accelerations `a(q, v)` is not symplectic where the mass
//! matrix depends on `q`, nor is one in a chart of rotations that is laid anew at every step, which depends on the
//! state.
//!
//! With the velocities `u` in link axes, the momentum `P`, `L` of the links beyond a joint about its joint point,
//! moving with `v` and turning with `omega`, the moment `N` and force `F` of gravity and of springs between points on
//! them, and the effort `f(t)` of drives, the equations are
//!
//! ```text
//! m = S^T (P, L) = H(q) u
//! pdot = n . (L x omega_parent + P x v + N) - k (q - rest) + f(t) - c u   angle about n
//! pdot = n . (P x omega_parent + F) - k (q - rest) + f(t) - c u           length along n
//! qdot = 1/2 q u ,   pdot = 1/2 p u + 2 q tau / |q|^2 ,    quaternion,
//! tau  = L x omega_parent + P x v + N - c u   in link axes .
//! ```

use std::sync::Arc;

use crate::reduced::elimination::Elimination;
use crate::reduced::inertia::Inertia;
use crate::reduced::joint::{Subtree, for_kind};
use crate::reduced::joint_frame::JointFrame;
use crate::reduced::link::Link;
use crate::reduced::link_frame::LinkFrame;
use crate::reduced::model::Model;
use crate::reduced::number::linear::{Matrix3, Vector3};
use crate::reduced::number::real::{Lanes, Real};
use crate::reduced::number::sine::NearbySine;
use crate::reduced::spatial::Spatial;
use crate::reduced::spring::LinkMotion;

/// What a link keeps in all lanes: spread out once and not at every use.
#[derive(Clone, Debug)]
pub(in crate::reduced) struct LinkConstants {
    joint: JointFrame<Lanes>,
    mass: Lanes,
    mass_beyond: Lanes,
    first_moment: Vector3<Lanes>,
    inertia: Matrix3<Lanes>,
    damping: Lanes,
}

impl LinkConstants {
    /// For all links of a model.
    pub(in crate::reduced) fn all(model: &Model) -> Arc<[LinkConstants]> {
        let constants = |link: &Link| LinkConstants {
            joint: JointFrame::of(link),
            mass: Lanes::of(link.mass),
            mass_beyond: Lanes::of(link.mass_beyond),
            first_moment: Vector3::of(&link.first_moment),
            inertia: Matrix3::of(&link.inertia),
            damping: Lanes::of(link.damping),
        };
        model.links.iter().map(constants).collect()
    }
}

/// The equations at points of the phase space, as many as there are lanes.
#[derive(Clone, Debug)]
pub(in crate::reduced) struct Point {
    constants: Arc<[LinkConstants]>,
    /// Angles of turning joints with their sines.
    sines: Vec<NearbySine>,
    frames: Vec<LinkFrame<Lanes>>,
    twists: Vec<Spatial<Lanes>>,
    /// Momentum of the links beyond each joint about its joint point.
    momenta: Vec<Spatial<Lanes>>,
    /// First moment of these links about it.
    moments: Vec<Vector3<Lanes>>,
    /// Joint points, m, world, and what springs between points exert on the links beyond about them; empty without any.
    origins: Vec<Vector3<Lanes>>,
    loads: Vec<Spatial<Lanes>>,
    /// The mass matrix, factorised where `factorise` was called last.
    inertias: Vec<Inertia<Lanes>>,
    eliminations: Vec<Elimination<Lanes>>,
    offsets: Vec<Vector3<Lanes>>,
    sums: Vec<Spatial<Lanes>>,
}

impl Point {
    pub(in crate::reduced) fn new(model: &Model, constants: &Arc<[LinkConstants]>) -> Point {
        let n = model.links.len();
        let sprung = if model.springs.is_empty() { 0 } else { n };
        Point {
            constants: constants.clone(),
            sines: vec![NearbySine::zero(); n],
            frames: vec![LinkFrame::ground(); n],
            twists: vec![Spatial::zero(); n],
            momenta: vec![Spatial::zero(); n],
            moments: vec![Vector3::zeros(); n],
            origins: vec![Vector3::zeros(); sprung],
            loads: vec![Spatial::zero(); sprung],
            inertias: vec![Inertia::zero(); n],
            eliminations: model.links.iter().map(|link| for_kind!(link.kind, Joint => Joint::elimination())).collect(),
            offsets: vec![Vector3::zeros(); n],
            sums: vec![Spatial::zero(); n],
        }
    }

    /// Axes and offsets of the links.
    pub(in crate::reduced) fn place(&mut self, model: &Model, q: &[Lanes]) {
        for (i, link) in model.links.iter().enumerate() {
            let (above, rest) = self.frames.split_at_mut(i);
            let ground = Matrix3::identity();
            let sine = &mut self.sines[i];
            let parent = link.parent.map_or(&ground, |p| &above[p].axes);
            let joint = &self.constants[i].joint;
            rest[0] = joint.link_frame(link.kind, parent, &q[link.position..], |angle| sine.sin_cos(angle));
        }
    }

    /// Momentum `m = H(q) u` and force of every joint at times in s, both along its velocities: what `pdot` has beside
    /// the turning of a quaternion. Lengths of planar and free joints have their force in the axes of the joint frame
    /// in the parent. The links have been placed at `q`.
    pub(in crate::reduced) fn evaluate(
        &mut self,
        model: &Model,
        time: Lanes,
        q: &[Lanes],
        u: &[Lanes],
        m: &mut [Lanes],
        force: &mut [Lanes],
    ) {
        self.own_momenta(model, u);
        if !model.springs.is_empty() {
            self.pull(model);
        }
        self.sum_towards_root(model, time, q, u, m, force);
    }

    /// Twists, momenta and first moments of each link by itself.
    #[inline(always)]
    fn own_momenta(&mut self, model: &Model, u: &[Lanes]) {
        for (i, link) in model.links.iter().enumerate() {
            let above = link.parent.map_or(Spatial::zero(), |p| self.twists[p]);
            let LinkFrame { axes: r, offset } = &self.frames[i];
            let joint = for_kind!(link.kind, Joint => Joint::twist(r, &u[link.velocity..]));
            let twist = above.twist_at(offset) + joint;
            let constants = &self.constants[i];
            let moment = r.times(&constants.first_moment);
            let turning = r.times(&constants.inertia.times(&r.transpose_times(&twist.ang)));
            self.momenta[i] =
                Spatial::new(twist.lin * constants.mass + twist.ang.cross(&moment), turning + moment.cross(&twist.lin));
            (self.twists[i], self.moments[i]) = (twist, moment);
        }
    }

    /// Sums momenta, first moments and loads towards the root, and takes from the sums what a joint feels.
    #[inline(always)]
    fn sum_towards_root(
        &mut self,
        model: &Model,
        time: Lanes,
        q: &[Lanes],
        u: &[Lanes],
        m: &mut [Lanes],
        force: &mut [Lanes],
    ) {
        let gravity = Vector3::of(&model.gravity);
        for (i, link) in model.links.iter().enumerate().rev() {
            let LinkConstants { damping, mass_beyond, .. } = self.constants[i];
            let LinkFrame { axes, offset: d } = &self.frames[i];
            let (moment, load) = (self.moments[i], self.loads.get(i).copied().unwrap_or(Spatial::zero()));
            let subtree = Subtree {
                axes,
                parent: link.parent.map(|p| &self.frames[p].axes),
                in_parent: &link.parent_axes,
                momentum: self.momenta[i],
                mass: mass_beyond,
                first_moment: moment,
                velocity: self.twists[i].lin,
                parent_omega: link.parent.map_or(Vector3::zeros(), |p| self.twists[p].ang),
                gravity,
                load,
            };
            let (q, u) = (&q[link.position..], &u[link.velocity..]);
            let effort = |k: usize| match link.kind.degrees_of_freedom() {
                1 => joint_effort(link, time, q[0]) - damping * u[k],
                _ => -(damping * u[k]),
            };
            for_kind!(link.kind, Joint => {
                Joint::momentum(&subtree, &mut m[link.velocity..]);
                Joint::force(&subtree, q, effort, &mut force[link.velocity..]);
            });
            if let Some(parent) = link.parent {
                let carried = self.momenta[i].wrench_from(d);
                self.momenta[parent] += carried;
                let carried = moment + *d * mass_beyond;
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
            self.origins[i] = above + self.frames[i].offset;
        }
        self.loads.fill(Spatial::zero());
        for spring in &model.springs {
            let motion =
                |i: usize| LinkMotion { r: self.frames[i].axes, origin: self.origins[i], twist: self.twists[i] };
            for (link, wrench) in spring.wrenches(motion) {
                if let Some(i) = link {
                    self.loads[i] += wrench;
                }
            }
        }
    }

    /// Factorises the mass matrix at the positions that the links were placed at last. `None` where a joint can move
    /// without moving any mass.
    pub(in crate::reduced) fn factorise(&mut self, model: &Model) -> Option<()> {
        for (i, link) in model.links.iter().enumerate() {
            let r = &self.frames[i].axes;
            self.inertias[i] =
                Inertia::of_body(link.mass, &r.times(&self.constants[i].first_moment), &self.constants[i].inertia, r);
            self.offsets[i] = self.frames[i].offset;
        }
        for (i, link) in model.links.iter().enumerate().rev() {
            let mut passed = self.inertias[i];
            self.eliminations[i].eliminate(&self.frames[i].axes, &mut passed)?;
            if let Some(parent) = link.parent {
                self.inertias[parent].add_shifted(&passed, &self.offsets[i]);
            }
        }
        Some(())
    }

    /// Solves `H u = m` in place, with `H` as factorised last.
    pub(in crate::reduced) fn solve(&mut self, model: &Model, u: &mut [Lanes]) {
        self.begin();
        model.links.iter().enumerate().rev().for_each(|(i, link)| self.inward(i, link, u));
        model.links.iter().enumerate().for_each(|(i, link)| self.outward(i, link, u));
    }

    /// [`Self::solve`] link by link: what comes before its way to the root.
    pub(in crate::reduced) fn begin(&mut self) {
        self.sums.fill(Spatial::zero());
    }

    /// One link of the way to the root.
    #[inline(always)]
    pub(in crate::reduced) fn inward(&mut self, i: usize, link: &Link, u: &mut [Lanes]) {
        let passed = self.eliminations[i].inward(&mut u[link.velocity..], &self.sums[i]);
        if let Some(parent) = link.parent {
            self.sums[parent] += passed.wrench_from(&self.offsets[i]);
        }
    }

    /// One link of the way from the root.
    #[inline(always)]
    pub(in crate::reduced) fn outward(&mut self, i: usize, link: &Link, u: &mut [Lanes]) {
        let above = link.parent.map_or(Spatial::zero(), |p| self.sums[p]);
        self.sums[i] = self.eliminations[i].outward(&mut u[link.velocity..], &above.twist_at(&self.offsets[i]));
    }
}

/// What springs and drives exert in a joint of one coordinate.
#[inline(always)]
fn joint_effort(link: &Link, time: Lanes, q: Lanes) -> Lanes {
    let still = Lanes::of(link.spring_effort) - Lanes::of(link.stiffness) * q;
    if link.drives.is_empty() { still } else { still + time.map(|time| link.drive_effort(time)) }
}

/// Momenta along the velocities from the canonical ones.
pub(in crate::reduced) fn along_velocities<T: Real>(model: &Model, q: &[T], p: &[T], m: &mut [T]) {
    if model.plain {
        return m.copy_from_slice(p);
    }
    for link in &model.links {
        let (q, p, m) = (&q[link.position..], &p[link.position..], &mut m[link.velocity..]);
        for_kind!(link.kind, Joint => Joint::momentum_along_velocities(q, p, m));
    }
}

/// Canonical momenta that give the momenta `m` along the velocities, with `q . p = 0`: `p = 2 q m / |q|^2`.
pub(in crate::reduced) fn canonical<T: Real>(model: &Model, q: &[T], m: &[T], p: &mut [T]) {
    for link in &model.links {
        let (q, m, p) = (&q[link.position..], &m[link.velocity..], &mut p[link.position..]);
        for_kind!(link.kind, Joint => Joint::canonical_momentum(q, m, p));
    }
}

/// `pdot` from the forces of [`Point::evaluate`].
pub(in crate::reduced) fn momentum_rates<T: Real>(
    model: &Model,
    q: &[T],
    p: &[T],
    u: &[T],
    force: &[T],
    rate: &mut [T],
) {
    for link in &model.links {
        let (q, p, rate) = (&q[link.position..], &p[link.position..], &mut rate[link.position..]);
        let (u, force) = (&u[link.velocity..], &force[link.velocity..]);
        for_kind!(link.kind, Joint => Joint::momentum_rate(q, p, u, force, rate));
    }
}
