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
//! cancel, and nothing is left out that would add up. In a long chain that bends near its base, the rounds that only the base needs
//! are taken there; see `tail`.
//!
//! Springs and drives in joints are part of the discrete Lagrangian, and dampers enter by the discrete Lagrange-d'Alembert
//! principle (Marsden and West, section 3.2): each half kick carries an impulse along the joint's motion subspace, which
//! is solved for with (3); see `forces`.
//!
//! The map is symplectic on the constraint manifold, time-reversible, of order 2, and conserves the momenta of the system's
//! symmetries; it does not conserve energy, whose error stays bounded while `h` times the largest frequency is small.

mod correct;
mod decline;
mod energy;
mod failure;
mod faults;
mod leaps;
mod light;
mod node;
mod project;
mod solve;
mod switching;
mod tail;

pub use failure::Failure;
pub(super) use project::world_inertia;
pub(super) use solve::MOST_ROUNDS;

use std::ops::Range;

use nalgebra::{Quaternion, SVector, UnitQuaternion, Vector3, Vector4};

use super::compensated::{Compensated, Compensated3};
use super::fault::Fault;
use super::forces::{JointForce, joint_forces};
use super::joints::{Motion, Node, Place, Pose, nodes};
use super::loops::Loops;
use super::method::Method;
use super::newton::Newton;
use super::predictor::{self, Predictor};
use super::rotation::Rotation;
use super::spatial::{Spatial, Twist, Wrench};
use super::tree::{Singular, Tree};
use crate::mechanics::{BodyState, State, System};
use project::mobility;
use switching::rules;
use tail::Openings;

/// The part of a joint's mismatch that one step takes away. The mismatch is a sum of roundoff over many steps; it is known
/// to roundoff of the positions only, so taking away all of it in every step would put that noise, divided by the step,
/// into the momenta. The noise has a bias, and the energy drifts in proportion to this rate: at 1e-3 a pendulum loses 1.3e-20
/// of its energy scale a step, at 1e-4 2.8e-21, below that nothing is left of it.
pub(super) const RETURN: f64 = 3e-5;

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
    /// How far each joint is open.
    openings: Openings,
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
    /// Whether the iteration goes on below roundoff; see `decline`.
    unbiased: bool,
    /// A planted fault, and the impulses that it carries over.
    fault: Option<Fault>,
    carried: Option<Vec<Wrench>>,
    /// What a round of the iteration left of a residual when that was last seen, over the step, 1/s.
    contraction: f64,
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
        let rest = Trial { kick: Spatial::ZERO, motion: Motion::NONE, hm: Vector3::zeros(), s: Vector3::zeros() };
        let (bodies, pose) = bodies(system, state);
        let arms: f64 = nodes.iter().map(|node| node.mount.arm.norm().max(node.mount.parent_arm.norm())).sum();
        let length = if arms > 0.0 { arms / (n - 1) as f64 } else { 1.0 };
        let rows = &system.parts;
        let rows = !(rows.loops.is_empty() && rows.couplings.is_empty() && rows.point_springs.is_empty());
        light::mark(&mut nodes, length, !rows);
        let tree = Tree::new(&nodes);
        let implicit = forces.iter().any(JointForce::is_implicit).then(|| tree.clone());
        let sprung = implicit.is_some();
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
            openings: Openings::new(&nodes),
            wrench: vec![Spatial::ZERO; n],
            twist: vec![Spatial::ZERO; n],
            predictor: Predictor::new(n, if sprung { predictor::SPRUNG } else { predictor::FULL }),
            newton: Newton::new(n),
            time: Compensated::new(SVector::zeros()),
            length,
            tolerance: 0.0,
            unbiased: false,
            fault: None,
            carried: None,
            contraction: f64::INFINITY,
            rounds: 0,
            nodes,
        };
        rattle.place_joints();
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

    /// Lets the constraint iteration stop at a residual (m; angles times the mean length of a link) instead of at roundoff.
    /// That costs the long-time behaviour: the energy drifts by what the residuals leave out, always to the same side.
    pub fn with_tolerance(self, tolerance: f64) -> Rattle {
        Rattle { tolerance, ..self }
    }

    /// Goes on with the constraint iteration far below roundoff. What the last correction leaves has the same sign for many steps; where the
    /// method errs less than roundoff does, as at high order, that is what the energy drifts by. It takes two thirds as many rounds more.
    pub fn with_unbiased_roundoff(self) -> Rattle {
        Rattle { unbiased: true, ..self }
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
        self.forces.iter_mut().for_each(JointForce::end);
        if let Some(loops) = &mut self.loops {
            loops.record(time, h);
            loops.accept(time, RETURN);
        }
        self.kick_light(h);
        for block in blocks(1..self.nodes.len()) {
            for i in block.clone() {
                self.predictor.write(h, i, &self.pose[i], &self.wrench[i]);
            }
            for i in block.clone() {
                let (body, pose, trial) = (&mut self.bodies[i], &mut self.pose[i], &self.trial[i]);
                body.p.add(&trial.kick.linear); // (1)
                body.pi.add(&trial.kick.angular);
                body.x.add(&trial.motion.dx); // (2)
                // By the world vector with which the joints were measured: rounded apart from it, attitudes would leave positions behind.
                body.q.add(&(turn_less_one(&trial.motion.s) * Quaternion::from(pose.q)).coords);
                body.q.add(&norm_defect(&body.q));
                *pose = Pose::new(&body.x, body.q.value);
            }
            self.place_block(block);
        }
        self.predictor.advance(time);
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
            moment[i] += force * node.mount.arm.norm();
            moment[node.parent] += force * node.mount.parent_arm.norm();
        }
        let rate = |i: usize| {
            let node = &self.nodes[i];
            let inertia = node.inertia.max() + node.mass * node.mount.arm.norm_squared();
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
    let poses = state.bodies.iter().map(|b| Pose::new(&b.position.into(), b.attitude.coords));
    (std::iter::once(ground).chain(moving).collect(), std::iter::once(Pose::GROUND).chain(poses).collect())
}

