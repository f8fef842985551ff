//! Solves with a factorised tree: a sweep towards the root, and one away from it.

use std::ops::Range;

use nalgebra::{Cholesky, Vector3};

use super::elimination::{Elimination, Three};
use super::factor::Tree;
use super::spatial::{Spatial, Twist, Wrench};
use crate::variational::chain::{JointFrame, Node};

impl Tree {
    /// Solves `M v = b + G^T lambda`, `G v = 0`. `b(i)` is a wrench about the centre of mass; `solution(i, v, f)` gets the
    /// twist of each node at its joint point and the wrench on it about that point.
    pub(in crate::variational) fn project(
        &mut self,
        nodes: &[Node],
        frames: &[JointFrame],
        b: impl Fn(usize) -> Wrench,
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        for i in 1..nodes.len() {
            self.rhs[i] = b(i).wrench_from(&-frames[i].arm);
        }
        self.sweep(nodes, frames, |_| None, |_| Vector3::zeros(), &mut solution);
    }

    /// Solves `M v = G^T lambda`, `G v = c`, `S . f = -along` (plus the implicit part of the joint's own force): a
    /// correction of the wrenches by the joints' mismatch.
    pub(in crate::variational) fn correct(
        &mut self,
        nodes: &[Node],
        frames: &[JointFrame],
        bias: impl Fn(usize) -> Twist,
        along: impl Fn(usize) -> Vector3<f64>,
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        self.rhs[1..].fill(Spatial::ZERO);
        self.sweep(nodes, frames, |i| Some(bias(i)), along, &mut solution);
    }

    /// [`Tree::correct`] of the nodes before `tail` alone, as if the mismatch of all others were zero. The nodes from `tail` on hang
    /// on that one; of them only the wrench in the joint of `tail` is found. Returns the twist of its parent, which carries them along.
    pub(in crate::variational) fn correct_head(
        &mut self,
        frames: &[JointFrame],
        tail: usize,
        bias: impl Fn(usize) -> Twist,
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) -> Twist {
        self.rhs[1..=tail].fill(Spatial::ZERO);
        self.along[tail] = Vector3::zeros();
        let bias = |i: usize| (i < tail).then(|| bias(i));
        self.eliminate(frames, 1..tail, &bias, |_| Vector3::zeros());
        self.substitute(frames, 1..tail + 1, &bias, &mut solution);
        self.twist[self.parent[tail]]
    }

    /// [`Tree::correct`] of all nodes, in which those from `tail` on are carried by `missed` as well: what [`Tree::correct_head`] has
    /// returned since they were last corrected. The equations are linear, so that this makes up for it.
    pub(in crate::variational) fn correct_all(
        &mut self,
        frames: &[JointFrame],
        (tail, missed): (usize, &Twist),
        bias: impl Fn(usize) -> Twist,
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        self.rhs[1..].fill(Spatial::ZERO);
        let (bias, n) = (|i: usize| Some(bias(i)), self.parent.len());
        self.eliminate(frames, 1..n, &bias, |_| Vector3::zeros());
        self.substitute(frames, 1..tail, &bias, &mut solution);
        self.twist[self.parent[tail]] += *missed;
        self.substitute(frames, tail..n, &bias, &mut solution);
    }

    /// Sets the right-hand sides of a correction in which bodies have impulses `b(i)` about their centres of mass to answer.
    pub(in crate::variational) fn load(&mut self, nodes: &[Node], frames: &[JointFrame], b: impl Fn(usize) -> Wrench) {
        for i in 1..nodes.len() {
            self.rhs[i] = b(i).wrench_from(&-frames[i].arm);
        }
    }

    /// [`Tree::correct`] with the right-hand sides of [`Tree::load`].
    pub(in crate::variational) fn correct_loaded(
        &mut self,
        nodes: &[Node],
        frames: &[JointFrame],
        bias: impl Fn(usize) -> Twist,
        along: impl Fn(usize) -> Vector3<f64>,
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        self.sweep(nodes, frames, |i| Some(bias(i)), along, &mut solution);
    }

    /// Solves `M v = b + G^T lambda`, `G v = 0` for wrenches `b` about the joint points, which `load` writes.
    pub(in crate::variational) fn respond(
        &mut self,
        nodes: &[Node],
        frames: &[JointFrame],
        load: impl FnOnce(&mut [Wrench]),
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        self.rhs.fill(Spatial::ZERO);
        load(&mut self.rhs);
        self.sweep(nodes, frames, |_| None, |_| Vector3::zeros(), &mut solution);
    }

    /// `D^-1/2 S^T rhs` of every joint on the way of the given wrenches (about joint points) to the ground, so that the
    /// dot product of two loads' innovations is what one load sees of the response to the other.
    pub(in crate::variational) fn innovations(
        &self,
        nodes: &[Node],
        frames: &[JointFrame],
        load: &[(usize, Wrench)],
        out: &mut [f64],
    ) {
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
                front[slot] = (nodes[node].parent, rhs.wrench_from(&frames[node].offset));
            }
        }
    }

    /// `bias(i)` is `None` where all joints hold.
    #[inline(always)]
    fn sweep(
        &mut self,
        nodes: &[Node],
        frames: &[JointFrame],
        bias: impl Fn(usize) -> Option<Twist>,
        along: impl Fn(usize) -> Vector3<f64>,
        solution: &mut impl FnMut(usize, &Twist, Wrench),
    ) {
        self.eliminate(frames, 1..nodes.len(), &bias, along);
        self.substitute(frames, 1..nodes.len(), &bias, solution);
    }

    /// The sweep of some nodes towards the root, which eliminates the free directions of their joints.
    #[inline(always)]
    fn eliminate(
        &mut self,
        frames: &[JointFrame],
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
                self.rhs[parent] += rhs.wrench_from(&frames[i].offset);
            }
        }
    }

    /// The sweep of some nodes away from the root, which finds their twists and the wrenches in their joints.
    #[inline(always)]
    fn substitute(
        &mut self,
        frames: &[JointFrame],
        range: Range<usize>,
        bias: &impl Fn(usize) -> Option<Twist>,
        solution: &mut impl FnMut(usize, &Twist, Wrench),
    ) {
        for i in range {
            let carried = self.twist[self.parent[i]].twist_at(&frames[i].offset);
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
