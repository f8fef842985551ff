//! Joint coordinates: forward kinematics and its inverse.
//!
//! With `T(theta)` the pose of the child's joint frame in the parent's joint frame, a body's pose is
//! `X_child = X_parent in_parent T(theta) in_child^-1`, and its twist at the origin of its joint frame is the parent's
//! twist there plus the relative twist `S thetadot`, where `S` picks the free components.

use std::f64::consts::TAU;

use super::body::Body;
pub use super::joint::JointCoordinates;
use super::relative::RelativeMotion;
use super::state::{BodyState, State};
use super::system::System;

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
        out[i] = RelativeMotion::new(&body.joint, &state.bodies[i], parent).coordinates(body.joint.kind);
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
            let mut now = RelativeMotion::new(&body.joint, &state.bodies[i], parent).coordinates(body.joint.kind);
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