/// Nodes that stay in the nearest cache while one loop after another goes over them. One loop that did all for a node would read
/// what it has just written before the processor has put it together.
const BLOCK: usize = 8;

/// A range in blocks, in order.
fn blocks(range: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    range.clone().step_by(BLOCK).map(move |start| start..range.end.min(start + BLOCK))
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

/// Gravity in a half kick.
struct Gravity {
    /// s
    time: f64,
    /// m/s^2
    field: Vector3<f64>,
}

impl Gravity {
    #[inline(always)]
    fn impulse(&self, mass: f64) -> Vector3<f64> {
        self.time * mass * self.field
    }
}

/// (1) for joint `i` and its body, after the parent's.
#[inline(always)]
fn kick_joint(trial: &mut [Trial], nodes: &[Node], places: &[Place], i: usize, gravity: &Gravity, wrench: &Wrench) {
    trial[i].kick = Spatial::new(gravity.impulse(nodes[i].mass), Vector3::zeros());
    add_joint_impulse(trial, nodes, places, i, wrench);
}

/// What a quaternion lacks to have length one, to first order. A length off by roundoff scales the attitude matrix, and so all
/// momenta in body axes, and wanders: order 8 on a double pendulum loses a factor 7 in energy over 170 000 steps to it.
///
/// The length is that of the whole sum and known far below roundoff. Rounding at 1 is finer below than above, and a defect
/// measured so goes into the energy with one sign: a pendulum that spins at 12 rad/s lost 6e-21 of its scale a solve at 8 ms.
#[inline(always)]
pub(super) fn norm_defect(q: &Compensated<4>) -> Vector4<f64> {
    // Adding and subtracting it leaves multiples of 2^-26, whose squares add up without rounding.
    const COARSE: f64 = 1.5 * (1_u64 << 26) as f64;
    let high = q.value.map(|component| (component + COARSE) - COARSE);
    let low = q.value - high;
    let excess = (high.norm_squared() - 1.0) + low.dot(&(2.0 * high + low)) + 2.0 * q.value.dot(q.rest());
    q.value * (-0.5 * excess)
}

/// The unit quaternion of `F(s)` less one, without cancellation for small `s`: with `c = 1 / sqrt(1 + |s|^2)` its scalar part is
/// `c - 1 = -|s|^2 c^2 / (1 + c)` and its vector part `s + (c - 1) s`. The product `c s` would have the rounding of `c`, which below 1
/// has one sign for small `s`.
#[inline(always)]
pub(super) fn turn_less_one(s: &Vector3<f64>) -> Quaternion<f64> {
    let square = s.norm_squared();
    let c = 1.0 / (1.0 + square).sqrt();
    let scalar = -square * c * c / (1.0 + c);
    Quaternion::from_parts(scalar, s + scalar * s)
}
