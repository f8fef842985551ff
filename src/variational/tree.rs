//! Linear solves on the tree of joints in O(n): the articulated-body recursion (Featherstone 1983), in world axes.
//!
//! All solves of a step have the form: find body twists `v` and joint wrenches (the multipliers) with
//!
//! ```text
//! M v = b + G^T lambda ,      G v = c .
//! ```
//!
//! Here a joint's wrench `f` acts on the child and `-f` on the parent at the joint point, `S . f = 0` for the joint's
//! motion subspace `S`, and the joint lets the child's twist differ from the parent's by `S sigma + gamma`, where `gamma`
//! is the joint's part of `c`. A sweep from the leaves to the root eliminates the free directions,
//!
//! ```text
//! U = A S ,   D = S^T U ,   A_parent += A - U D^-1 U^T ,
//! ```
//!
//! and one from the root to the leaves finds the twists. Only `D` is inverted: a number for a hinge.

use std::ops::Range;

use nalgebra::{Cholesky, Const, Matrix3, Matrix6, Vector3};

use super::joints::{Node, Place};
use super::spatial::{Inertia, Spatial, Twist, Wrench};
use crate::mechanics::JointKind;

/// The free directions of a joint, eliminated. Chains are mostly hinges, so what is large stands elsewhere.
#[derive(Clone, Debug)]
enum Elimination {
    /// One rotation about `n`.
    Hinge { n: Vector3<f64>, u: Wrench, d_inverse: f64 },
    /// One translation along `n`.
    Slider { n: Vector3<f64>, u: Wrench, d_inverse: f64 },
    /// Three directions.
    Three(Box<Three>),
    /// All six: nothing passes to the parent.
    Free(Box<Cholesky<f64, Const<6>>>),
}

/// Three free directions `s`, eliminated.
#[derive(Clone, Debug)]
struct Three {
    s: [Spatial; 3],
    u: [Wrench; 3],
    d_inverse: Matrix3<f64>,
}

impl Elimination {
    /// Room for that of a joint.
    fn of(kind: JointKind) -> Elimination {
        let (n, u, d_inverse) = (Vector3::zeros(), Spatial::ZERO, 0.0);
        match kind {
            JointKind::Revolute => Elimination::Hinge { n, u, d_inverse },
            JointKind::Prismatic => Elimination::Slider { n, u, d_inverse },
            JointKind::Planar | JointKind::Spherical => {
                Elimination::Three(Box::new(Three { s: [u; 3], u: [u; 3], d_inverse: Matrix3::zeros() }))
            }
            JointKind::Floating => Elimination::Free(Box::new(Cholesky::pack_dirty(Matrix6::identity()))),
        }
    }
}

/// The factorisation at one configuration, with room for the solves.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    /// The parents of the nodes, which the sweeps read without the rest of a node.
    parent: Vec<usize>,
    /// Articulated inertia of each node about its joint point, its own joint not yet eliminated.
    inertia: Vec<Inertia>,
    elimination: Vec<Elimination>,
    /// Right-hand sides about the joint points, summed towards the root.
    rhs: Vec<Wrench>,
    /// `S . rhs` of each joint after its bias.
    along: Vec<Vector3<f64>>,
    /// Twists of the solution at the joint points.
    twist: Vec<Twist>,
    /// Index of each node's first degree of freedom, and their number at the end.
    first: Vec<usize>,
}

/// The articulated inertia along a joint is not positive: the joint can move without moving any mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Singular {
    pub node: usize,
}

impl Tree {
    /// Of no nodes; it takes no memory.
    pub(super) const EMPTY: Tree = Tree {
        parent: Vec::new(),
        inertia: Vec::new(),
        elimination: Vec::new(),
        first: Vec::new(),
        rhs: Vec::new(),
        along: Vec::new(),
        twist: Vec::new(),
    };

