//! How far joints are from holding, in position and velocity.

use super::closure::Closure;
use super::joint::JointCoordinates;
use super::parts::Coupling;
use super::relative::RelativeMotion;
use super::state::State;
use super::system::System;
use crate::numeric::larger;

/// The largest joint residuals of a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Largest component of a relative pose that a joint does not allow, m or rad.
    pub position: f64,
    /// Largest component of a relative twist that a joint does not allow, m/s or rad/s.
    pub velocity: f64,
}

/// The residual of one joint, named by the index of its child body.
pub fn joint_residual(system: &System, state: &State, body: usize) -> Residual {
    let joint = &system.bodies[body].joint;
    let parent = joint.parent.map(|p| &state.bodies[p]);
    let (position, velocity) = RelativeMotion::new(joint, &state.bodies[body], parent).residual(joint.kind);
    Residual { position, velocity }
}

/// The residual of a loop closure.
pub(crate) fn loop_residual(closure: &Closure, state: &State) -> Residual {
    let (position, velocity) = closure.residual(state);
    let largest = |values: Vec<f64>| values.into_iter().map(f64::abs).fold(0.0, larger);
    Residual { position: largest(position), velocity: largest(velocity) }
}

/// The residual of a coupling at unwrapped joint coordinates.
pub(crate) fn coupling_residual(coupling: &Coupling, joints: &[JointCoordinates]) -> Residual {
    let (follower, source) = (&joints[coupling.follower], &joints[coupling.source]);
    let position = follower.position[0] - coupling.multiplier * source.position[0] - coupling.offset;
    let velocity = follower.velocity[0] - coupling.multiplier * source.velocity[0];
    Residual { position: position.abs(), velocity: velocity.abs() }
}

/// The largest residual over all joints and loops. NaN where any is.
pub fn residual(system: &System, state: &State) -> Residual {
    let joints = (0..system.bodies.len()).map(|i| joint_residual(system, state, i));
    let loops = system.parts.loops.iter().map(|closure| loop_residual(closure, state));
    joints.chain(loops).fold(Residual::NONE, Residual::larger)
}

/// The largest residual over all joints, loops and couplings. `joints` are unwrapped coordinates of the state.
pub fn residual_with_couplings(system: &System, state: &State, joints: &[JointCoordinates]) -> Residual {
    let couplings = system.parts.couplings.iter().map(|coupling| coupling_residual(coupling, joints));
    couplings.fold(residual(system, state), Residual::larger)
}

impl Residual {
    const NONE: Residual = Residual { position: 0.0, velocity: 0.0 };

    /// The larger of each figure; NaN where one is.
    fn larger(self, other: Residual) -> Residual {
        Residual { position: larger(self.position, other.position), velocity: larger(self.velocity, other.velocity) }
    }
}
