//! The bonds of a system in a step: their impulses, and the solves that find them.
//!
//! Every solve goes in two passes over the tree: one without the rows, one with the impulses that bring the rows to
//! what they must see ([`crate::variational::tree::schur`]).

use super::bond::{Bond, bonds};
use super::step_energy::StepEnergy;
use crate::mechanics::System;
use crate::variational::chain::{JointFrame, Node, Pose};
use crate::variational::predictor::{self, Predictor};
use crate::variational::tree::Tree;
use crate::variational::tree::orthogonal::Orthogonal;
use crate::variational::tree::row::Row;
use crate::variational::tree::schur::Schur;
use crate::variational::tree::spatial::{Spatial, Twist, Wrench};

/// Room for the bonds of a system. The rows of springs come last.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Loops {
    pub(super) bonds: Vec<Bond>,
    /// Rows at the start of the step, and at the end of the motions that are being tried.
    pub(super) rows: Vec<Row>,
    pub(super) rows_after: Vec<Row>,
    /// Number of rows that are constraints.
    pub(super) rigid: usize,
    /// Impulses of the first half kick along the rows.
    pub(super) nu: Vec<f64>,
    /// What the rows are short of, m or rad, and by how much that moves the bodies.
    pub(super) gap: Vec<f64>,
    pub(super) moves: Vec<f64>,
    /// By how much a spring's gap moves the bodies, over the gap: 1 where it is rigid, 0 where it has no stiffness.
    pub(super) grip: Vec<f64>,
    pub(super) x: Vec<f64>,
    pub(super) compliance: Vec<f64>,
    /// The Schur complement of the constraints, and of all rows in the first half kick where there are springs or the
    /// joints have forces of their own.
    pub(super) hold: Schur,
    pub(super) drift: Option<Schur>,
    /// The Schur complement of the exact linearisation.
    pub(super) exact: Orthogonal,
    /// Twists at the joint points in the first pass of a solve.
    pub(super) twist: Vec<Twist>,
    /// Rows' impulses, six to an entry.
    pub(super) packed: Vec<Wrench>,
    pub(super) ground: Vec<Pose>,
    pub(super) predictor: Predictor,
    /// Energies of the last step and of the one that is being tried.
    pub(super) last: Option<StepEnergy>,
    pub(super) tried: StepEnergy,
    /// For each row of a spring: its impulse of a half kick, and how fast it gets longer.
    pub(super) last_pulls: Vec<(f64, f64)>,
    pub(super) tried_pulls: Vec<(f64, f64)>,
}

impl Loops {
    /// `None` for a system without loops, couplings and springs between points.
    pub(in crate::variational) fn new(
        system: &System,
        nodes: &[Node],
        tree: &Tree,
        joint_forces: bool,
    ) -> Option<Box<Loops>> {
        let bonds = bonds(system, nodes);
        let count = |springs| bonds.iter().filter(|b| b.is_spring() == springs).map(|b| b.rows().len()).sum();
        let (rigid, springs): (usize, usize) = (count(false), count(true));
        let rows = rigid + springs;
        let entries = rows.div_ceil(6) + 1;
        (rows > 0).then(|| {
            Box::new(Loops {
                rows: vec![Row::NONE; rows],
                rows_after: vec![Row::NONE; rows],
                rigid,
                nu: vec![0.0; rows],
                gap: vec![0.0; rows],
                moves: vec![0.0; rows],
                grip: vec![1.0; rows],
                x: vec![0.0; rows],
                compliance: vec![0.0; springs],
                hold: Schur::new(tree, rigid, 0),
                drift: (springs > 0 || joint_forces).then(|| Schur::new(tree, rows, springs)),
                exact: Orthogonal::new(rows, rows),
                twist: vec![Spatial::ZERO; nodes.len()],
                packed: vec![Spatial::ZERO; entries],
                ground: vec![Pose::GROUND; entries],
                predictor: Predictor::new(entries, predictor::FULL),
                last: None,
                tried: StepEnergy::default(),
                last_pulls: vec![(0.0, 0.0); springs],
                tried_pulls: vec![(0.0, 0.0); springs],
                bonds,
            })
        })
    }

    /// Number of rows.
    pub(in crate::variational) fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Independent rows of the constraints.
    pub(in crate::variational) fn rank(&self) -> usize {
        self.hold.rank()
    }

    /// Starts at a configuration in which the bonds have been placed.
    pub(in crate::variational) fn start(&mut self) {
        self.bonds.iter_mut().filter(|bond| bond.is_spring()).for_each(Bond::start);
    }

