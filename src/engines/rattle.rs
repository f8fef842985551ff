//! The variational RATTLE core as an engine.

use super::{Engine, Entry, Spec, StepFailure, Unsupported};
use crate::mechanics::{State, System};
use crate::variational::{Failure, Rattle};

pub(super) const ENTRY: Entry = Entry {
    name: "rattle",
    summary: "variational RATTLE with holonomic joint constraints: symplectic, time-reversible, order 2",
    keys: &[],
    build,
};

fn build(spec: &Spec, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    let names = |i: usize| (system.bodies[i].name.clone(), system.bodies[i].joint.name.clone());
    let rattle = Rattle::new(system)
        .map_err(|failure| Unsupported { engine: spec.to_string(), what: describe(failure, 0.0, step, &names) })?;
    let names = (0..system.bodies.len()).map(names).collect();
    Ok(Box::new(RattleEngine { rattle, step, taken: 0, names }))
}

/// RATTLE at a fixed step.
struct RattleEngine {
    rattle: Rattle,
    step: f64,
    taken: u64,
    /// Body and joint names, for failures.
    names: Vec<(String, String)>,
}

impl Engine for RattleEngine {
    fn step(&mut self) -> Result<(), StepFailure> {
        match self.rattle.step(self.step) {
            Ok(()) => {
                self.taken += 1;
                Ok(())
            }
            Err(failure) => {
                let detail = describe(failure, self.taken as f64 * self.step, self.step, &|i| self.names[i].clone());
                Err(match failure {
                    Failure::NotFinite { .. } => StepFailure::Diverged { detail },
                    _ => StepFailure::NotConverged { detail },
                })
            }
        }
    }

    fn write_state(&self, out: &mut State) {
        self.rattle.write_state(out);
    }
}

/// A failure with names, time and remedy. `names(i)` are those of body `i` and its joint.
fn describe(failure: Failure, time: f64, step: f64, names: &dyn Fn(usize) -> (String, String)) -> String {
    match failure {
        Failure::Rotation { body, angle } => format!(
            "t = {time:.6} s: body '{}' turns by h |Omega| = {angle:.3} rad in one step of {step} s, too far for the \
             Moser-Veselov equation; take a step below {:.1e} s",
            names(body).0,
            0.5 * step / angle
        ),
        Failure::Constraint { joint, rounds, residual } => format!(
            "t = {time:.6} s: joint '{}' does not close after {rounds} rounds, residual {residual:.1e} m at a step of \
             {step} s; take a smaller step",
            names(joint).1
        ),
        Failure::Singular { joint } => format!(
            "t = {time:.6} s: joint '{}' can move without moving any mass; give the links behind it mass and inertia",
            names(joint).1
        ),
        Failure::NotFinite { body } => {
            format!("t = {time:.6} s: the state of body '{}' is not a number at a step of {step} s", names(body).0)
        }
    }
}
