//! Solves with a factorised tree: a sweep towards the root, and one away from it.

use nalgebra::{Cholesky, Vector3};

use super::elimination::{Elimination, Three};
use super::factor::Tree;
use super::spatial::{Spatial, Twist, Wrench};
use crate::variational::chain::{JointFrame, Node};

impl Tree {
    /// Solves `M v = b + G^T lambda`, `G v = 0`. `b(i)` is a wrench about the centre of mass; `solution(i, v, f)` gets
    /// the twist of each node at its joint point and the wrench on it about that point.
    pub(in crate::variational) fn project(
        &mut self,
        frames: &[JointFrame],
        b: impl Fn(usize) -> Wrench,
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        for i in 1..self.rhs.len() {
            self.rhs[i] = b(i).wrench_from(&-frames[i].arm);
        }
        self.sweep(frames, |_| None, |_| Vector3::zeros(), &mut solution);
    }

    /// Solves `M v = G^T lambda`, `G v = c`, `S . f = -along` (plus the implicit part of the joint's own force): a
    /// correction of the wrenches by the joints' mismatch.
    pub(in crate::variational) fn correct(
        &mut self,
        frames: &[JointFrame],
        bias: impl Fn(usize) -> Twist,
        along: impl Fn(usize) -> Vector3<f64>,
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        self.rhs[1..].fill(Spatial::ZERO);
        self.sweep(frames, |i| Some(bias(i)), along, &mut solution);
    }

    /// Sets the right-hand sides of a correction in which bodies have impulses `b(i)` about their centres of mass to
    /// answer.
    pub(in crate::variational) fn load(&mut self, frames: &[JointFrame], b: impl Fn(usize) -> Wrench) {
        for i in 1..self.rhs.len() {
            self.rhs[i] = b(i).wrench_from(&-frames[i].arm);
        }
    }

    /// [`Tree::correct`] with the right-hand sides of [`Tree::load`].
    pub(in crate::variational) fn correct_loaded(
        &mut self,
        frames: &[JointFrame],
        bias: impl Fn(usize) -> Twist,
        along: impl Fn(usize) -> Vector3<f64>,
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        self.sweep(frames, |i| Some(bias(i)), along, &mut solution);
    }

    /// Solves `M v = b + G^T lambda`, `G v = 0` for wrenches `b` about the joint points, which `load` writes.
    pub(in crate::variational) fn respond(
        &mut self,
        frames: &[JointFrame],
        load: impl FnOnce(&mut [Wrench]),
        mut solution: impl FnMut(usize, &Twist, Wrench),
    ) {
        self.rhs.fill(Spatial::ZERO);
        load(&mut self.rhs);
        self.sweep(frames, |_| None, |_| Vector3::zeros(), &mut solution);
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
        frames: &[JointFrame],
        bias: impl Fn(usize) -> Option<Twist>,
        along: impl Fn(usize) -> Vector3<f64>,
        solution: &mut impl FnMut(usize, &Twist, Wrench),
    ) {
        self.eliminate(frames, &bias, along);
        self.substitute(frames, &bias, solution);
    }

    /// The sweep towards the root, which eliminates the free directions of their joints.
    #[inline(always)]
    fn eliminate(
        &mut self,
        frames: &[JointFrame],
        bias: &impl Fn(usize) -> Option<Twist>,
        along: impl Fn(usize) -> Vector3<f64>,
    ) {
        for i in (1..self.parent.len()).rev() {
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

    /// The sweep away from the root, which finds their twists and the wrenches in their joints.
    #[inline(always)]
    fn substitute(
        &mut self,
        frames: &[JointFrame],
        bias: &impl Fn(usize) -> Option<Twist>,
        solution: &mut impl FnMut(usize, &Twist, Wrench),
    ) {
        for i in 1..self.parent.len() {
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
