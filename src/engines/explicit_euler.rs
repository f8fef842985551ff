//! Explicit Euler in joint coordinates: a negative control, whose energy grows without bound.
//!
//! ```text
//! q1 = q0 moved by h v0 ,     v1 = v0 + h a(q0, v0)
//! ```

use super::engine::{Engine, StepFailure, Unsupported};
use super::entry::{Entry, is_converged, usual_cost};
use super::joint_coordinates::{GROUP, JointCoordinates, PARTS};
use super::line_up::{Contestant, Role};
use super::swept::{SHORT_STEPS, Swept};
use super::values::Values;
use crate::mechanics::{State, System};

pub(super) const ENTRY: Entry = Entry {
    name: "explicit_euler",
    summary: "explicit Euler on joint coordinates: order 1, gains energy; a control that every bound must catch",
    keys: &[],
    parts: PARTS,
    group: &GROUP,
    contestants: &[Contestant { spec: "explicit_euler", roles: &[Role::Control], look: None }],
    tuned: None,
    sweep: &[Swept::full("explicit_euler", SHORT_STEPS)],
    tolerance: None,
    nominal_cost: usual_cost,
    hold: None,
    converged: is_converged,
    crates: &[],
    build,
};

fn build(spec: &Values, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    let state = JointCoordinates::new(spec, system, step)?;
    Ok(Box::new(ExplicitEuler { a: vec![0.0; state.velocities()], state }))
}

struct ExplicitEuler {
    state: JointCoordinates,
    a: Vec<f64>,
}

impl Engine for ExplicitEuler {
    fn step(&mut self) -> Result<(), StepFailure> {
        self.state.accelerations(&mut self.a)?;
        self.state.drift();
        self.state.kick(&self.a);
        self.state.finish()
    }

    fn write_state(&self, out: &mut State) {
        self.state.write_state(out);
    }
}
