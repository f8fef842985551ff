//! Joint coordinates: forward kinematics and its inverse.
//!
//! With `T(theta)` the pose of the child's joint frame in the parent's joint frame, a body's pose is
//! `X_child = X_parent in_parent T(theta) in_child^-1`, and its twist at the origin of its joint frame is the parent's
//! twist there plus the relative twist `S thetadot`, where `S` picks the free components.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::{Body, BodyState, Closure, Joint, JointKind, State, System, constraint};
use crate::model::scene::LoopKind;

/// Positions and velocities of one joint; entries past its degrees of freedom are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointCoordinates {
    /// m and rad, in the order of [`JointKind`].
    pub position: [f64; 6],
    /// m/s and rad/s
    pub velocity: [f64; 6],
}

impl JointKind {
    /// Pose of the child's joint frame in the parent's at the given coordinates.
    pub fn transform(self, position: &[f64; 6]) -> Isometry3<f64> {
        let [a, b, c, d, e, f] = *position;
        let about_z = |angle| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        match self {
            JointKind::Revolute => Isometry3::from_parts(Translation3::identity(), about_z(a)),
            JointKind::Prismatic => Isometry3::translation(0.0, 0.0, a),
            JointKind::Planar => Isometry3::from_parts(Translation3::new(a, b, 0.0), about_z(c)),
            JointKind::Spherical => Isometry3::rotation(Vector3::new(a, b, c)),
            JointKind::Floating => Isometry3::new(Vector3::new(a, b, c), Vector3::new(d, e, f)),
        }
    }

    /// The relative twist (linear, angular; axes of the parent's joint frame) of the given coordinate velocities.
    fn relative_twist(self, velocity: &[f64; 6]) -> (Vector3<f64>, Vector3<f64>) {
        let mut twist = [0.0; 6];
        let free = self.free();
        for (value, slot) in velocity.iter().zip((0..6).filter(|&i| free[i])) {
            twist[slot] = *value;
        }
        (Vector3::new(twist[0], twist[1], twist[2]), Vector3::new(twist[3], twist[4], twist[5]))
    }

    /// The coordinates of a relative pose, and what of it the joint does not allow: a length in m and an angle in rad
    /// for each of the three axes.
    fn decompose(self, relative: &Isometry3<f64>) -> ([f64; 6], [f64; 6]) {
        let t = relative.translation.vector;
        let q = relative.rotation;
        match self {
            JointKind::Revolute => {
                let (angle, tilt) = about_z(&q);
                ([angle, 0., 0., 0., 0., 0.], [t.x, t.y, t.z, tilt[0], tilt[1], 0.])
            }
            JointKind::Prismatic => {
                let r = q.scaled_axis();
                ([t.z, 0., 0., 0., 0., 0.], [t.x, t.y, 0., r.x, r.y, r.z])
            }
            JointKind::Planar => {
                let (angle, tilt) = about_z(&q);
                ([t.x, t.y, angle, 0., 0., 0.], [0., 0., t.z, tilt[0], tilt[1], 0.])
            }
            JointKind::Spherical => {
                let r = q.scaled_axis();
                ([r.x, r.y, r.z, 0., 0., 0.], [t.x, t.y, t.z, 0., 0., 0.])
            }
            JointKind::Floating => {
                let r = q.scaled_axis();
                ([t.x, t.y, t.z, r.x, r.y, r.z], [0.; 6])
            }
        }
    }

    /// Positions of the coordinates that are angles about one axis and so can be unwrapped.
    fn angle_index(self) -> Option<usize> {
        match self {
            JointKind::Revolute => Some(0),
            JointKind::Planar => Some(2),
            JointKind::Prismatic | JointKind::Spherical | JointKind::Floating => None,
        }
    }
}

/// Splits a rotation into one about z by an angle in (-pi, pi] and the tilt of the z axis (rotation vector, x and y).
fn about_z(q: &UnitQuaternion<f64>) -> (f64, [f64; 2]) {
    let angle = 2.0 * q.k.atan2(q.w);
    let wrapped = if angle > std::f64::consts::PI {
        angle - TAU
    } else if angle <= -std::f64::consts::PI {
        angle + TAU
    } else {
        angle
    };
    // q = q_tilt q_z, where q_tilt has no z part: its vector part is (x w - y z, y w + x z) / |(w, z)|.
    let norm = q.k.hypot(q.w);
    if norm == 0.0 {
        return (wrapped, [std::f64::consts::PI, 0.0]);
    }
    let (sx, sy) = ((q.i * q.w - q.j * q.k) / norm, (q.j * q.w + q.i * q.k) / norm);
    let half_sine = sx.hypot(sy);
    let stretch = if half_sine > 0.0 { 2.0 * half_sine.atan2(norm) / half_sine } else { 2.0 };
    (wrapped, [stretch * sx, stretch * sy])
}

