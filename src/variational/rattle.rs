//! RATTLE for rigid bodies on the constraint manifold of their joints.
//!
//! The discrete Hamiltonian map of the constrained discrete Lagrangian of Marsden and West (2001), sections 3.5.3 and
//! 3.5.4, in the variables (q, p): from `phi(q0) = 0`, `G(q0) M^-1 p0 = 0` one step of size `h` is
//!
//! ```text
//! p'  = p0 + h/2 (f(q0) + G(q0)^T lambda0)        half kick                                (1)
//! x1  = x0 + h p'/m ,   R1 = R0 F(s)              drift, with pi' unchanged               (2)
//! phi(q1) = 0                                     the joints hold: this fixes lambda0     (3)
//! p1  = p' + h/2 (f(q1) + G(q1)^T lambda1)        half kick                                (4)
//! G(q1) M^-1 p1 = 0                               the twists fit: this fixes lambda1      (5)
//! ```
//!
//! (3) is solved by a chord iteration with the articulated-body factorisation at `q0`, which is the one that (5) of the step
//! before has made: one factorisation a step. The multipliers live in the joints as wrench impulses `h/2 lambda`; the next
//! step starts from their extrapolation in the child's body frame. Where the iteration does not contract, as in a whip with
//! `h |Omega|` near 1, it goes on with the exact linearisation. `phi(q1)` is computed from the motions of the step, not from
//! the difference of positions, and the iteration ends with a correction below the roundoff of the motions: small steps do not
//! cancel, and nothing is left out that would add up.
//!
//! Springs and drives in joints are part of the discrete Lagrangian, and dampers enter by the discrete Lagrange-d'Alembert
//! principle (Marsden and West, section 3.2): each half kick carries an impulse along the joint's motion subspace, which
//! is solved for with (3); see `forces`.
//!
//! The map is symplectic on the constraint manifold, time-reversible, of order 2, and conserves the momenta of the system's
//! symmetries; it does not conserve energy, whose error stays bounded while `h` times the largest frequency is small.

mod faults;
mod light;
mod node;

use nalgebra::{Matrix3, Quaternion, SVector, UnitQuaternion, Vector3, Vector4};

use super::bonds::Trying;
use super::compensated::{Compensated, Compensated3};
use super::fault::Fault;
use super::forces::{JointForce, joint_forces};
use super::joints::{Motion, Moved, Node, Place, Pose, coordinates_of, keep_locked, mismatch, nodes};
use super::loops::{Loops, StepEnergy, Worst};
use super::method::Method;
use super::newton::{Newton, Tried, turning_inertia};
use super::predictor::Predictor;
use super::rotation::Rotation;
use super::spatial::{Spatial, Twist, Wrench};
use super::tree::{Singular, Tree};
use crate::mechanics::{BodyState, JointKind, State, System};

/// Rounds of the chord iteration after which a step is given up.
pub(super) const MOST_ROUNDS: usize = 60;

/// The part of a joint's mismatch that one step takes away. The mismatch is a sum of roundoff over many steps; it is known
/// to roundoff of the positions only, so taking away all of it in every step would put that noise, divided by the step,
/// into the momenta. The noise has a bias, and the energy drifts in proportion to this rate: at 1e-3 a pendulum loses 1.3e-20
/// of its energy scale a step, at 1e-4 2.8e-21, below that nothing is left of it.
pub(super) const RETURN: f64 = 3e-5;

/// The iteration ends with a correction that is predicted to leave this part of the roundoff of the motions.
const NEGLIGIBLE: f64 = 0.01;

/// Tangent of half the turn, about 0.5 rad, past which Moser-Veselov is the likely cause of a constraint iteration that fails.
const FAST: f64 = 0.25;

/// The part of the kinetic energy between the half kicks that may be that of the kick: of a first solution, and of one that no
/// lower degree of the extrapolation betters. In whips of 10 to 50 links with `h |Omega|` near 1 right solutions have up to
/// 0.31, those that were refused 0.33 to 0.94; with a bound of 0.4 a planar whip of 10 links leaps.
const KICKED: (f64, f64) = (0.3, 0.32);

/// Why a step could not be taken. Bodies and joints are named by the index of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The body turns too far in one step for the rotation rule to have a solution.
    Rotation { body: usize, angle: f64 },
    /// The constraint iteration stopped contracting.
    Constraint { joint: usize, rounds: usize, residual: f64 },
    /// A loop, coupling or spring does not close, or cannot: the index among loops, then couplings, then springs.
    Loop { index: usize, rounds: usize, residual: f64 },
    /// The step would go to another solution of its equations, with this part of the kinetic energy from nowhere: near a
    /// singular configuration of a linkage, or with `h |Omega|` near 1.
    Leap { gained: f64 },
    /// An adaptive step (s) has become too short for the time to advance.
    Stalled { step: f64 },
    /// A joint can move without moving any mass.
    Singular { joint: usize },
    /// A body's state stopped being a number.
    NotFinite { body: usize },
}

/// Position and momentum of a body, as running compensated sums.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    pub x: Compensated3,
    pub q: Compensated<4>,
    /// Linear momentum, kg m/s.
    pub p: Compensated3,
    /// Spin angular momentum, world axes, kg m^2/s.
    pub pi: Compensated3,
}

