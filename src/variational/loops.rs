//! The bonds of a system in a step: their impulses, and the solves that find them.
//!
//! Every solve goes in two passes over the tree: one without the rows, one with the impulses that bring the rows to what
//! they must see ([`super::rows`]).

use nalgebra::Vector6;

use super::bonds::{Bond, Trying, bonds};
use super::joints::{Motion, Node, Place, Pose};
use super::newton::Newton;
use super::orthogonal::Orthogonal;
use super::predictor::{self, Predictor};
use super::rows::{Row, Schur};
use super::spatial::{Spatial, Twist, Wrench};
use super::tree::{Singular, Tree};
use crate::mechanics::System;

/// Redundant rows that contradict each other by more than this, over the system's length, are an open loop.
const CONTRADICTION: f64 = 1e-10;

/// The part of the kinetic energy that a step of a linkage may gain or lose by its error. Whips with `h |Omega|` near 1 gain 0.05.
const LEAP: f64 = 0.3;

/// The same of a step from which a run is worth a warning. Four-bars that pass their flat position within a step have 0.15 to
/// 0.26, at steps that resolve it up to 0.02; all other linkages are below 0.002.
const JUMP: f64 = 0.05;

/// A row of the exact linearisation whose velocity is this part of that on free bodies is implied by the others.
const RANK: f64 = 1e-10;

/// The bond that is farthest from closed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Worst {
    pub bond: usize,
    /// What impulses along the rows can still change, m; angles times the system's length.
    pub size: f64,
    /// What roundoff may do to it, over `f64::EPSILON`, m.
    pub roundoff: f64,
}

/// Room for the bonds of a system. The rows of springs come last.
#[derive(Clone, Debug)]
pub(super) struct Loops {
    bonds: Vec<Bond>,
    /// Rows at the start of the step, and at the end of the motions that are being tried.
    rows: Vec<Row>,
    rows_after: Vec<Row>,
    /// Number of rows that are constraints.
    rigid: usize,
    /// Impulses of the first half kick along the rows.
    nu: Vec<f64>,
    /// What the rows are short of, m or rad, as measured and as far as impulses can change it.
    gap: Vec<f64>,
    reachable: Vec<f64>,
    /// By how much a spring's gap moves the bodies, over the gap: 1 where it is rigid, 0 where it has no stiffness.
    grip: Vec<f64>,
    x: Vec<f64>,
    compliance: Vec<f64>,
    /// The Schur complement of the constraints, and of all rows in the first half kick where there are springs or the joints
    /// have forces of their own.
    hold: Schur,
    drift: Option<Schur>,
    /// The Schur complement of the exact linearisation.
    exact: Orthogonal,
    /// Twists at the joint points in the first pass of a solve.
    twist: Vec<Twist>,
    /// Rows' impulses, six to an entry.
    packed: Vec<Wrench>,
    ground: Vec<Pose>,
    predictor: Predictor,
    /// Energies of the last step and of the one that is being tried.
    last: Option<StepEnergy>,
    tried: StepEnergy,
    /// The part of the kinetic energy that the step which is being tried takes from nowhere or loses, beyond what a turning point
    /// explains, and the largest of the steps that were taken with its time (s), once past [`JUMP`].
    tried_jump: f64,
    jump: Option<(f64, f64)>,
    /// The same for each row of a spring: its impulse of a half kick, and how fast it gets longer.
    last_pulls: Vec<(f64, f64)>,
    tried_pulls: Vec<(f64, f64)>,
}

/// Energies of a step, J.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StepEnergy {
    /// Kinetic energy of the momenta between the half kicks.
    pub kinetic: f64,
    /// Work of gravity over the step.
    pub work: f64,
    /// Kinetic energy that gravity alone gives in the step from rest.
    pub fall: f64,
}

