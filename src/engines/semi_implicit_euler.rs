//! Semi-implicit Euler in joint coordinates, as robotics engines take it.
//!
//! ```text
//! v1 = v0 + h a(q0, v0) ,     q1 = q0 moved by h v1
//! ```
//!
//! Order 1. It is the symplectic Euler method only where the mass matrix is constant: on velocities instead of momenta,
//! with a mass matrix that depends on the positions, it is not symplectic.

use super::engine::{Engine, StepFailure, Unsupported};
use super::entry::{Entry, is_converged};
use super::joint_coordinates::{GROUP, JointCoordinates, PARTS};
use super::line_up::{Colour, Contestant, Look, Marker, Role};
use super::swept::{SHORT_STEPS, Swept};
use super::values::Values;
use crate::mechanics::{State, System};

pub(super) const ENTRY: Entry = Entry {
    name: "semi_implicit_euler",
    summary: "semi-implicit Euler on joint coordinates, what robotics engines do: order 1, symplectic only at \
              constant mass matrix",
    keys: &[],
    parts: PARTS,
    group: &GROUP,
    contestants: &[Contestant {
        spec: "semi_implicit_euler",
        roles: &[Role::Cost, Role::Explicit, Role::Control],
        look: Some(Look { colour: Colour::Olive, marker: Marker::Circle }),
    }],
    tuned: None,
    sweep: &[Swept::full("semi_implicit_euler", SHORT_STEPS)],
    tolerance: None,
    nominal_cost: |_, bodies| 0.2 + 0.7 * bodies,
    hold: None,
    converged: is_converged,
    crates: &[],
    build,
};

fn build(spec: &Values, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    let state = JointCoordinates::new(spec, system, step)?;
    Ok(Box::new(SemiImplicitEuler { a: vec![0.0; state.velocities()], state }))
}

struct SemiImplicitEuler {
    state: JointCoordinates,
    a: Vec<f64>,
}

impl Engine for SemiImplicitEuler {
    fn step(&mut self) -> Result<(), StepFailure> {
        self.state.accelerations(&mut self.a)?;
        self.state.kick(&self.a);
        self.state.drift();
        self.state.finish()
    }

    fn write_state(&self, out: &mut State) {
        self.state.write_state(out);
    }
}