/// A body in the step that is being tried.
#[derive(Clone, Copy, Debug)]
struct Trial {
    /// Impulse of the first half kick on the body about its centre of mass: gravity and joints.
    kick: Wrench,
    /// Change of position and attitude over the step.
    motion: Motion,
    /// What roundoff may do to the motion, over `f64::EPSILON`, m.
    roundoff: f64,
    /// `h m0` and its solution `s` of the rotation rule; the next solution starts from them.
    hm: Vector3<f64>,
    s: Vector3<f64>,
}

/// The integrator: a system, its state, and room for a step. Nothing is allocated after [`Rattle::new`].
///
/// Arrays run over the nodes: index 0 is the ground, node `i` is body `i - 1` with its joint.
#[derive(Clone, Debug)]
pub struct Rattle {
    nodes: Vec<Node>,
    gravity: Vector3<f64>,
    method: Method,
    /// How each body turns, and whether a body for which Moser-Veselov has no solution goes over to the splitting.
    rules: Vec<Rotation>,
    automatic: bool,
    /// Bodies that went over, and when (s).
    switched: Vec<(usize, f64)>,
    bodies: Vec<Body>,
    /// The configuration at the start of the step, the joints' places in it, and its factorisation.
    pose: Vec<Pose>,
    places: Vec<Place>,
    tree: Tree,
    /// The part of the joints' mismatch there that the next step takes away.
    gap0: Vec<Twist>,
    /// What acts along the joints' coordinates.
    forces: Vec<JointForce>,
    /// Where that depends on the motion: the factorisation with its implicit part, which (3) needs and (5) must not have.
    implicit: Option<Tree>,
    trial: Vec<Trial>,
    /// What each joint does not allow in the configuration that is being tried, over `-h`.
    bias: Vec<Twist>,
    /// By how much `S . wrench` of a joint exceeds the impulse of its own forces.
    along: Vec<Vector3<f64>>,
    /// Impulse on the child at its joint point over the first half kick.
    wrench: Vec<Wrench>,
    /// Twists at the joint points after the last projection.
    twist: Vec<Twist>,
    predictor: Predictor,
    newton: Newton,
    /// Nodes with no or very little inertia.
    light: Vec<usize>,
    /// Loops, couplings and springs between points, where there are any.
    loops: Option<Box<Loops>>,
    /// Time since the start, s.
    time: Compensated<1>,
    /// A length of the system, which weighs angles against positions, m.
    length: f64,
    /// The residual at which the constraint iteration may stop, m; 0 for roundoff.
    tolerance: f64,
    /// A planted fault, and the impulses that it carries over.
    fault: Option<Fault>,
    carried: Option<Vec<Wrench>>,
    /// Rounds of the constraint iteration since the start.
    rounds: u64,
}

impl Rattle {
    /// Starts from the system's initial state. The momenta are projected onto (5).
    ///
    /// # Errors
    /// [`Failure::Singular`] where a joint can move without moving any mass.
    pub fn new(system: &System) -> Result<Rattle, Failure> {
        Rattle::from_state(system, &system.initial)
    }

    /// Starts from a state of the system.
    ///
    /// # Errors
    /// [`Failure::Singular`] where a joint can move without moving any mass.
    pub fn from_state(system: &System, state: &State) -> Result<Rattle, Failure> {
        let mut nodes = nodes(system);
        let forces = joint_forces(system, state, &mut nodes);
        let n = nodes.len();
        let rest = Trial {
            kick: Spatial::ZERO,
            motion: Motion::NONE,
            roundoff: 0.0,
            hm: Vector3::zeros(),
            s: Vector3::zeros(),
        };
        let (bodies, pose) = bodies(system, state);
        let arms: f64 = nodes.iter().map(|node| node.arm.norm().max(node.parent_arm.norm())).sum();
        let length = if arms > 0.0 { arms / (n - 1) as f64 } else { 1.0 };
        let rows = &system.parts;
        let rows = !(rows.loops.is_empty() && rows.couplings.is_empty() && rows.point_springs.is_empty());
        light::mark(&mut nodes, length, !rows);
        let tree = Tree::new(&nodes);
        let implicit = forces.iter().any(JointForce::is_implicit).then(|| tree.clone());
        let mut rattle = Rattle {
            gravity: system.gravity,
            method: Method::Rattle,
            rules: rules(&nodes, Rotation::MoserVeselov),
            automatic: false,
            switched: Vec::with_capacity(n),
            bodies,
            places: vec![Place::GROUND; n],
            light: (1..n).filter(|&i| nodes[i].light).collect(),
            loops: Loops::new(system, &nodes, &tree, implicit.is_some()),
            tree,
            implicit,
            forces,
            pose,
            gap0: vec![Spatial::ZERO; n],
            trial: vec![rest; n],
            bias: vec![Spatial::ZERO; n],
            along: vec![Vector3::zeros(); n],
            wrench: vec![Spatial::ZERO; n],
            twist: vec![Spatial::ZERO; n],
            predictor: Predictor::new(n),
            newton: Newton::new(n),
            time: Compensated::new(SVector::zeros()),
            length,
            tolerance: 0.0,
            fault: None,
            carried: None,
            rounds: 0,
            nodes,
        };
        rattle.factorise(0.0)?;
        for (i, k) in (1..n).filter_map(|i| Some((i, rattle.nodes[i].force?))) {
            rattle.forces[k].start(1.0 / rattle.tree.compliance(i));
        }
        if let Some(loops) = &mut rattle.loops {
            loops.start();
        }
        rattle.project_momenta(0.0);
        Ok(rattle)
    }