    /// Places the bonds in a configuration; `back` is the part of a mismatch that one step takes away.
    pub(in crate::variational) fn place(&mut self, nodes: &[Node], pose: &[Pose], frames: &[JointFrame], back: f64) {
        for bond in &mut self.bonds {
            bond.place(nodes, pose, frames, back, &mut self.rows);
        }
    }

    /// Factorises the constraints' complement on the tree of that configuration.
    pub(in crate::variational) fn factorise(
        &mut self,
        tree: &Tree,
        nodes: &[Node],
        frames: &[JointFrame],
        mobility: &impl Fn(usize, &Wrench) -> f64,
    ) {
        self.hold.factorise(tree, nodes, frames, &self.rows, &[], mobility);
    }

    /// Factorises what the first half kick of a step of size `h` needs beyond that: `tree` has the joints' own forces.
    pub(in crate::variational) fn prepare(
        &mut self,
        h: f64,
        tree: &Tree,
        nodes: &[Node],
        frames: &[JointFrame],
        mobility: &impl Fn(usize, &Wrench) -> f64,
    ) {
        if let Some(drift) = &mut self.drift {
            let springs = self.bonds.iter().filter(|bond| bond.is_spring());
            let compliances = springs.flat_map(|bond| bond.compliances(h));
            self.compliance.iter_mut().zip(compliances).for_each(|(epsilon, of_row)| *epsilon = of_row);
            drift.factorise(tree, nodes, frames, &self.rows, &self.compliance, mobility);
            for (spring, epsilon) in self.compliance.iter().enumerate() {
                let mobility = drift.mobility(self.rigid + spring);
                self.grip[self.rigid + spring] = mobility / (mobility + epsilon.abs());
            }
            for bond in self.bonds.iter_mut().filter(|bond| bond.is_spring() && !bond.rows().is_empty()) {
                bond.measure_stiffness(h, drift.mobility(bond.rows().start));
            }
        }
    }

    /// Starts the impulses of a half kick `h/2` at `time` from those of the last steps; from none without a degree.
    pub(in crate::variational) fn predict(&mut self, time: f64, h: f64, degree: Option<usize>) {
        match degree {
            Some(degree) => self.predictor.predict(time, h, degree, &self.ground, &mut self.packed),
            None => self.packed.fill(Spatial::ZERO),
        }
        for (r, nu) in self.nu.iter_mut().enumerate() {
            let entry = self.packed[r / 6 + 1];
            *nu = if r % 6 < 3 { entry.linear[r % 3] } else { entry.angular[r % 3] };
        }
        self.drift.as_mut().unwrap_or(&mut self.hold).keep_effective(&mut self.nu);
    }

    /// Remembers the impulses of a half kick `h/2` at `time`.
    pub(in crate::variational) fn record(&mut self, time: f64, h: f64) {
        for (r, nu) in self.nu.iter().enumerate() {
            let entry = &mut self.packed[r / 6 + 1];
            let part = if r % 6 < 3 { &mut entry.linear } else { &mut entry.angular };
            part[r % 3] = *nu;
        }
        self.predictor.record(time, h, &self.ground, &self.packed);
    }

    /// Keeps the twists at the joint points of the first pass of a solve.
    pub(in crate::variational) fn first_pass(&mut self) -> &mut [Twist] {
        &mut self.twist
    }

    /// Takes over the state of the same bonds in another copy of the integrator; configuration and factors are made
    /// anew.
    pub(in crate::variational) fn copy_from(&mut self, other: &Loops) {
        self.bonds.iter_mut().zip(&other.bonds).for_each(|(bond, from)| bond.copy_from(from));
        self.nu.copy_from_slice(&other.nu);
        self.predictor.copy_from(&other.predictor);
        (self.last, self.tried) = (other.last, other.tried);
        self.last_pulls.copy_from_slice(&other.last_pulls);
    }

    /// Takes over what the accepted step has changed; `back` is the part of a difference that one step takes away.
    pub(in crate::variational) fn accept(&mut self, back: f64) {
        self.bonds.iter_mut().for_each(|bond| bond.accept(back));
        self.last = Some(self.tried);
        self.last_pulls.copy_from_slice(&self.tried_pulls);
    }

    /// The potential of the springs between points in the middle of the last step, J.
    pub(in crate::variational) fn potential(&self) -> f64 {
        self.bonds.iter().map(Bond::potential).sum()
    }
}
