//! Semi-implicit Euler in joint coordinates, as robotics engines take it.
//!
//! ```text
//! v1 = v0 + h a(q0, v0) ,     q1 = q0 moved by h v1
//! ```
//!
//! Order 1. It is the symplectic Euler method only where the mass matrix is constant: on velocities instead of momenta, with
//! a mass matrix that depends on the positions, it is not symplectic.

use super::joint_coordinates::{JointCoordinates, PARTS};
use super::{Engine, Entry, Spec, StepFailure, Unsupported};
use crate::mechanics::{State, System};

pub(super) const ENTRY: Entry = Entry {
    name: "semi_implicit_euler",
    summary: "semi-implicit Euler on joint coordinates, what robotics engines do: order 1, symplectic only at constant mass matrix",
    keys: &[],
    parts: PARTS,
    build,
};

fn build(spec: &Spec, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
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