    /// Steps by another map than [`Method::Rattle`].
    pub fn with_method(mut self, method: Method) -> Rattle {
        if method != Method::Rattle {
            // Their dampers are those of (1) in `forces` alone.
            self.forces.iter_mut().for_each(|force| force.start(f64::INFINITY));
        }
        Rattle { method, ..self }
    }

    /// Turns the bodies by another rule than [`Rotation::MoserVeselov`].
    pub fn with_rotation(self, rotation: Rotation) -> Rattle {
        Rattle { rules: rules(&self.nodes, rotation), automatic: false, ..self }
    }

    /// Turns the bodies by [`Rotation::MoserVeselov`] while that has a solution. A body for which it has none goes over to
    /// [`Rotation::Splitting`] for the rest of the run: both maps are symplectic and time-reversible and conserve energies
    /// that differ by `O(h^2)`, so that each body changes the energy that is conserved at most once.
    pub fn with_automatic_rotation(self) -> Rattle {
        Rattle { rules: rules(&self.nodes, Rotation::MoserVeselov), automatic: true, ..self }
    }

    /// The bodies that [`Rattle::with_automatic_rotation`] has moved to the splitting, by index, and when (s).
    pub fn switched(&self) -> &[(usize, f64)] {
        &self.switched
    }

    /// Lets the constraint iteration stop at a residual (m; angles times the mean length of a link) instead of at roundoff.
    /// That costs the long-time behaviour: the energy drifts by what the residuals leave out, always to the same side.
    pub fn with_tolerance(self, tolerance: f64) -> Rattle {
        Rattle { tolerance, ..self }
    }

    /// Takes one step of size `h` (s). After a failure the state is the one before the step.
    ///
    /// # Errors
    /// See [`Failure`].
    pub fn step(&mut self, h: f64) -> Result<(), Failure> {
        if !self.forces.is_empty() {
            self.begin_forces(h)?;
        }
        if let Some(loops) = &mut self.loops {
            let tree = self.implicit.as_ref().unwrap_or(&self.tree);
            loops.prepare(h, tree, &self.nodes, &self.places, &mobility(&self.nodes, &self.pose));
        }
        self.solve_or_switch(h)?;
        let time = self.time.value.x;
        self.predictor.record(time, h, &self.pose, &self.wrench);
        self.forces.iter_mut().for_each(JointForce::end);
        if let Some(loops) = &mut self.loops {
            loops.record(time, h);
            loops.accept(time, RETURN);
        }
        self.kick_light(h);
        for ((body, pose), trial) in self.bodies.iter_mut().zip(&mut self.pose).zip(&self.trial).skip(1) {
            body.p.add(&trial.kick.linear); // (1)
            body.pi.add(&trial.kick.angular);
            body.x.add(&trial.motion.dx); // (2)
            body.q.add(&rotation_increment(&pose.q, &trial.s));
            body.q.add(&norm_defect(&body.q.value));
            *pose = Pose::new(body.x.value, body.q.value);
        }
        if self.fault.is_some() {
            self.do_wrong(h);
        }
        self.factorise(h)?;
        self.project_momenta(h);
        self.time.add(&SVector::<f64, 1>::new(h));
        Ok(())
    }

    /// Prepares what acts along the joints for a step of size `h`.
    fn begin_forces(&mut self, h: f64) -> Result<(), Failure> {
        self.forces.iter_mut().for_each(|force| force.begin(self.time.value.x, h));
        let Some(tree) = &mut self.implicit else { return Ok(()) };
        let (nodes, pose, forces) = (&self.nodes, &self.pose, &self.forces);
        let implicit = |i: usize| nodes[i].force.map_or(0.0, |k| forces[k].implicit(h));
        tree.factorise(nodes, &self.places, |i| world_inertia(&nodes[i], &pose[i]), implicit)
            .map_err(|Singular { node }| Failure::Singular { joint: node - 1 })
    }

    /// (1) to (3), with another rotation rule for the bodies that need one. When that does not help, nothing has changed.
    fn solve_or_switch(&mut self, h: f64) -> Result<(), Failure> {
        let before = self.switched.len();
        loop {
            let failure = match self.solve_constraints(h) {
                Err(failure) if self.automatic => failure,
                result => return result,
            };
            let body = match failure {
                Failure::Rotation { body, .. } => Some(body),
                Failure::Constraint { .. } | Failure::Loop { .. } => self.fastest_turning(),
                Failure::Leap { .. }
                | Failure::Stalled { .. }
                | Failure::Singular { .. }
                | Failure::NotFinite { .. } => None,
            };
            match body {
                Some(body) if self.rules[body + 1] == Rotation::MoserVeselov => {
                    self.rules[body + 1] = Rotation::Splitting;
                    self.switched.push((body, self.time.value.x));
                }
                _ => {
                    for (body, _) in self.switched.drain(before..) {
                        self.rules[body + 1] = Rotation::MoserVeselov;
                    }
                    return Err(failure);
                }
            }
        }
    }

