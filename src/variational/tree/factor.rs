//! The factorisation of a tree at one configuration.

use nalgebra::{Cholesky, Matrix3, Vector3};

use super::elimination::{Elimination, Singular, Three, combine, directions, inverse_of_symmetric, reciprocal};
use super::spatial::{Inertia, Spatial, Twist, Wrench};
use crate::variational::chain::{JointFrame, Node};

/// The factorisation at one configuration, with room for the solves.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Tree {
    /// The parents of the nodes, which the sweeps read without the rest of a node.
    pub(super) parent: Vec<usize>,
    /// Articulated inertia of each node about its joint point, its own joint not yet eliminated.
    pub(super) inertia: Vec<Inertia>,
    pub(super) elimination: Vec<Elimination>,
    /// Right-hand sides about the joint points, summed towards the root.
    pub(super) rhs: Vec<Wrench>,
    /// `S . rhs` of each joint after its bias.
    pub(super) along: Vec<Vector3<f64>>,
    /// Twists of the solution at the joint points.
    pub(super) twist: Vec<Twist>,
    /// Index of each node's first degree of freedom, and their number at the end.
    pub(super) first: Vec<usize>,
}

impl Tree {
    /// Of no nodes; it takes no memory.
    pub(in crate::variational) const EMPTY: Tree = Tree {
        parent: Vec::new(),
        inertia: Vec::new(),
        elimination: Vec::new(),
        first: Vec::new(),
        rhs: Vec::new(),
        along: Vec::new(),
        twist: Vec::new(),
    };

    pub(in crate::variational) fn new(nodes: &[Node]) -> Tree {
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
    pub(in crate::variational) fn freedoms(&self) -> usize {
        self.first.last().copied().unwrap_or(0)
    }

    /// Factorises. `inertia(i)` is the inertia of node `i` about its centre of mass in world axes, `implicit(i)` what
    /// the joint's own forces add to `D`.
    pub(in crate::variational) fn factorise(
        &mut self,
        nodes: &[Node],
        frames: &[JointFrame],
        inertia: impl Fn(usize) -> Matrix3<f64>,
        implicit: impl Fn(usize) -> f64,
    ) -> Result<(), Singular> {
        (1..nodes.len()).for_each(|i| self.put_body(nodes, frames, i, &inertia(i)));
        self.factorise_bodies(nodes, frames, implicit)
    }

    /// Puts in the inertia of node `i` about its centre of mass in world axes, before [`Tree::factorise_bodies`].
    #[inline(always)]
    pub(in crate::variational) fn put_body(
        &mut self,
        nodes: &[Node],
        frames: &[JointFrame],
        i: usize,
        inertia: &Matrix3<f64>,
    ) {
        self.inertia[i] = Inertia::of_body(nodes[i].mass, inertia, &frames[i].arm);
    }

    /// [`Tree::factorise`] with the inertias of [`Tree::put_body`].
    pub(in crate::variational) fn factorise_bodies(
        &mut self,
        nodes: &[Node],
        frames: &[JointFrame],
        implicit: impl Fn(usize) -> f64,
    ) -> Result<(), Singular> {
        for i in (1..nodes.len()).rev() {
            let mut passed = self.inertia[i];
            let (frame, node) = (&frames[i], &nodes[i]);
            match &mut self.elimination[i] {
                Elimination::Hinge { n, u, d_inverse } => {
                    *n = frame.axes.column(2).into_owned();
                    *u = Spatial::new(passed.h * *n, passed.j * *n);
                    let d = n.dot(&u.angular) + implicit(i);
                    *d_inverse = reciprocal(d, node.least).ok_or(Singular { node: i })?;
                    passed.subtract_product(&u.scaled(*d_inverse), u);
                }
                Elimination::Slider { n, u, d_inverse } => {
                    *n = frame.axes.column(2).into_owned();
                    *u = Spatial::new(passed.m * *n, passed.h.tr_mul(n));
                    let d = n.dot(&u.linear) + implicit(i);
                    *d_inverse = reciprocal(d, node.least).ok_or(Singular { node: i })?;
                    passed.subtract_product(&u.scaled(*d_inverse), u);
                }
                Elimination::Three(three) => {
                    let Three { s, u, d_inverse } = &mut **three;
                    *s = directions(node.kind, &frame.axes);
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
                self.inertia[node.parent].add_shifted(&passed, &frame.offset);
            }
        }
        Ok(())
    }

    /// Twist of a node at its joint point in the last solution.
    pub(in crate::variational) fn twist(&self, node: usize) -> &Twist {
        &self.twist[node]
    }

    /// Articulated mass and moment of a node about its joint point, the mean over all directions.
    pub(in crate::variational) fn mean_inertia(&self, node: usize) -> (f64, f64) {
        (self.inertia[node].m.trace() / 3.0, self.inertia[node].j.trace() / 3.0)
    }

    /// The largest entry of `D^-1` of a joint.
    pub(in crate::variational) fn compliance(&self, node: usize) -> f64 {
        match &self.elimination[node] {
            Elimination::Hinge { d_inverse, .. } | Elimination::Slider { d_inverse, .. } => *d_inverse,
            Elimination::Three(three) => three.d_inverse.amax(),
            Elimination::Free(_) => 0.0,
        }
    }
}
