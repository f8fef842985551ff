//! The parts of the integrator.
//!
//! Arrays run over the nodes: index 0 is the ground, node `i` is body `i - 1` with its joint.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::mechanics::{BodyState, State, System};
use crate::numeric::{Compensated, Compensated3};
use crate::variational::chain::{JointFrame, Motion, Node, Pose};
use crate::variational::closing::counters::Counters;
use crate::variational::force::Parts;
use crate::variational::method::Method;
use crate::variational::predictor::Predictor;
use crate::variational::rotation::Rotation;
use crate::variational::tree::Tree;
use crate::variational::tree::newton::Newton;
use crate::variational::tree::spatial::{Spatial, Twist, Wrench};

/// The integrator: a system, its state, and room for a step. Nothing is allocated after [`Rattle::new`].
#[derive(Clone, Debug)]
pub struct Rattle {
    pub(in crate::variational) chain: Chain,
    pub(in crate::variational) now: Present,
    pub(in crate::variational) trial: Trial,
    pub(in crate::variational) memory: Memory,
    pub(in crate::variational) settings: Settings,
    /// What acts beside gravity and the joints of a tree; `None` for a plain chain.
    pub(in crate::variational) parts: Option<Box<Parts>>,
}

/// The bodies and their joints, and gravity. Constant over a run.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Chain {
    pub nodes: Vec<Node>,
    /// m/s^2
    pub gravity: Vector3<f64>,
    /// A length of the system, which weighs angles against positions, m.
    pub length: f64,
}

/// The state between two steps, `(q0, p0)`, and what was made of its configuration.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Present {
    /// Time since the start, s.
    pub time: Compensated<1>,
    pub bodies: Vec<Body>,
    /// The configuration, the joints' frames in it, and its factorisation.
    pub pose: Vec<Pose>,
    pub frames: Vec<JointFrame>,
    pub tree: Tree,
    /// The part of the joints' mismatch there that the next step takes away.
    pub gap0: Vec<Twist>,
    /// Twists at the joint points after the last projection.
    pub twist: Vec<Twist>,
}

/// Position and momentum of a body, as running compensated sums.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct Body {
    pub x: Compensated3,
    pub q: Compensated<4>,
    /// Linear momentum, kg m/s.
    pub p: Compensated3,
    /// Spin angular momentum, world axes, kg m^2/s.
    pub pi: Compensated3,
}

/// The step that is being tried.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Trial {
    pub bodies: Vec<BodyTrial>,
    /// Impulse on the child at its joint point over the half kick, `h/2 lambda`.
    pub wrench: Vec<Wrench>,
    /// What each joint does not allow in the configuration that is being tried, over `-h`.
    pub bias: Vec<Twist>,
    pub newton: Newton,
}

/// A body in the step that is being tried.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct BodyTrial {
    /// Impulse of the half kick on the body about its centre of mass: gravity and joints.
    pub kick: Wrench,
    /// Change of position and attitude over the step.
    pub motion: Motion,
    /// `h m0` and its solution `s` of the rotation rule; the next solution starts from them.
    pub hm: Vector3<f64>,
    pub s: Vector3<f64>,
}

/// What is carried from step to step beside the state: it changes what a step costs.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Memory {
    pub predictor: Predictor,
    /// What a round of the iteration left of a residual when that was last seen, over the step, 1/s.
    pub contraction: f64,
    pub counters: Counters,
    /// How each body turns, and the bodies that went over to the splitting, with the time, s.
    pub rules: Vec<Rotation>,
    pub switched: Vec<(usize, f64)>,
}

/// What the user has chosen.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct Settings {
    pub method: Method,
    /// Whether a body for which Moser-Veselov has no solution goes over to the splitting.
    pub automatic: bool,
    /// The residual at which the constraint iteration may stop, m; 0 for roundoff.
    pub tolerance: f64,
    /// Whether the iteration goes on below roundoff.
    pub unbiased: bool,
}

impl Memory {
    pub(super) fn copy_from(&mut self, other: &Memory) {
        self.predictor.copy_from(&other.predictor);
        (self.contraction, self.counters) = (other.contraction, other.counters);
        self.rules.copy_from_slice(&other.rules);
        self.switched.clear();
        self.switched.extend_from_slice(&other.switched);
    }
}

impl Trial {
    pub(super) fn new(nodes: &[Node]) -> Trial {
        let n = nodes.len();
        let rest = BodyTrial { kick: Spatial::ZERO, motion: Motion::NONE, hm: Vector3::zeros(), s: Vector3::zeros() };
        Trial {
            bodies: vec![rest; n],
            wrench: vec![Spatial::ZERO; n],
            bias: vec![Spatial::ZERO; n],
            newton: Newton::new(nodes),
        }
    }
}

impl Present {
    /// Writes the poses, and the twists that fit the joints.
    pub(super) fn write(&self, out: &mut State) {
        for (i, b) in out.bodies.iter_mut().enumerate() {
            *b = self.bodies[i + 1].state(&self.twist[i + 1], &self.frames[i + 1]);
        }
    }
}

impl Body {
    /// The pose, and the twist that is known at the body's joint point.
    pub(in crate::variational) fn state(&self, at_joint: &Twist, frame: &JointFrame) -> BodyState {
        let twist = at_joint.twist_at(&-frame.arm);
        BodyState {
            position: self.x.value,
            attitude: UnitQuaternion::new_unchecked(Quaternion::from(self.q.value)),
            velocity: twist.linear,
            angular_velocity: twist.angular,
        }
    }
}

/// The bodies of a state behind one for the ground, and their poses.
pub(in crate::variational) fn bodies(system: &System, state: &State) -> (Vec<Body>, Vec<Pose>) {
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