    /// The body that turns most in the step that was tried last, by more than [`FAST`], of those that can go over to the
    /// splitting.
    fn fastest_turning(&self) -> Option<usize> {
        let turn = |i: &usize| self.trial[*i].s.norm();
        let candidates = (1..self.nodes.len()).filter(|&i| self.rules[i] == Rotation::MoserVeselov);
        candidates.filter(|i| turn(i) > FAST).max_by(|i, j| turn(i).total_cmp(&turn(j))).map(|i| i - 1)
    }

    /// Finds the wrenches with which the joints hold at the end of the drift: (1) to (3).
    fn solve_constraints(&mut self, h: f64) -> Result<(), Failure> {
        // A high degree starts closer, a low one survives a violent moment.
        let mut degree = self.predictor.degree().filter(|_| self.carried.is_none());
        loop {
            match degree {
                Some(degree) => self.predictor.predict(self.time.value.x, h, degree, &self.pose, &mut self.wrench),
                None => self.wrench.fill(Spatial::ZERO),
            }
            if let Some(loops) = &mut self.loops {
                loops.predict(self.time.value.x, h, degree);
            }
            let forced = !self.forces.is_empty();
            for (i, node) in self.nodes.iter().enumerate().skip(1) {
                if !(forced && node.force.is_some()) {
                    keep_locked(node, &self.places[i], &mut self.wrench[i]);
                }
            }
            match (self.iterate(h, if degree.is_some() { KICKED.0 } else { KICKED.1 }), degree) {
                (Err(_), Some(used)) => degree = used.checked_sub(1),
                (result, _) => return result,
            }
        }
    }

    /// The chord iteration, down to roundoff; `kicked` is the bound of [`Rattle::refuse_leap`].
    fn iterate(&mut self, h: f64, kicked: f64) -> Result<(), Failure> {
        let (mut last, mut rounds, mut exact) = (f64::INFINITY, 0, false);
        self.start_light(h);
        loop {
            self.kick_and_drift(h)?;
            let (mut place, mut residual, mut roundoff) = self.measure_mismatch(h);
            if let Some(worst) = self.measure_loops(h) {
                roundoff = roundoff.max(f64::EPSILON * worst.roundoff);
                if !(worst.size <= residual) {
                    (place, residual) = (Open::Loop(worst.bond), worst.size);
                }
            }
            if !residual.is_finite() {
                let body = if let Open::Joint(body) = place { body } else { 0 };
                return Err(Failure::NotFinite { body });
            }
            // The exact linearisation stops contracting at roundoff only, wherever the estimate of it puts that.
            let near = if exact { 1e4 } else { 64.0 };
            let stagnant = residual > 0.3 * last && residual <= near * roundoff;
            if stagnant || residual <= self.tolerance {
                return self.refuse_false_solutions(h, rounds, exact.then_some(kicked));
            }
            // What a residual at roundoff leaves out has the same sign for many steps: the energy drifts unless it is corrected.
            let predicted = if rounds == 0 { residual } else { residual * (residual / last) };
            let last_round = residual <= roundoff || predicted <= NEGLIGIBLE * roundoff;
            let slow = residual > 0.2 * last;
            if rounds == MOST_ROUNDS || (exact && rounds > 8 && residual > 0.9 * last) {
                return Err(place.failure(rounds, residual));
            }
            exact |= slow && rounds >= 3;
            if exact {
                // A block that has no inverse there says nothing about the system, only that the step is too long.
                self.relinearise_and_correct(h).map_err(|_| place.failure(rounds, residual))?;
            } else {
                self.correct(h)
            }
            (last, rounds) = (residual, rounds + 1);
            self.rounds += 1;
            if last_round {
                self.kick_and_drift(h)?;
                // Springs, drives and loops keep what they measured for the second half kick.
                if !self.forces.is_empty() {
                    self.measure_mismatch(h);
                }
                self.measure_loops(h);
                return self.refuse_false_solutions(h, rounds, exact.then_some(kicked));
            }
        }
    }

    /// (1) and (2) with the present wrenches.
    fn kick_and_drift(&mut self, h: f64) -> Result<(), Failure> {
        let (part, _) = self.method.parts();
        for i in 1..self.nodes.len() {
            self.trial[i].kick = Spatial::new(part * h * self.nodes[i].mass * self.gravity, Vector3::zeros());
        }
        for i in 1..self.nodes.len() {
            add_joint_impulse(&mut self.trial, &self.nodes, &self.places, i, &self.wrench[i]);
        }
        if let Some(loops) = &self.loops {
            loops.push(&self.places, |i, impulse| self.trial[i].kick += impulse);
        }
        if let Some(carried) = &self.carried {
            self.trial.iter_mut().zip(carried).for_each(|(trial, impulse)| trial.kick += *impulse);
        }
        for i in 1..self.nodes.len() {
            let (node, body, trial, pose) = (&self.nodes[i], &self.bodies[i], &mut self.trial[i], &self.pose[i]);
            if node.light {
                continue;
            }
            trial.motion.dx = body.p.plus(&trial.kick.linear) * (h / node.mass);
            let hm = h * pose.r.tr_mul(&body.pi.plus(&trial.kick.angular));
            let start = trial.s + 0.5 * (hm - trial.hm).component_div(&node.inertia);
            trial.s = match self.rules[i].solve(&node.inertia, &hm, &start) {
                Some(s) => s,
                None => {
                    let angle = hm.component_div(&node.inertia).norm();
                    (trial.s, trial.hm) = (Vector3::zeros(), Vector3::zeros());
                    return Err(Failure::Rotation { body: i - 1, angle });
                }
            };
            trial.hm = hm;
            trial.motion.s = pose.r * trial.s;
            trial.roundoff = trial.motion.dx.norm()
                + self.length * hm.norm() / node.inertia.min()
                + self.wrench[i].linear.norm() * (h.abs() / node.mass);
        }
        Ok(())
    }