    pub(super) fn new(nodes: &[Node]) -> Tree {
        let zero = Inertia { m: Matrix3::zeros(), h: Matrix3::zeros(), j: Matrix3::zeros() };
        Tree {
            parent: nodes.iter().map(|node| node.parent).collect(),
            inertia: vec![zero; nodes.len()],
            elimination: nodes.iter().map(|node| Elimination::of(node.kind)).collect(),
            rhs: vec![Spatial::ZERO; nodes.len()],
            along: vec![Vector3::zeros(); nodes.len()],
            twist: vec![Spatial::ZERO; nodes.len()],
            first: std::iter::once(0)
                .chain(nodes.iter().skip(1).scan(0, |sum, node| {
                    *sum += node.kind.degrees_of_freedom();
                    Some(*sum)
                }))
                .collect(),
        }
    }

    /// Number of degrees of freedom of the tree.
    pub(super) fn freedoms(&self) -> usize {
        self.first.last().copied().unwrap_or(0)
    }

    /// `D^-1/2 S^T rhs` of every joint on the way of the given wrenches (about joint points) to the ground, so that the
    /// dot product of two loads' innovations is what one load sees of the response to the other.
    pub(super) fn innovations(&self, nodes: &[Node], places: &[Place], load: &[(usize, Wrench)], out: &mut [f64]) {
        let mut front = [(0, Spatial::ZERO); 4];
        front[..load.len()].copy_from_slice(load);
        loop {
            let node = front.iter().map(|(node, _)| *node).max().unwrap_or(0);
            if node == 0 {
                return;
            }
            let mut rhs = Spatial::ZERO;
            let mut slot = None;
            for (k, entry) in front.iter_mut().enumerate().filter(|(_, entry)| entry.0 == node) {
                rhs += entry.1;
                *entry = (0, Spatial::ZERO);
                slot = Some(k);
            }
            let out = &mut out[self.first[node - 1]..self.first[node]];
            match &self.elimination[node] {
                Elimination::Hinge { n, u, d_inverse } => {
                    let s_rhs = n.dot(&rhs.angular);
                    out[0] = s_rhs * d_inverse.sqrt();
                    rhs -= u.scaled(d_inverse * s_rhs);
                }
                Elimination::Slider { n, u, d_inverse } => {
                    let s_rhs = n.dot(&rhs.linear);
                    out[0] = s_rhs * d_inverse.sqrt();
                    rhs -= u.scaled(d_inverse * s_rhs);
                }
                Elimination::Three(three) => {
                    let Three { s, u, d_inverse } = &**three;
                    let s_rhs = Vector3::from_fn(|k, _| s[k].dot(&rhs));
                    if let Some(root) = Cholesky::new(*d_inverse) {
                        out.copy_from_slice(root.l().tr_mul(&s_rhs).as_slice());
                    }
                    let sigma = d_inverse * s_rhs;
                    rhs -= u[0].scaled(sigma.x) + u[1].scaled(sigma.y) + u[2].scaled(sigma.z);
                }
                Elimination::Free(a) => {
                    let mut x = rhs.to_vector();
                    a.l_dirty().solve_lower_triangular_mut(&mut x);
                    out.copy_from_slice(x.as_slice());
                    continue;
                }
            }
            if let Some(slot) = slot {
                front[slot] = (nodes[node].parent, rhs.wrench_from(&places[node].offset));
            }
        }
    }

    /// Solves `M v = b + G^T lambda`, `G v = 0` for wrenches `b` about the joint points, which `load` writes.
    pub(super) fn respond(
        &mut self,
        nodes: &[Node],
        places: &[Place],
        load: impl FnOnce(&mut [Wrench]),
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        self.rhs.fill(Spatial::ZERO);
        load(&mut self.rhs);
        self.sweep(nodes, places, |_| None, |_| Vector3::zeros(), &mut solution);
    }

    /// Factorises. `inertia(i)` is the inertia of node `i` about its centre of mass in world axes, `implicit(i)` what the
    /// joint's own forces add to `D`.
    pub(super) fn factorise(
        &mut self,
        nodes: &[Node],
        places: &[Place],
        inertia: impl Fn(usize) -> Matrix3<f64>,
        implicit: impl Fn(usize) -> f64,
    ) -> Result<(), Singular> {
        (1..nodes.len()).for_each(|i| self.put_body(nodes, places, i, &inertia(i)));
        self.factorise_bodies(nodes, places, implicit)
    }

