//! What a system has beside its tree of bodies: loop closures, couplings, springs and drives.

use nalgebra::Vector3;

use super::closure::Closure;
use super::state::State;

/// All of them.
#[derive(Clone, Debug, Default)]
pub struct Parts {
    pub loops: Vec<Closure>,
    pub couplings: Vec<Coupling>,
    pub joint_springs: Vec<JointSpring>,
    pub point_springs: Vec<PointSpring>,
    pub drives: Vec<Drive>,
}

/// A joint that follows another one (URDF `<mimic>`): `theta(follower) = multiplier theta(source) + offset`. Both have
/// one coordinate; joints are named by the index of their child body.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupling {
    pub follower: usize,
    pub source: usize,
    pub multiplier: f64,
    /// rad or m
    pub offset: f64,
}

/// A spring with a damper beside it in a joint of one coordinate: effort
/// `-stiffness (theta - rest) - damping thetadot`.
#[derive(Clone, Debug, PartialEq)]
pub struct JointSpring {
    /// Index of the joint's child body.
    pub body: usize,
    /// N m/rad or N/m
    pub stiffness: f64,
    /// N m s/rad or N s/m
    pub damping: f64,
    /// rad or m
    pub rest: f64,
}

/// A spring with a damper beside it between two points at the distance `d`: the force
/// `stiffness (d - rest_length) + damping d(d)/dt` pulls them together.
#[derive(Clone, Debug, PartialEq)]
pub struct PointSpring {
    pub from: Anchor,
    pub to: Anchor,
    /// N/m
    pub stiffness: f64,
    /// N s/m
    pub damping: f64,
    /// m
    pub rest_length: f64,
}

/// A point fixed in a body; `None` is the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Anchor {
    pub body: Option<usize>,
    /// In the body's frame (in the world for the ground), m.
    pub point: Vector3<f64>,
}

impl Anchor {
    /// Where the point is, m, world axes.
    pub fn position(&self, state: &State) -> Vector3<f64> {
        self.body.map_or(self.point, |b| state.bodies[b].position + state.bodies[b].attitude * self.point)
    }

    /// How fast the point moves, m/s, world axes.
    pub fn velocity(&self, state: &State) -> Vector3<f64> {
        self.body.map_or(Vector3::zeros(), |b| {
            let body = &state.bodies[b];
            body.velocity + body.angular_velocity.cross(&(body.attitude * self.point))
        })
    }
}

impl PointSpring {
    /// From the first point to the second, m, world axes, and its rate of change, m/s.
    pub fn line(&self, state: &State) -> (Vector3<f64>, Vector3<f64>) {
        let line = self.to.position(state) - self.from.position(state);
        (line, self.to.velocity(state) - self.from.velocity(state))
    }

    /// Distance of the points, m, and its rate of change, m/s (0 where they coincide).
    pub fn distance(&self, state: &State) -> (f64, f64) {
        let (line, rate) = self.line(state);
        let distance = line.norm();
        (distance, if distance > 0.0 { line.dot(&rate) / distance } else { 0.0 })
    }
}

/// Effort `effort + amplitude sin(angular_frequency t + phase)` in a joint of one coordinate, N m or N.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// Index of the joint's child body.
    pub body: usize,
    pub effort: f64,
    pub amplitude: f64,
    /// rad/s
    pub angular_frequency: f64,
    /// rad
    pub phase: f64,
}

impl Drive {
    /// Effort at a time (s) since the start.
    pub fn at(&self, time: f64) -> f64 {
        self.effort + self.amplitude * (self.angular_frequency * time + self.phase).sin()
    }
}

/// A kind of part that an engine may or may not have means for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Loops,
    Mimics,
    JointSprings,
    PointSprings,
    Drives,
}

impl Part {
    /// In words, for messages.
    pub const fn name(self) -> &'static str {
        match self {
            Part::Loops => "loops",
            Part::Mimics => "mimic joints",
            Part::JointSprings => "joint springs",
            Part::PointSprings => "springs between points",
            Part::Drives => "drives",
        }
    }
}

impl Parts {
    /// The kinds of parts that there are.
    pub fn kinds(&self) -> impl Iterator<Item = Part> {
        [
            (Part::Loops, self.loops.len()),
            (Part::Mimics, self.couplings.len()),
            (Part::JointSprings, self.joint_springs.len()),
            (Part::PointSprings, self.point_springs.len()),
            (Part::Drives, self.drives.len()),
        ]
        .into_iter()
        .filter_map(|(part, count)| (count > 0).then_some(part))
    }
}