    /// Fills in the joints' mismatch over `-h`. Returns the joint where it is largest, how large it is (m; angles times
    /// the system's length), and how small roundoff lets it become.
    fn measure_mismatch(&mut self, h: f64) -> (Open, f64, f64) {
        // Of a system at rest, what is taken back of the mismatch is all that there is to be resolved.
        let (mut worst, mut joint, mut roundoff) = (0.0, 0, RETURN * self.length);
        for i in 1..self.nodes.len() {
            let (node, place, trial) = (&self.nodes[i], &self.places[i], &self.trial[i]);
            let parent = &self.trial[node.parent].motion;
            let moved = Moved::new(place, &self.places[node.parent].arm, &trial.motion, parent);
            let gap = moved.locked(node, place, parent) + self.gap0[i];
            let size = gap.linear.norm() + self.length * gap.angular.norm();
            self.bias[i] = gap.scaled(-1.0 / h);
            // What is not a number stays the worst.
            if size > worst || !(size + trial.roundoff).is_finite() {
                (worst, joint) = (size + 0.0 * trial.roundoff, i - 1);
            }
            roundoff = trial.roundoff.max(roundoff);
        }
        if !self.forces.is_empty() {
            self.measure_excess(h, (&mut joint, &mut worst), &mut roundoff);
        }
        if !self.light.is_empty() {
            let (body, size, noise) = self.measure_imbalance(h);
            roundoff = roundoff.max(noise / f64::EPSILON);
            if !(size <= worst) {
                (worst, joint) = (size, body);
            }
        }
        (Open::Joint(joint), worst, f64::EPSILON * roundoff)
    }

    fn measure_loops(&mut self, h: f64) -> Option<Worst> {
        let trial = &self.trial;
        let loops = self.loops.as_mut()?;
        Some(loops.measure(h, &self.nodes, &self.places, &|i| trial[i].motion, self.length))
    }

    /// Fails where redundant rows contradict each other, so that no impulse closes the loop, and where a linkage leaps.
    fn refuse_false_solutions(&mut self, h: f64, rounds: usize, kicked: Option<f64>) -> Result<(), Failure> {
        let Some(mut loops) = self.loops.take() else {
            return kicked.map_or(Ok(()), |kicked| self.refuse_leap(h, kicked));
        };
        let open = loops.contradiction(&self.nodes, self.length);
        let open = open.map(|(index, residual)| Failure::Loop { index, rounds, residual });
        let leap = loops.leap(h, self.step_energy(h)).map(|gained| Failure::Leap { gained });
        self.loops = Some(loops);
        open.or(leap).map_or(Ok(()), Err)
    }

    /// Fails where the exact linearisation has found a false solution. The joints' impulses do no work on the velocities at the
    /// start, so the kinetic energy between the half kicks is that of the start, half the work of the step, and the energy of
    /// the kick alone, a part `sin^2` of the angle by which the kick turns the momentum. Linkages compare two steps instead.
    fn refuse_leap(&self, h: f64, kicked: f64) -> Result<(), Failure> {
        let (energy, start) = (self.step_energy(h), self.kinetic_energy());
        let (gained, kinetic) = (energy.kinetic - start - 0.5 * energy.work, energy.kinetic.max(start));
        if gained.abs() <= kicked * kinetic + energy.fall {
            Ok(())
        } else {
            Err(Failure::Leap { gained: gained / kinetic })
        }
    }

    /// Kinetic energy of the momenta at the start of the step, J.
    fn kinetic_energy(&self) -> f64 {
        let moving = self.nodes.iter().zip(&self.bodies).zip(&self.pose).skip(1);
        moving.map(|((node, body), pose)| kinetic_energy(node, &body.p.value, &pose.r.tr_mul(&body.pi.value))).sum()
    }

    /// The energies of the step that is being tried.
    fn step_energy(&self, h: f64) -> StepEnergy {
        let mut sum = StepEnergy::default();
        for i in 1..self.nodes.len() {
            let (node, body, trial) = (&self.nodes[i], &self.bodies[i], &self.trial[i]);
            sum.kinetic += if node.light {
                let Spatial { linear, angular } = self.momentum_of_motion(i, h);
                kinetic_energy(node, &linear, &self.pose[i].r.tr_mul(&angular))
            } else {
                kinetic_energy(node, &body.p.plus(&trial.kick.linear), &(trial.hm / h))
            };
            sum.work += node.mass * self.gravity.dot(&trial.motion.dx);
            sum.fall += 0.5 * node.mass * (h * self.gravity).norm_squared();
        }
        sum.work += self.forces.iter().map(|force| force.work(h)).sum::<f64>();
        sum
    }