    /// Puts in the inertia of node `i` about its centre of mass in world axes, before [`Tree::factorise_bodies`].
    #[inline(always)]
    pub(super) fn put_body(&mut self, nodes: &[Node], places: &[Place], i: usize, inertia: &Matrix3<f64>) {
        self.inertia[i] = Inertia::of_body(nodes[i].mass, inertia, &places[i].arm);
    }

    /// [`Tree::factorise`] with the inertias of [`Tree::put_body`].
    pub(super) fn factorise_bodies(
        &mut self,
        nodes: &[Node],
        places: &[Place],
        implicit: impl Fn(usize) -> f64,
    ) -> Result<(), Singular> {
        for i in (1..nodes.len()).rev() {
            let mut passed = self.inertia[i];
            let (place, node) = (&places[i], &nodes[i]);
            match &mut self.elimination[i] {
                Elimination::Hinge { n, u, d_inverse } => {
                    *n = place.axes.column(2).into_owned();
                    *u = Spatial::new(passed.h * *n, passed.j * *n);
                    let d = n.dot(&u.angular) + implicit(i);
                    *d_inverse = reciprocal(d, node.least).ok_or(Singular { node: i })?;
                    passed.subtract_product(&u.scaled(*d_inverse), u);
                }
                Elimination::Slider { n, u, d_inverse } => {
                    *n = place.axes.column(2).into_owned();
                    *u = Spatial::new(passed.m * *n, passed.h.tr_mul(n));
                    let d = n.dot(&u.linear) + implicit(i);
                    *d_inverse = reciprocal(d, node.least).ok_or(Singular { node: i })?;
                    passed.subtract_product(&u.scaled(*d_inverse), u);
                }
                Elimination::Three(three) => {
                    let Three { s, u, d_inverse } = &mut **three;
                    *s = directions(node.kind, &place.axes);
                    *u = s.map(|s| passed.times(&s));
                    let mut d = Matrix3::from_fn(|r, c| s[r].dot(&u[c]));
                    for k in 0..3 {
                        d[(k, k)] += implicit(i);
                    }
                    *d_inverse = inverse_of_symmetric(&d).ok_or(Singular { node: i })?;
                    if node.light && !(d_inverse.amax() * node.least < 1.0) {
                        return Err(Singular { node: i });
                    }
                    for (k, scaled) in combine(u, d_inverse).iter().enumerate() {
                        passed.subtract_product(scaled, &u[k]);
                    }
                }
                Elimination::Free(a) => {
                    **a = Cholesky::new(passed.to_matrix()).ok_or(Singular { node: i })?;
                    continue;
                }
            }
            if node.parent > 0 {
                self.inertia[node.parent].add_shifted(&passed, &place.offset);
            }
        }
        Ok(())
    }

    /// Solves `M v = b + G^T lambda`, `G v = 0`. `b(i)` is a wrench about the centre of mass; `solution(i, v, f)` gets the
    /// twist of each node at its joint point and the wrench on it about that point.
    pub(super) fn project(
        &mut self,
        nodes: &[Node],
        places: &[Place],
        b: impl Fn(usize) -> Wrench,
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        for i in 1..nodes.len() {
            self.rhs[i] = b(i).wrench_from(&-places[i].arm);
        }
        self.sweep(nodes, places, |_| None, |_| Vector3::zeros(), &mut solution);
    }

    /// Solves `M v = G^T lambda`, `G v = c`, `S . f = -along` (plus the implicit part of the joint's own force): a
    /// correction of the wrenches by the joints' mismatch.
    pub(super) fn correct(
        &mut self,
        nodes: &[Node],
        places: &[Place],
        bias: impl Fn(usize) -> Twist,
        along: impl Fn(usize) -> Vector3<f64>,
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        self.rhs[1..].fill(Spatial::ZERO);
        self.sweep(nodes, places, |i| Some(bias(i)), along, &mut solution);
    }

