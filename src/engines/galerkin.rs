//! The Galerkin variational integrator in joint coordinates as an engine.

use super::engine::{Engine, StepFailure, Unsupported};
use super::entry::{Entry, is_converged, usual_cost};
use super::joint_coordinates::{GROUP, PARTS};
use super::key::{Key, Number};
use super::line_up::{Colour, Contestant, Look, Marker, Role};
use super::swept::{GALERKIN_STEPS, LONG_STEPS, LONGEST_STEPS, QUICK_GALERKIN_STEPS, QUICK_LONG_STEPS, Swept};
use super::values::Values;
use crate::mechanics::{State, System};
use crate::reduced::Model;
use crate::reduced::galerkin::{Failure, Galerkin};

static STAGES: Number = Number {
    name: "stages",
    min: 2.0,
    max: 8.0,
    default: 4.0,
    whole: true,
    summary: "Gauss points a step; the order is twice their number",
};

pub(super) const ENTRY: Entry = Entry {
    name: "galerkin",
    summary: "Galerkin variational integrator (Gauss collocation) on joint coordinates: symplectic, time-reversible",
    keys: &[Key::Number(&STAGES)],
    parts: PARTS,
    group: &GROUP,
    contestants: &[Contestant {
        spec: "galerkin",
        roles: &[Role::Compare, Role::Cost],
        look: Some(Look { colour: Colour::Sky, marker: Marker::Diamond }),
    }],
    tuned: None,
    sweep: &[
        Swept::full("galerkin:stages=2", LONG_STEPS),
        Swept::full("galerkin:stages=3", LONGEST_STEPS),
        Swept::both("galerkin", LONGEST_STEPS, QUICK_LONG_STEPS),
        Swept::both("galerkin:stages=6", GALERKIN_STEPS, QUICK_GALERKIN_STEPS),
        Swept::both("galerkin:stages=8", GALERKIN_STEPS, QUICK_GALERKIN_STEPS),
    ],
    tolerance: None,
    nominal_cost: usual_cost,
    hold: None,
    converged: is_converged,
    crates: &[],
    build,
};

fn build(spec: &Values, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    let galerkin = Galerkin::new(Model::new(system), spec.number(&STAGES) as usize, step, system.energy_scale)
        .map_err(|failure| Unsupported { engine: spec.to_string(), what: describe(failure, 0.0, step) })?;
    Ok(Box::new(GalerkinEngine { galerkin, step, taken: 0 }))
}

struct GalerkinEngine {
    galerkin: Galerkin,
    step: f64,
    taken: u64,
}

impl Engine for GalerkinEngine {
    fn step(&mut self) -> Result<(), StepFailure> {
        self.galerkin.step().map_err(|failure| {
            let detail = describe(failure, self.taken as f64 * self.step, self.step);
            match failure {
                Failure::NotConverged { .. } => StepFailure::NotConverged { detail },
                Failure::RanAway { .. } | Failure::Singular => StepFailure::Diverged { detail },
            }
        })?;
        self.taken += 1;
        Ok(())
    }

    fn write_state(&self, out: &mut State) {
        self.galerkin.write_state(out);
    }
}

fn describe(failure: Failure, time: f64, step: f64) -> String {
    match failure {
        Failure::NotConverged { rounds, correction } => format!(
            "t = {time:.6} s: the stages do not converge in {rounds} rounds at a step of {step} s (last correction \
             {correction:.1e} of the scene's velocities), nor by Newton's method; take a smaller step"
        ),
        Failure::RanAway { rounds } => format!(
            "t = {time:.6} s: the stages run away after {rounds} rounds at a step of {step} s, and Newton's method \
             does not find them either; take a smaller step"
        ),
        Failure::Singular => format!(
            "t = {time:.6} s: a joint can move without moving any mass, or the stages run away at once at a step of \
             {step} s"
        ),
    }
}