impl Loops {
    /// `None` for a system without loops, couplings and springs between points.
    pub(super) fn new(system: &System, nodes: &[Node], tree: &Tree, joint_forces: bool) -> Option<Box<Loops>> {
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
                reachable: vec![0.0; rows],
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
                tried_jump: 0.0,
                jump: None,
                last_pulls: vec![(0.0, 0.0); springs],
                tried_pulls: vec![(0.0, 0.0); springs],
                bonds,
            })
        })
    }

    /// Independent rows of the constraints.
    pub(super) fn rank(&self) -> usize {
        self.hold.rank()
    }

    /// Starts at a configuration in which the bonds have been placed.
    pub(super) fn start(&mut self) {
        self.bonds.iter_mut().filter(|bond| bond.is_spring()).for_each(Bond::start);
    }

    /// Places the bonds in a configuration; `back` is the part of a mismatch that one step takes away.
    pub(super) fn place(&mut self, nodes: &[Node], pose: &[Pose], places: &[Place], back: f64) {
        for bond in &mut self.bonds {
            bond.place(nodes, pose, places, back, &mut self.rows);
        }
    }

    /// Factorises the constraints' complement on the tree of that configuration.
    pub(super) fn factorise(
        &mut self,
        tree: &Tree,
        nodes: &[Node],
        places: &[Place],
        mobility: &impl Fn(usize, &Wrench) -> f64,
    ) {
        self.hold.factorise(tree, nodes, places, &self.rows, &[], mobility);
    }

    /// Factorises what the first half kick of a step of size `h` needs beyond that: `tree` has the joints' own forces.
    pub(super) fn prepare(
        &mut self,
        h: f64,
        tree: &Tree,
        nodes: &[Node],
        places: &[Place],
        mobility: &impl Fn(usize, &Wrench) -> f64,
    ) {
        if let Some(drift) = &mut self.drift {
            let springs = self.bonds.iter().filter(|bond| bond.is_spring());
            let compliances = springs.flat_map(|bond| bond.compliances(h));
            self.compliance.iter_mut().zip(compliances).for_each(|(epsilon, of_row)| *epsilon = of_row);
            drift.factorise(tree, nodes, places, &self.rows, &self.compliance, mobility);
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
    pub(super) fn predict(&mut self, time: f64, h: f64, degree: Option<usize>) {
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
    pub(super) fn record(&mut self, time: f64, h: f64) {
        for (r, nu) in self.nu.iter().enumerate() {
            let entry = &mut self.packed[r / 6 + 1];
            let part = if r % 6 < 3 { &mut entry.linear } else { &mut entry.angular };
            part[r % 3] = *nu;
        }
        self.predictor.record(time, h, &self.ground, &self.packed);
    }

    /// The impulses of the first half kick on the bodies: `kick(i, w)` with wrenches about the centres of mass.
    pub(super) fn push(&self, places: &[Place], kick: impl FnMut(usize, Wrench)) {
        push(&self.rows, &self.nu, places, kick);
    }

    /// The springs' impulses of the second half kick, which are those of the first along the rows at its place.
    pub(super) fn push_springs(&self, places: &[Place], kick: impl FnMut(usize, Wrench)) {
        push(&self.rows[self.rigid..], &self.nu[self.rigid..], places, kick);
    }

    /// Measures what the motions of a step leave the bonds short of.
    pub(super) fn measure(
        &mut self,
        h: f64,
        nodes: &[Node],
        places: &[Place],
        motion: &dyn Fn(usize) -> Motion,
        length: f64,
    ) -> Worst {
        let mut roundoff = 0.0_f64;
        for bond in &mut self.bonds {
            let rows = bond.rows();
            let grip = self.grip[rows.clone()].iter().fold(0.0_f64, |a, b| a.max(*b));
            let noise = bond.measure(h, nodes, places, motion, (&self.nu[rows.clone()], grip), &mut self.gap[rows]);
            // What is not a number stays.
            roundoff = if noise > roundoff || noise.is_nan() { noise } else { roundoff };
        }
        self.reachable.copy_from_slice(&self.gap);
        self.drift.as_mut().unwrap_or(&mut self.hold).keep_reachable(&mut self.reachable);
        self.reachable.iter_mut().zip(&self.grip).for_each(|(gap, grip)| *gap *= grip);
        let (bond, size) = worst(&self.bonds, nodes, &self.reachable, length);
        Worst { bond, size, roundoff }
    }

    /// The bond that stays open although no impulse can close it further, and by how much, m; or a spring whose points would
    /// pass each other.
    pub(super) fn contradiction(&mut self, nodes: &[Node], length: f64) -> Option<(usize, f64)> {
        let rigid = self.bonds.partition_point(|bond| !bond.is_spring());
        let (bond, size) = worst(&self.bonds[..rigid], nodes, &self.gap, length);
        let passed = self.bonds.iter().position(|bond| bond.passed() > 0.0);
        let open = (!(size <= CONTRADICTION * length)).then_some((bond, size));
        open.or(passed.map(|bond| (bond, self.bonds[bond].passed())))
    }

    /// Keeps the twists at the joint points of the first pass of a solve.
    pub(super) fn first_pass(&mut self) -> &mut [Twist] {
        &mut self.twist
    }

    /// The second pass of a round of the chord iteration: `add(i, f)` gets the change of each joint's impulse.
    pub(super) fn correct(
        &mut self,
        h: f64,
        tree: &mut Tree,
        nodes: &[Node],
        places: &[Place],
        mut add: impl FnMut(usize, Wrench),
    ) {
        for (r, x) in self.x.iter_mut().enumerate() {
            *x = -self.gap[r] / h - self.rows[r].rate(&self.twist);
        }
        self.drift.as_mut().unwrap_or(&mut self.hold).solve(&mut self.x);
        self.nu.iter_mut().zip(&self.x).for_each(|(nu, change)| *nu += change);
        let (rows, x) = (&self.rows, &self.x);
        tree.respond(nodes, places, |rhs| load(rows, x, rhs), |i, _, f| add(i, f));
    }

    /// The second pass of a round with the exact linearisation, after [`Newton::correct`].
    ///
    /// # Errors
    /// A block that cannot be inverted.
    pub(super) fn correct_exactly(
        &mut self,
        h: f64,
        newton: &mut Newton,
        at: &Trying,
        mut add: impl FnMut(usize, Wrench),
    ) -> Result<(), Singular> {
        self.exact_residual(h, newton, at);
        self.factorise_exactly(newton, at)?;
        let schur = self.drift.as_ref().unwrap_or(&self.hold);
        schur.apply_scale(&mut self.x);
        self.exact.solve(&mut self.x);
        schur.apply_scale(&mut self.x);
        self.nu.iter_mut().zip(&self.x).for_each(|(nu, change)| *nu += change);
        let (rows, x) = (&self.rows, &self.x);
        let load = |rhs: &mut [Vector6<f64>]| {
            for (row, x) in rows.iter().zip(x) {
                row.ends().iter().for_each(|(i, w)| rhs[*i] += w.to_vector() * *x);
            }
        };
        newton.respond(at.nodes, at.places, load, &mut add)
    }

    /// What the rows at the end of the motions must still see after the first pass.
    fn exact_residual(&mut self, h: f64, newton: &Newton, at: &Trying) {
        for bond in &self.bonds {
            let rows = bond.rows();
            bond.rows_after(at, &mut self.rows_after);
            bond.targets_after(h, at.motion, &self.gap[rows.clone()], &mut self.x[rows]);
        }
        read_twists(newton, &mut self.twist);
        for (x, row) in self.x.iter_mut().zip(&self.rows_after) {
            *x -= row.rate(&self.twist);
        }
    }

    /// The complement of the rows at the end of the motions and the impulses along the rows at their start.
    fn factorise_exactly(&mut self, newton: &mut Newton, at: &Trying) -> Result<(), Singular> {
        let schur = self.drift.as_ref().unwrap_or(&self.hold);
        for k in 0..self.rows.len() {
            let row = &self.rows[k];
            let load = |rhs: &mut [Vector6<f64>]| row.ends().iter().for_each(|(i, w)| rhs[*i] += w.to_vector());
            newton.respond(at.nodes, at.places, load, |_, _| {})?;
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
        Ok(())
    }

    /// Takes over the state of the same bonds in another copy of the integrator; configuration and factors are made anew.
    pub(super) fn copy_from(&mut self, other: &Loops) {
        self.bonds.iter_mut().zip(&other.bonds).for_each(|(bond, from)| bond.copy_from(from));
        self.nu.copy_from_slice(&other.nu);
        self.predictor.copy_from(&other.predictor);
        (self.last, self.tried) = (other.last, other.tried);
        (self.jump, self.tried_jump) = (other.jump, other.tried_jump);
        self.last_pulls.copy_from_slice(&other.last_pulls);
    }

    /// The largest part of the kinetic energy that a step took from nowhere or lost, and its time, s: where a linkage passed a
    /// singular configuration within a step.
    pub(super) fn jump(&self) -> Option<(f64, f64)> {
        self.jump
    }

    /// Takes over what the accepted step has changed; `back` is the part of a difference that one step takes away.
    pub(super) fn accept(&mut self, time: f64, back: f64) {
        if self.tried_jump > self.jump.map_or(JUMP, |(largest, _)| largest) {
            self.jump = Some((self.tried_jump, time));
        }
        self.bonds.iter_mut().for_each(|bond| bond.accept(back));
        self.last = Some(self.tried);
        self.last_pulls.copy_from_slice(&self.tried_pulls);
    }

    /// The part of the kinetic energy that a step takes from nowhere, or loses, where that is more than [`LEAP`]. Constraints do
    /// no work: near a singular configuration the equations of a step have other solutions, which throw the linkage onto
    /// another branch.
    pub(super) fn leap(&mut self, h: f64, energy: StepEnergy) -> Option<f64> {
        if self.rigid == 0 {
            return None;
        }
        (self.tried, self.tried_jump) = (energy, 0.0);
        let springs = self.bonds.iter().filter(|bond| bond.is_spring());
        let rates = springs.flat_map(|bond| (0..bond.rows().len()).map(move |row| bond.rate(row, h)));
        for ((pull, nu), rate) in self.tried_pulls.iter_mut().zip(&self.nu[self.rigid..]).zip(rates) {
            *pull = (*nu, rate);
        }
        let last = self.last?;
        let gained = energy.kinetic - last.kinetic - 0.5 * (energy.work + last.work) - self.work_of_springs();
        let kinetic = energy.kinetic.max(last.kinetic);
        // Near a turning point the work of a step is all that there is, and steps of different sizes share it unevenly.
        let turning = energy.fall + last.fall + energy.work.abs() + last.work.abs();
        self.tried_jump = if kinetic > 0.0 { (gained.abs() - turning) / kinetic } else { 0.0 };
        (gained.abs() > LEAP * kinetic + turning).then_some(gained / kinetic)
    }

    /// The potential of the springs between points in the middle of the last step, J.
    pub(super) fn potential(&self) -> f64 {
        self.bonds.iter().map(Bond::potential).sum()
    }

    /// Work of the springs from the middle of the last step to that of the one that is being tried: their impulses in the two
    /// half kicks between, times the mean of how fast they get longer. It is right for stiff springs too, whose pull changes
    /// its sign from step to step.
    fn work_of_springs(&self) -> f64 {
        let pulls = self.last_pulls.iter().zip(&self.tried_pulls);
        pulls.map(|((nu0, rate0), (nu1, rate1))| 0.5 * (nu0 + nu1) * (rate0 + rate1)).sum()
    }

    /// After the first pass of a projection of the momenta: the impulses along the constraints' rows that make their
    /// velocities vanish, `kick(i, w)` with wrenches about the centres of mass.
    pub(super) fn project(&mut self, places: &[Place], kick: impl FnMut(usize, Wrench)) {
        let x = &mut self.x[..self.rigid];
        for (x, row) in x.iter_mut().zip(&self.rows) {
            *x = -row.rate(&self.twist);
        }
        self.hold.solve(x);
        push(&self.rows[..self.rigid], x, places, kick);
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

fn push(rows: &[Row], nu: &[f64], places: &[Place], mut kick: impl FnMut(usize, Wrench)) {
    for (row, nu) in rows.iter().zip(nu) {
        for (node, wrench) in row.ends() {
            kick(*node, wrench.scaled(*nu).wrench_from(&places[*node].arm));
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