    /// The same for what acts along the joints: by how far the joint would move if the impulse were right.
    fn measure_excess(&mut self, h: f64, (joint, worst): (&mut usize, &mut f64), roundoff: &mut f64) {
        for (i, k) in (1..self.nodes.len()).filter_map(|i| Some((i, self.nodes[i].force?))) {
            let (node, place, parent) = (&self.nodes[i], &self.places[i], self.nodes[i].parent);
            let (motion, carried) = (&self.trial[i].motion, &self.trial[parent].motion);
            let travel = Moved::new(place, &self.places[parent].arm, motion, carried).travel(node, place, carried);
            let impulse = coordinates_of(node, place, &self.wrench[i]);
            self.along[i] = self.forces[k].excess(travel, impulse);
            let effect = h.abs() * self.compliance(i);
            let size = effect * self.along[i].norm();
            if size > *worst || !size.is_finite() {
                (*worst, *joint) = (size, i - 1);
            }
            *roundoff = roundoff.max(effect * impulse.norm());
        }
    }

    /// (3): one round of the chord iteration.
    fn correct(&mut self, h: f64) {
        let Some(mut loops) = self.loops.take() else {
            if self.light.is_empty() {
                self.correct_tree(|_, _| ());
            } else {
                self.correct_loaded(h);
            }
            return;
        };
        let twist = loops.first_pass();
        self.correct_tree(|i, v| twist[i] = *v);
        let (tree, wrench) = (self.implicit.as_mut().unwrap_or(&mut self.tree), &mut self.wrench);
        loops.correct(h, tree, &self.nodes, &self.places, |i, f| wrench[i] += f);
        self.loops = Some(loops);
    }

    /// The part of it that the tree does alone; `twist(i, v)` gets the twists at the joint points.
    fn correct_tree(&mut self, mut twist: impl FnMut(usize, &Twist)) {
        let (bias, along, wrench) = (&self.bias, &self.along, &mut self.wrench);
        let add = |i: usize, v: &Twist, f: Wrench| {
            wrench[i] += f;
            twist(i, v);
        };
        let tree = self.implicit.as_mut().unwrap_or(&mut self.tree);
        if self.forces.is_empty() {
            tree.correct(&self.nodes, &self.places, |i| bias[i], |_| Vector3::zeros(), add);
        } else {
            tree.correct(&self.nodes, &self.places, |i| bias[i], |i| along[i], add);
        }
    }

    /// The same where light bodies have impulses to balance.
    fn correct_loaded(&mut self, h: f64) {
        let mut tree = std::mem::replace(self.implicit.as_mut().unwrap_or(&mut self.tree), Tree::EMPTY);
        tree.load(&self.nodes, &self.places, |i| self.imbalance(i, h));
        let (bias, along, wrench) = (&self.bias, &self.along, &mut self.wrench);
        tree.correct_loaded(&self.nodes, &self.places, |i| bias[i], |i| along[i], |i, _, f| wrench[i] += f);
        self.correct_light(h, |rattle, i| tree.twist(i).twist_at(&-rattle.places[i].arm));
        *self.implicit.as_mut().unwrap_or(&mut self.tree) = tree;
    }

    /// (3): one round of Newton's method with the exact linearisation.
    fn relinearise_and_correct(&mut self, h: f64) -> Result<(), Failure> {
        for i in 1..self.nodes.len() {
            let (node, place, trial) = (&self.nodes[i], &self.places[i], &self.trial[i]);
            let parent = &self.trial[node.parent].motion;
            let k = self.rules[i].derivative(&node.inertia, &trial.s, &trial.hm);
            self.newton.tried[i] = Tried {
                motion: trial.motion,
                inertia: turning_inertia(&self.pose[i].r, &trial.s, &k),
                turn: Moved::new(place, &self.places[node.parent].arm, &trial.motion, parent).turn,
                locked: self.bias[i].scaled(-h),
                along: self.along[i],
                implicit: node.force.map_or(0.0, |k| self.forces[k].implicit(h)),
                kick: self.imbalance(i, h),
            };
        }
        let (wrench, trial) = (&mut self.wrench, &self.trial);
        let (nodes, places, newton) = (&self.nodes, &self.places, &mut self.newton);
        let mut solved = newton.correct(nodes, places, h, |i, f| wrench[i] += f);
        if let (Ok(()), Some(loops)) = (solved, &mut self.loops) {
            let at = Trying { nodes, pose: &self.pose, places, motion: &|i| trial[i].motion };
            solved = loops.correct_exactly(h, newton, &at, |i, f| wrench[i] += f);
        }
        solved.map_err(|Singular { node }| Failure::Singular { joint: node - 1 })?;
        self.correct_light(h, |rattle, i| {
            let (arm, motion) = (&rattle.places[i].arm, &rattle.trial[i].motion);
            rattle.newton.motion(i).twist_at(&-(arm + motion.turned(arm)))
        });
        Ok(())
    }