/// A joint between the state of its child and the state of its parent.
pub(super) struct Placed {
    /// Pose of the child's joint frame in the parent's joint frame.
    pub relative: Isometry3<f64>,
    /// Relative twist at the origin of the child's joint frame, axes of the parent's joint frame.
    pub twist: (Vector3<f64>, Vector3<f64>),
}

impl Placed {
    pub(super) fn new(joint: &Joint, child: &BodyState, parent: Option<&BodyState>) -> Placed {
        let child_arm = child.attitude * joint.in_child.translation.vector;
        let child_frame = child.attitude * joint.in_child.rotation;
        // Positions first, so that two bodies far from the origin subtract without loss.
        let (parent_frame, offset, parent_twist) = match parent {
            None => {
                let frame = joint.in_parent.rotation;
                (
                    frame,
                    child.position - joint.in_parent.translation.vector + child_arm,
                    (Vector3::zeros(), Vector3::zeros()),
                )
            }
            Some(p) => {
                let between = child.position - p.position;
                let offset = between - p.attitude * joint.in_parent.translation.vector + child_arm;
                let linear = p.velocity + p.angular_velocity.cross(&(between + child_arm));
                (p.attitude * joint.in_parent.rotation, offset, (linear, p.angular_velocity))
            }
        };
        let to_joint = parent_frame.inverse();
        let linear = child.velocity + child.angular_velocity.cross(&child_arm) - parent_twist.0;
        let angular = child.angular_velocity - parent_twist.1;
        Placed {
            relative: Isometry3::from_parts((to_joint * offset).into(), to_joint * child_frame),
            twist: (to_joint * linear, to_joint * angular),
        }
    }

    /// Coordinates with angles in (-pi, pi].
    pub(super) fn coordinates(&self, kind: JointKind) -> JointCoordinates {
        let free = kind.free();
        let (position, _) = kind.decompose(&self.relative);
        let twist = [self.twist.0.x, self.twist.0.y, self.twist.0.z, self.twist.1.x, self.twist.1.y, self.twist.1.z];
        let mut velocity = [0.0; 6];
        for (slot, i) in (0..6).filter(|&i| free[i]).enumerate() {
            velocity[slot] = twist[i];
        }
        JointCoordinates { position, velocity }
    }

    /// Largest component that the joint does not allow: of the pose (m, rad) and of the twist (m/s, rad/s).
    pub(super) fn residual(&self, kind: JointKind) -> (f64, f64) {
        let free = kind.free();
        let (_, locked) = kind.decompose(&self.relative);
        let twist = [self.twist.0.x, self.twist.0.y, self.twist.0.z, self.twist.1.x, self.twist.1.y, self.twist.1.z];
        let largest =
            |values: [f64; 6]| (0..6).filter(|&i| !free[i]).map(|i| values[i].abs()).fold(0.0, constraint::larger);
        (largest(locked), largest(twist))
    }
}

impl Closure {
    /// Which components of a relative twist (linear x, y, z, angular x, y, z) the closure does not allow.
    pub fn locked(&self) -> [bool; 6] {
        self.joint_kind().map_or([true; 6], |kind| kind.free().map(|free| !free))
    }

    /// What the closure does not allow of the relative pose (m, rad) and of the relative twist (m/s, rad/s): the
    /// [`Closure::locked`] components, in the axes of the parent's joint frame.
    pub fn residual(&self, state: &State) -> (Vec<f64>, Vec<f64>) {
        let body = |index: Option<usize>| index.map_or(BodyState::ground(), |b| state.bodies[b]);
        let joint = Joint {
            name: self.name.clone(),
            kind: self.joint_kind().unwrap_or(JointKind::Floating),
            parent: self.parent,
            in_parent: self.in_parent,
            in_child: self.in_child,
            damping: 0.0,
        };
        let placed = Placed::new(&joint, &body(self.child), self.parent.map(|p| &state.bodies[p]));
        let pose = match self.joint_kind() {
            Some(kind) => kind.decompose(&placed.relative).1,
            None => position_and_rotation(&placed.relative),
        };
        let (v, w) = placed.twist;
        let twist = [v.x, v.y, v.z, w.x, w.y, w.z];
        let locked = self.locked();
        let pick = |values: [f64; 6]| (0..6).filter(|&i| locked[i]).map(|i| values[i]).collect();
        (pick(pose), pick(twist))
    }

