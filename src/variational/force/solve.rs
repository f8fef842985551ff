//! Solves for the impulses along the rows.

use nalgebra::Vector3;

use super::bond::{Bond, Trying};
use super::loops::Loops;
use crate::mechanics::RANK;
use crate::variational::chain::{JointFrame, Motion, Node};
use crate::variational::tree::Tree;
use crate::variational::tree::newton::Newton;
use crate::variational::tree::row::Row;
use crate::variational::tree::spatial::{Twist, Wrench};

/// The bond that is farthest from closed.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct Worst {
    pub bond: usize,
    /// By how much the bodies would have to move, m; angles times the system's length.
    pub size: f64,
    /// What roundoff may do to it, over `f64::EPSILON`, m.
    pub roundoff: f64,
}

impl Loops {
    /// The impulses of the first half kick on the bodies: `kick(i, w)` with wrenches about the centres of mass.
    pub(in crate::variational) fn push(&self, frames: &[JointFrame], kick: impl FnMut(usize, Wrench)) {
        push(&self.rows, &self.nu, frames, kick);
    }

    /// The springs' impulses of the second half kick, which are those of the first along the rows at its place.
    pub(in crate::variational) fn push_springs(&self, frames: &[JointFrame], kick: impl FnMut(usize, Wrench)) {
        push(&self.rows[self.rigid..], &self.nu[self.rigid..], frames, kick);
    }

    /// Measures what the motions of a step leave the bonds short of.
    pub(in crate::variational) fn measure(
        &mut self,
        h: f64,
        nodes: &[Node],
        frames: &[JointFrame],
        motion: &dyn Fn(usize) -> Motion,
        length: f64,
    ) -> Worst {
        let mut roundoff = 0.0_f64;
        for bond in &mut self.bonds {
            let rows = bond.rows();
            let grip = self.grip[rows.clone()].iter().fold(0.0_f64, |a, b| a.max(*b));
            let noise = bond.measure(h, nodes, frames, motion, (&self.nu[rows.clone()], grip), &mut self.gap[rows]);
            // What is not a number stays.
            roundoff = if noise > roundoff || noise.is_nan() { noise } else { roundoff };
        }
        self.moves.iter_mut().zip(&self.gap).zip(&self.grip).for_each(|((moves, gap), grip)| *moves = gap * grip);
        let (bond, size) = worst(&self.bonds, nodes, &self.moves, length);
        Worst { bond, size, roundoff }
    }

    /// The second pass of a round of the chord iteration: `add(i, f)` gets the change of each joint's impulse.
    pub(in crate::variational) fn correct(
        &mut self,
        h: f64,
        tree: &mut Tree,
        frames: &[JointFrame],
        mut add: impl FnMut(usize, Wrench),
    ) {
        for (r, x) in self.x.iter_mut().enumerate() {
            *x = -self.gap[r] / h - self.rows[r].rate(&self.twist);
        }
        self.drift.as_mut().unwrap_or(&mut self.hold).solve(&mut self.x);
        self.nu.iter_mut().zip(&self.x).for_each(|(nu, change)| *nu += change);
        let (rows, x) = (&self.rows, &self.x);
        tree.respond(frames, |rhs| load(rows, x, rhs), |i, _, f| add(i, f));
    }

    /// The second pass of a round with the exact linearisation, after [`Newton::solve`].
    pub(in crate::variational) fn correct_exactly(
        &mut self,
        h: f64,
        newton: &mut Newton,
        at: &Trying,
        mut add: impl FnMut(usize, Wrench),
    ) {
        self.exact_residual(h, newton, at);
        let schur = self.drift.as_ref().unwrap_or(&self.hold);
        schur.apply_scale(&mut self.x);
        self.exact.solve(&mut self.x);
        schur.apply_scale(&mut self.x);
        self.nu.iter_mut().zip(&self.x).for_each(|(nu, change)| *nu += change);
        let (rows, x) = (&self.rows, &self.x);
        newton.unload();
        for (row, x) in rows.iter().zip(x) {
            row.ends().iter().for_each(|(i, w)| newton.load(*i, w.scaled(*x)));
        }
        newton.solve(at.nodes, at.frames, |_| Vector3::zeros(), &mut add);
    }

    /// What the rows at the end of the motions must still see after the first pass.
    fn exact_residual(&mut self, h: f64, newton: &Newton, at: &Trying) {
        for bond in &self.bonds {
            let rows = bond.rows();
            bond.targets_after(h, at.motion, &self.gap[rows.clone()], &mut self.x[rows]);
        }
        read_twists(newton, &mut self.twist);
        for (x, row) in self.x.iter_mut().zip(&self.rows_after) {
            *x -= row.rate(&self.twist);
        }
    }

    /// The complement of the rows at the end of the motions and the impulses along the rows at their start.
    pub(in crate::variational) fn factorise_exactly(&mut self, newton: &mut Newton, at: &Trying) {
        self.bonds.iter().for_each(|bond| bond.rows_after(at, &mut self.rows_after));
        let schur = self.drift.as_ref().unwrap_or(&self.hold);
        for k in 0..self.rows.len() {
            let row = &self.rows[k];
            newton.unload();
            row.ends().iter().for_each(|(i, w)| newton.load(*i, *w));
            newton.solve(at.nodes, at.frames, |_| Vector3::zeros(), |_, _| ());
            read_twists(newton, &mut self.twist);
            let column = self.exact.column_mut(k);
            for (entry, row) in column.iter_mut().zip(&self.rows_after) {
                *entry = row.rate(&self.twist);
            }
            if let Some(spring) = k.checked_sub(self.rigid) {
                column[k] += self.compliance[spring];
            }
            column.iter_mut().for_each(|entry| *entry *= schur.scale(k));
            schur.apply_scale(column);
        }
        self.exact.factorise(RANK);
    }

    /// After the first pass of a projection of the momenta: the impulses along the constraints' rows that make their
    /// velocities vanish, `kick(i, w)` with wrenches about the centres of mass.
    pub(in crate::variational) fn project(&mut self, frames: &[JointFrame], kick: impl FnMut(usize, Wrench)) {
        let x = &mut self.x[..self.rigid];
        for (x, row) in x.iter_mut().zip(&self.rows) {
            *x = -row.rate(&self.twist);
        }
        self.hold.solve(x);
        push(&self.rows[..self.rigid], x, frames, kick);
    }
}

fn read_twists(newton: &Newton, twist: &mut [Twist]) {
    twist.iter_mut().enumerate().skip(1).for_each(|(i, twist)| *twist = newton.motion(i));
}

fn worst(bonds: &[Bond], nodes: &[Node], gap: &[f64], length: f64) -> (usize, f64) {
    let mut worst = (0, 0.0);
    for (index, bond) in bonds.iter().enumerate() {
        let size = bond.size(nodes, &gap[bond.rows()], length);
        if !(size <= worst.1) {
            worst = (index, size);
        }
    }
    worst
}

fn push(rows: &[Row], nu: &[f64], frames: &[JointFrame], mut kick: impl FnMut(usize, Wrench)) {
    for (row, nu) in rows.iter().zip(nu) {
        for (node, wrench) in row.ends() {
            kick(*node, wrench.scaled(*nu).wrench_from(&frames[*node].arm));
        }
    }
}

fn load(rows: &[Row], nu: &[f64], rhs: &mut [Wrench]) {
    for (row, nu) in rows.iter().zip(nu) {
        for (node, wrench) in row.ends() {
            rhs[*node] += wrench.scaled(*nu);
        }
    }
}