    /// Places the joints in the present configuration and factorises there, for the end of a step of size `h`.
    fn factorise(&mut self, h: f64) -> Result<(), Failure> {
        for i in 1..self.nodes.len() {
            let parent = self.nodes[i].parent;
            let parent_arm = self.places[parent].arm;
            let (node, pose, parent) = (&self.nodes[i], &self.pose[i], &self.pose[parent]);
            self.places[i] = Place::new(node, pose, parent, &parent_arm);
            self.gap0[i] = mismatch(node, pose, parent).scaled(RETURN);
        }
        let (nodes, pose, forces) = (&self.nodes, &self.pose, &self.forces);
        let late = |i: usize| if self.implicit.is_some() { late(nodes, forces, i, h) } else { 0.0 };
        self.tree
            .factorise(nodes, &self.places, |i| world_inertia(&nodes[i], &pose[i]), late)
            .map_err(|Singular { node }| Failure::Singular { joint: node - 1 })?;
        if let Some(loops) = &mut self.loops {
            loops.place(nodes, pose, &self.places, RETURN);
            loops.factorise(&self.tree, nodes, &self.places, &mobility(nodes, pose));
        }
        Ok(())
    }

    /// (4) and (5): the second half kick of a step of size `h`, and the joint impulses that make the twists fit.
    fn project_momenta(&mut self, h: f64) {
        let (_, part) = self.method.parts();
        let (nodes, bodies, twist, wrench) = (&self.nodes, &self.bodies, &mut self.twist, &mut self.wrench);
        for i in 1..nodes.len() {
            self.trial[i].kick = Spatial::new(part * h * nodes[i].mass * self.gravity, Vector3::zeros());
        }
        if !self.forces.is_empty() {
            for (i, k) in (1..nodes.len()).filter_map(|i| Some((i, nodes[i].force?))) {
                let impulse = self.forces[k].second_half(&nodes[i], &self.places[i]);
                add_joint_impulse(&mut self.trial, nodes, &self.places, i, &impulse);
            }
        }
        if let Some(loops) = &mut self.loops {
            if h != 0.0 {
                loops.push_springs(&self.places, |i, impulse| self.trial[i].kick += impulse);
            }
            let (trial, first) = (&self.trial, loops.first_pass());
            let momentum = |i: usize| Spatial::new(bodies[i].p.value, bodies[i].pi.value) + trial[i].kick;
            self.tree.project(nodes, &self.places, momentum, |i, v, _| first[i] = *v);
            loops.project(&self.places, |i, impulse| self.trial[i].kick += impulse);
        }
        let trial = &self.trial;
        self.tree.project(
            nodes,
            &self.places,
            |i| Spatial::new(bodies[i].p.value, bodies[i].pi.value) + trial[i].kick,
            |i, v, f| {
                twist[i] = *v;
                wrench[i] = f;
            },
        );
        for i in 1..self.nodes.len() {
            // The wrench is a difference of momenta: what roundoff leaves along the free directions would be a force there.
            if late(&self.nodes, &self.forces, i, h) == 0.0 {
                keep_locked(&self.nodes[i], &self.places[i], &mut self.wrench[i]);
            }
            if self.method == Method::Shake && h != 0.0 {
                continue;
            }
            add_joint_impulse(&mut self.trial, &self.nodes, &self.places, i, &self.wrench[i]);
        }
        self.project_light();
        for (body, trial) in self.bodies.iter_mut().zip(&self.trial).skip(1) {
            body.p.add(&trial.kick.linear);
            body.pi.add(&trial.kick.angular);
        }
    }

    /// By how much a unit impulse along a joint changes its velocity, times the system's length for an angle.
    fn compliance(&self, i: usize) -> f64 {
        let weight = if self.nodes[i].kind == JointKind::Prismatic { 1.0 } else { self.length };
        weight * self.implicit.as_ref().unwrap_or(&self.tree).compliance(i)
    }

    /// Writes the present state: poses, and the twists that fit the joints.
    pub fn write_state(&self, out: &mut State) {
        for (i, b) in out.bodies.iter_mut().enumerate() {
            let twist = self.twist[i + 1].twist_at(&-self.places[i + 1].arm);
            *b = BodyState {
                position: self.bodies[i + 1].x.value,
                attitude: UnitQuaternion::new_unchecked(Quaternion::from(self.bodies[i + 1].q.value)),
                velocity: twist.linear,
                angular_velocity: twist.angular,
            };
        }
    }