    /// The joint that leaves the same motions free; `None` where it leaves none.
    fn joint_kind(&self) -> Option<JointKind> {
        match self.kind {
            LoopKind::Revolute => Some(JointKind::Revolute),
            LoopKind::Prismatic => Some(JointKind::Prismatic),
            LoopKind::Spherical => Some(JointKind::Spherical),
            LoopKind::Fixed => None,
        }
    }
}

/// A relative pose as a position and a rotation vector.
fn position_and_rotation(relative: &Isometry3<f64>) -> [f64; 6] {
    let (t, r) = (relative.translation.vector, relative.rotation.scaled_axis());
    [t.x, t.y, t.z, r.x, r.y, r.z]
}

/// The state at given joint coordinates, one entry a body.
pub fn forward_kinematics(bodies: &[Body], coordinates: &[JointCoordinates]) -> State {
    let mut states: Vec<BodyState> = Vec::with_capacity(bodies.len());
    for (body, theta) in bodies.iter().zip(coordinates) {
        let joint = &body.joint;
        let ground = BodyState::ground();
        let parent = joint.parent.map_or(&ground, |p| &states[p]);
        let parent_frame = parent.pose() * joint.in_parent;
        let child_frame = parent_frame * joint.kind.transform(&theta.position);
        let pose = child_frame * joint.in_child.inverse();
        let (linear, angular) = joint.kind.relative_twist(&theta.velocity);
        let origin = child_frame.translation.vector;
        let angular_velocity = parent.angular_velocity + parent_frame.rotation * angular;
        let velocity = parent.velocity
            + parent.angular_velocity.cross(&(origin - parent.position))
            + parent_frame.rotation * linear
            + angular_velocity.cross(&(pose.translation.vector - origin));
        states.push(BodyState {
            position: pose.translation.vector,
            attitude: pose.rotation,
            velocity,
            angular_velocity,
        });
    }
    State { bodies: states }
}

/// The coordinates of every joint, angles in (-pi, pi]; what a joint does not allow is left out.
pub fn joint_coordinates(system: &System, state: &State, out: &mut [JointCoordinates]) {
    for (i, body) in system.bodies.iter().enumerate() {
        let parent = body.joint.parent.map(|p| &state.bodies[p]);
        out[i] = Placed::new(&body.joint, &state.bodies[i], parent).coordinates(body.joint.kind);
    }
}

/// Follows the joint coordinates of a run so that angles are unwrapped: a hinge that turned twice reads 4 pi.
///
/// Between two calls a hinge may turn any number of times as long as its mean velocity, taken as the mean of the
/// velocities at the two ends, predicts the angle to within half a turn. Rotation vectors are not unwrapped.
#[derive(Clone, Debug)]
pub struct CoordinateTracker {
    pub joints: Vec<JointCoordinates>,
}

impl CoordinateTracker {
    /// Starts at the coordinates that the scene gave, so that a joint that starts at 7 rad reads 7 rad.
    pub fn new(system: &System) -> CoordinateTracker {
        CoordinateTracker { joints: system.initial_coordinates.clone() }
    }

    /// Takes in the state a time `elapsed` (s) after the last one.
    pub fn update(&mut self, system: &System, state: &State, elapsed: f64) {
        for (i, body) in system.bodies.iter().enumerate() {
            let parent = body.joint.parent.map(|p| &state.bodies[p]);
            let mut now = Placed::new(&body.joint, &state.bodies[i], parent).coordinates(body.joint.kind);
            if let Some(k) = body.joint.kind.angle_index() {
                let before = &self.joints[i];
                let predicted = before.position[k] + 0.5 * elapsed * (before.velocity[k] + now.velocity[k]);
                let turns = ((predicted - now.position[k]) / TAU).round();
                if turns.is_finite() {
                    now.position[k] += TAU * turns;
                }
            }
            self.joints[i] = now;
        }
    }
}