    /// [`Tree::correct`] of the nodes before `tail` alone, as if the mismatch of all others were zero. The nodes from `tail` on hang
    /// on that one; of them only the wrench in the joint of `tail` is found. Returns the twist of its parent, which carries them along.
    pub(super) fn correct_head(
        &mut self,
        places: &[Place],
        tail: usize,
        bias: impl Fn(usize) -> Twist,
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) -> Twist {
        self.rhs[1..=tail].fill(Spatial::ZERO);
        self.along[tail] = Vector3::zeros();
        let bias = |i: usize| (i < tail).then(|| bias(i));
        self.eliminate(places, 1..tail, &bias, |_| Vector3::zeros());
        self.substitute(places, 1..tail + 1, &bias, &mut solution);
        self.twist[self.parent[tail]]
    }

    /// [`Tree::correct`] of all nodes, in which those from `tail` on are carried by `missed` as well: what [`Tree::correct_head`] has
    /// returned since they were last corrected. The equations are linear, so that this makes up for it.
    pub(super) fn correct_all(
        &mut self,
        places: &[Place],
        (tail, missed): (usize, &Twist),
        bias: impl Fn(usize) -> Twist,
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        self.rhs[1..].fill(Spatial::ZERO);
        let (bias, n) = (|i: usize| Some(bias(i)), self.parent.len());
        self.eliminate(places, 1..n, &bias, |_| Vector3::zeros());
        self.substitute(places, 1..tail, &bias, &mut solution);
        self.twist[self.parent[tail]] += *missed;
        self.substitute(places, tail..n, &bias, &mut solution);
    }

    /// Sets the right-hand sides of a correction in which bodies have impulses `b(i)` about their centres of mass to answer.
    pub(super) fn load(&mut self, nodes: &[Node], places: &[Place], b: impl Fn(usize) -> Wrench) {
        for i in 1..nodes.len() {
            self.rhs[i] = b(i).wrench_from(&-places[i].arm);
        }
    }

    /// [`Tree::correct`] with the right-hand sides of [`Tree::load`].
    pub(super) fn correct_loaded(
        &mut self,
        nodes: &[Node],
        places: &[Place],
        bias: impl Fn(usize) -> Twist,
        along: impl Fn(usize) -> Vector3<f64>,
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        self.sweep(nodes, places, |i| Some(bias(i)), along, &mut solution);
    }

    /// Twist of a node at its joint point in the last solution.
    pub(super) fn twist(&self, node: usize) -> &Twist {
        &self.twist[node]
    }

    /// Articulated mass and moment of a node about its joint point, the mean over all directions.
    pub(super) fn mean_inertia(&self, node: usize) -> (f64, f64) {
        (self.inertia[node].m.trace() / 3.0, self.inertia[node].j.trace() / 3.0)
    }

    /// The largest entry of `D^-1` of a joint.
    pub(super) fn compliance(&self, node: usize) -> f64 {
        match &self.elimination[node] {
            Elimination::Hinge { d_inverse, .. } | Elimination::Slider { d_inverse, .. } => *d_inverse,
            Elimination::Three(three) => three.d_inverse.amax(),
            Elimination::Free(_) => 0.0,
        }
    }

    /// `bias(i)` is `None` where all joints hold.
    #[inline(always)]
    fn sweep(
        &mut self,
        nodes: &[Node],
        places: &[Place],
        bias: impl Fn(usize) -> Option<Twist>,
        along: impl Fn(usize) -> Vector3<f64>,
        solution: &mut impl FnMut(usize, &Twist, Wrench),
    ) {
        self.eliminate(places, 1..nodes.len(), &bias, along);
        self.substitute(places, 1..nodes.len(), &bias, solution);
    }