    /// The body that the forces in the joints would swing fastest, by index, and how fast, rad/s: a body with the forces `F_j` at
    /// the joint points `r_j` from its centre of mass turns about its own joint, at `r_0`, like a pendulum,
    ///
    /// ```text
    /// omega^2 = sum_j |F_j| |r_j| / (J + m |r_0|^2) .
    /// ```
    ///
    /// It is a bound of the size of the fastest sway of a taut chain, by the forces of the last step. `None` before the first.
    pub fn fastest_sway(&self) -> Option<(usize, f64)> {
        self.predictor.degree()?;
        let mut moment = vec![0.0; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate().skip(1) {
            let force = self.predictor.newest(i).linear.norm();
            moment[i] += force * node.arm.norm();
            moment[node.parent] += force * node.parent_arm.norm();
        }
        let rate = |i: usize| {
            let node = &self.nodes[i];
            let inertia = node.inertia.max() + node.mass * node.arm.norm_squared();
            if inertia > 0.0 { (moment[i] / inertia).sqrt() } else { 0.0 }
        };
        (1..self.nodes.len()).map(|i| (i - 1, rate(i))).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The largest part of its kinetic energy that a linkage took from nowhere or lost in a step, with the time, s; `None` where
    /// that was never more than a few hundredths. A linkage does so that passes a singular configuration within a step.
    pub fn jump(&self) -> Option<(f64, f64)> {
        self.loops.as_ref().and_then(|loops| loops.jump())
    }

    /// Independent rows of the loops and couplings in the present configuration.
    pub fn rank(&self) -> usize {
        self.loops.as_ref().map_or(0, |loops| loops.rank())
    }

    /// Rounds of the constraint iteration since the start.
    pub fn rounds(&self) -> u64 {
        self.rounds
    }
}

/// The bodies of a state behind one for the ground, and their poses.
pub(super) fn bodies(system: &System, state: &State) -> (Vec<Body>, Vec<Pose>) {
    let zero: Compensated3 = Vector3::zeros().into();
    let ground = Body { x: zero, q: Compensated::new(Pose::GROUND.q), p: zero, pi: zero };
    let moving = state.bodies.iter().zip(&system.bodies).map(|(b, body)| {
        let omega = b.attitude.inverse_transform_vector(&b.angular_velocity);
        Body {
            x: b.position.into(),
            q: Compensated::new(b.attitude.coords),
            p: (body.mass * b.velocity).into(),
            pi: (b.attitude * body.inertia.component_mul(&omega)).into(),
        }
    });
    let poses = state.bodies.iter().map(|b| Pose::new(b.position, b.attitude.coords));
    (std::iter::once(ground).chain(moving).collect(), std::iter::once(Pose::GROUND).chain(poses).collect())
}

/// The rotation rule of each node: light bodies always turn by [`Rotation::Cayley`].
fn rules(nodes: &[Node], rotation: Rotation) -> Vec<Rotation> {
    nodes.iter().map(|node| if node.light { Rotation::Cayley } else { rotation }).collect()
}

/// Where a step is farthest from closed: a joint, by its body, or a bond.
#[derive(Clone, Copy, Debug)]
enum Open {
    Joint(usize),
    Loop(usize),
}

impl Open {
    fn failure(self, rounds: usize, residual: f64) -> Failure {
        match self {
            Open::Joint(joint) => Failure::Constraint { joint, rounds, residual },
            Open::Loop(index) => Failure::Loop { index, rounds, residual },
        }
    }
}

/// Kinetic energy of a body by its momentum and its angular momentum in body axes, J; none where there is no inertia.
fn kinetic_energy(node: &Node, linear: &Vector3<f64>, angular: &Vector3<f64>) -> f64 {
    let part = |square: f64, inertia: f64| if inertia > 0.0 { 0.5 * square / inertia } else { 0.0 };
    part(linear.norm_squared(), node.mass) + (0..3).map(|k| part(angular[k] * angular[k], node.inertia[k])).sum::<f64>()
}

/// What the force of a joint adds to `D` at the end of a step of size `h`.
#[inline(always)]
fn late(nodes: &[Node], forces: &[JointForce], i: usize, h: f64) -> f64 {
    nodes[i].force.map_or(0.0, |k| forces[k].late(h))
}

/// `w M^-1 w` of a wrench about the centre of mass of a free body.
fn mobility(nodes: &[Node], pose: &[Pose]) -> impl Fn(usize, &Wrench) -> f64 {
    |i, wrench| {
        let torque = pose[i].r.tr_mul(&wrench.angular);
        let turning = torque.component_mul(&torque).component_div(&nodes[i].inertia).sum();
        wrench.linear.norm_squared() / nodes[i].mass + turning
    }
}

/// Inertia about the centre of mass in world axes.
#[inline(always)]
pub(super) fn world_inertia(node: &Node, pose: &Pose) -> Matrix3<f64> {
    let mut scaled = pose.r;
    for k in 0..3 {
        scaled.column_mut(k).scale_mut(node.inertia[k]);
    }
    scaled * pose.r.transpose()
}

/// Puts an impulse of joint `i`, known about its joint point, on its two bodies.
#[inline(always)]
fn add_joint_impulse(trial: &mut [Trial], nodes: &[Node], places: &[Place], i: usize, wrench: &Wrench) {
    let (place, parent) = (&places[i], nodes[i].parent);
    trial[i].kick += wrench.wrench_from(&place.arm);
    if parent > 0 {
        trial[parent].kick -= wrench.wrench_from(&(places[parent].arm + place.offset));
    }
}

/// What a quaternion lacks to have length one, to first order. A length off by roundoff scales the attitude matrix, and so all
/// momenta in body axes, and wanders: order 8 on a double pendulum loses a factor 7 in energy over 170 000 steps to it.
#[inline(always)]
pub(super) fn norm_defect(q: &Vector4<f64>) -> Vector4<f64> {
    q * (0.5 * (1.0 - q.norm_squared()))
}

/// `q0 F(s) - q0`, without cancellation for small `s`: with `c = 1 / sqrt(1 + |s|^2)` the scalar part of `F - 1` is
/// `c - 1 = -|s|^2 c^2 / (1 + c)`.
#[inline(always)]
pub(super) fn rotation_increment(q0: &Vector4<f64>, s: &Vector3<f64>) -> Vector4<f64> {
    let square = s.norm_squared();
    let c = 1.0 / (1.0 + square).sqrt();
    let scalar = -square * c * c / (1.0 + c);
    (Quaternion::from(*q0) * Quaternion::new(scalar, c * s.x, c * s.y, c * s.z)).coords
}
