//! Scalar rows across the tree and their Schur complement.
//!
//! A row `k` is a wrench on a few bodies; `k . v` is the velocity that it sees. With `T` the response of the tree, the
//! twists that an impulse causes while the joints hold, impulses `nu` along the rows change what the rows see by
//!
//! ```text
//! K T K^T nu = W^T W nu ,      W = D^-1/2 S^T (innovations of K^T) ,
//! ```
//!
//! where the innovation of a joint is what the recursion of [`super`] finds along its free directions. A row with
//! the compliance `epsilon` (a spring) adds `epsilon` to the diagonal: one more row of `W` with `sqrt(epsilon)`. `W` is
//! factorised with its rank revealed, so that redundant rows share the impulse of least norm.

use super::factor::Tree;
use super::orthogonal::Orthogonal;
use super::row::Row;
use super::spatial::Wrench;
use crate::mechanics::RANK;
use crate::variational::chain::{JointFrame, Node};

/// The factorised Schur complement of some rows.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Schur {
    factors: Orthogonal,
    /// What each row is multiplied by, so that its free mobility is 1.
    scale: Vec<f64>,
    /// `k T k^T` of each row: the velocity that it sees for a unit impulse along it.
    mobility: Vec<f64>,
    freedoms: usize,
}

impl Schur {
    /// Room for `rows` rows on a tree, `compliant` of them springs.
    pub(in crate::variational) fn new(tree: &Tree, rows: usize, compliant: usize) -> Schur {
        let freedoms = tree.freedoms();
        let (factors, none) = (Orthogonal::new(freedoms + compliant, rows), vec![0.0; rows]);
        Schur { factors, scale: none.clone(), mobility: none, freedoms }
    }

    /// Factorises. `mobility(i, w)` is `w M^-1 w` of a wrench about the centre of mass of a free node; the last rows
    /// are springs with the given compliances.
    pub(in crate::variational) fn factorise(
        &mut self,
        tree: &Tree,
        nodes: &[Node],
        frames: &[JointFrame],
        rows: &[Row],
        compliance: &[f64],
        mobility: &impl Fn(usize, &Wrench) -> f64,
    ) {
        let rigid = self.scale.len() - compliance.len();
        for (r, row) in rows.iter().enumerate().take(self.scale.len()) {
            let column = self.factors.column_mut(r);
            column.fill(0.0);
            tree.innovations(nodes, frames, row.ends(), &mut column[..self.freedoms]);
            self.mobility[r] = column.iter().map(|x| x * x).sum();
            let mut free = row.free_mobility(frames, mobility);
            if !free.is_finite() {
                free = self.mobility[r];
            }
            if let Some(spring) = r.checked_sub(rigid) {
                column[self.freedoms + spring] = compliance[spring].sqrt();
                free += compliance[spring];
            }
            self.scale[r] = if free > 0.0 { 1.0 / free.sqrt() } else { 0.0 };
            column.iter_mut().for_each(|x| *x *= self.scale[r]);
        }
        self.factors.factorise(RANK);
    }

    /// The impulses that change what the rows see by `x`, those of least norm.
    pub(in crate::variational) fn solve(&mut self, x: &mut [f64]) {
        self.apply_scale(x);
        self.factors.solve_normal(x);
        self.apply_scale(x);
    }

    /// Takes away the part of the impulses `x` that changes nothing. Impulses extrapolated from step to step would
    /// gather such a part, which nothing corrects: it grew without bound on a Bricard linkage.
    pub(in crate::variational) fn keep_effective(&mut self, x: &mut [f64]) {
        if self.factors.rank() < x.len() {
            self.remove_scale(x);
            self.factors.project_on_rows(x);
            self.apply_scale(x);
        }
    }

    fn remove_scale(&self, x: &mut [f64]) {
        for (x, scale) in x.iter_mut().zip(&self.scale) {
            *x = if *scale > 0.0 { *x / scale } else { 0.0 };
        }
    }

    pub(in crate::variational) fn rank(&self) -> usize {
        self.factors.rank()
    }

    /// `k T k^T` of row `r`.
    pub(in crate::variational) fn mobility(&self, r: usize) -> f64 {
        self.mobility[r]
    }

    /// What row `r` is multiplied by.
    pub(in crate::variational) fn scale(&self, r: usize) -> f64 {
        self.scale[r]
    }

    pub(in crate::variational) fn apply_scale(&self, x: &mut [f64]) {
        x.iter_mut().zip(&self.scale).for_each(|(x, scale)| *x *= scale);
    }
}
