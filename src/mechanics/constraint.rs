//! How far joints are from holding, in position and velocity.

use super::coordinates::Placed;
use super::{State, System};

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
    let (position, velocity) = Placed::new(joint, &state.bodies[body], parent).residual(joint.kind);
    Residual { position, velocity }
}

/// The largest residual over all joints. NaN where any is.
pub fn residual(system: &System, state: &State) -> Residual {
    (0..system.bodies.len()).map(|i| joint_residual(system, state, i)).fold(
        Residual { position: 0.0, velocity: 0.0 },
        |all, one| Residual {
            position: larger(all.position, one.position),
            velocity: larger(all.velocity, one.velocity),
        },
    )
}

/// The larger of two numbers; NaN where one is.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}