    /// The sweep of some nodes towards the root, which eliminates the free directions of their joints.
    #[inline(always)]
    fn eliminate(
        &mut self,
        places: &[Place],
        range: Range<usize>,
        bias: &impl Fn(usize) -> Option<Twist>,
        along: impl Fn(usize) -> Vector3<f64>,
    ) {
        for i in range.rev() {
            let mut rhs = self.rhs[i];
            if let Some(bias) = bias(i) {
                rhs -= self.inertia[i].times(&bias);
            }
            match &self.elimination[i] {
                Elimination::Hinge { n, u, d_inverse } => {
                    let s_rhs = n.dot(&rhs.angular) - along(i).x;
                    self.along[i].x = s_rhs;
                    rhs -= u.scaled(d_inverse * s_rhs);
                }
                Elimination::Slider { n, u, d_inverse } => {
                    let s_rhs = n.dot(&rhs.linear) - along(i).x;
                    self.along[i].x = s_rhs;
                    rhs -= u.scaled(d_inverse * s_rhs);
                }
                Elimination::Three(three) => {
                    let Three { s, u, d_inverse } = &**three;
                    let s_rhs = Vector3::from_fn(|k, _| s[k].dot(&rhs)) - along(i);
                    self.along[i] = s_rhs;
                    let sigma = d_inverse * s_rhs;
                    rhs -= u[0].scaled(sigma.x) + u[1].scaled(sigma.y) + u[2].scaled(sigma.z);
                }
                Elimination::Free(_) => continue,
            }
            let parent = self.parent[i];
            if parent > 0 {
                self.rhs[parent] += rhs.wrench_from(&places[i].offset);
            }
        }
    }

    /// The sweep of some nodes away from the root, which finds their twists and the wrenches in their joints.
    #[inline(always)]
    fn substitute(
        &mut self,
        places: &[Place],
        range: Range<usize>,
        bias: &impl Fn(usize) -> Option<Twist>,
        solution: &mut impl FnMut(usize, &Twist, Wrench),
    ) {
        for i in range {
            let carried = self.twist[self.parent[i]].twist_at(&places[i].offset);
            let mut v = bias(i).map_or(carried, |bias| carried + bias);
            match &self.elimination[i] {
                Elimination::Hinge { n, u, d_inverse } => {
                    v.angular += n * (d_inverse * (self.along[i].x - u.dot(&carried)));
                }
                Elimination::Slider { n, u, d_inverse } => {
                    v.linear += n * (d_inverse * (self.along[i].x - u.dot(&carried)));
                }
                Elimination::Three(three) => {
                    let Three { s, u, d_inverse } = &**three;
                    let sigma = d_inverse * (self.along[i] - Vector3::from_fn(|k, _| u[k].dot(&carried)));
                    v += s[0].scaled(sigma.x) + s[1].scaled(sigma.y) + s[2].scaled(sigma.z);
                }
                Elimination::Free(a) => {
                    self.twist[i] = Spatial::from_vector(&a.solve(&self.rhs[i].to_vector()));
                    solution(i, &self.twist[i], Spatial::ZERO);
                    continue;
                }
            }
            let f = self.inertia[i].times(&v) - self.rhs[i];
            self.twist[i] = v;
            solution(i, &self.twist[i], f);
        }
    }
}

/// `1 / d` for a number above `least`.
fn reciprocal(d: f64, least: f64) -> Option<f64> {
    (d > least && d.is_finite()).then(|| 1.0 / d)
}

/// Inverse of a positive definite matrix.
fn inverse_of_symmetric(d: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    Cholesky::new(*d).map(|c| c.inverse())
}

/// The free directions of a joint with three of them, at its joint point.
pub(super) fn directions(kind: JointKind, axes: &Matrix3<f64>) -> [Spatial; 3] {
    let axis = |k: usize| axes.column(k).into_owned();
    let slide = |k| Spatial::new(axis(k), Vector3::zeros());
    let turn = |k| Spatial::new(Vector3::zeros(), axis(k));
    match kind {
        JointKind::Planar => [slide(0), slide(1), turn(2)],
        _ => [turn(0), turn(1), turn(2)],
    }
}

/// The columns of `[u0 u1 u2] D^-1`.
fn combine(u: &[Wrench; 3], d_inverse: &Matrix3<f64>) -> [Wrench; 3] {
    std::array::from_fn(|k| {
        u[0].scaled(d_inverse[(0, k)]) + u[1].scaled(d_inverse[(1, k)]) + u[2].scaled(d_inverse[(2, k)])
    })
}
