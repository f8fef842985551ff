//! The variational RATTLE core as an engine.

use super::{Choice, Engine, Entry, Key, Spec, StepFailure, Unsupported};
use crate::mechanics::{Part, State, System};
use crate::variational::composition;
use crate::variational::{Failure, Rattle, Rotation};

static ORDER: Choice = Choice {
    name: "order",
    words: &["2", "4", "6", "8"],
    summary: "order of the symmetric composition of RATTLE steps: 1, 5, 13 or 17 of them a step",
};

static ROTATION: Choice = Choice {
    name: "rotation",
    words: &["moser_veselov", "cayley"],
    summary: "how bodies turn: RATTLE proper, for less than about 1 rad a step, or a rule without that limit",
};

pub(super) const ENTRY: Entry = Entry {
    name: "rattle",
    summary: "variational RATTLE with holonomic joint constraints: symplectic, time-reversible",
    keys: &[Key::Choice(&ORDER), Key::Choice(&ROTATION)],
    parts: &[Part::Loops, Part::Mimics, Part::PointSprings],
    build,
};

fn build(spec: &Spec, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    let names = Names::of(system);
    let order = spec.word(&ORDER);
    let composition =
        composition::ALL.iter().find(|c| c.order.to_string() == order).copied().unwrap_or(composition::ORDER_2);
    if let Some(body) = system.bodies.iter().find(|b| b.joint.damping > 0.0 && composition.stages() > 1) {
        return Err(Unsupported {
            engine: spec.to_string(),
            what: format!(
                "damping (joint '{}') at order {order}: a composition of order above 2 has backward substeps, in which a \
                 damper would give energy; use order=2",
                body.joint.name
            ),
        });
    }
    let rattle = Rattle::new(system)
        .map_err(|failure| Unsupported { engine: spec.to_string(), what: describe(failure, 0.0, step, &names) })?;
    let rotation = match spec.word(&ROTATION) {
        "cayley" => Rotation::Cayley,
        _ => Rotation::MoserVeselov,
    };
    let rattle = rattle.with_rotation(rotation);
    let substeps = composition.weights().map(|w| w * step).collect();
    Ok(Box::new(RattleEngine {
        rattle,
        substeps,
        step,
        taken: 0,
        names,
        before: system.initial.clone(),
        failed: false,
    }))
}

/// A composition of RATTLE steps at a fixed step.
struct RattleEngine {
    rattle: Rattle,
    substeps: Vec<f64>,
    step: f64,
    taken: u64,
    names: Names,
    /// The state before the present step, which stands after one of several substeps has failed.
    before: State,
    failed: bool,
}

impl Engine for RattleEngine {
    fn step(&mut self) -> Result<(), StepFailure> {
        if self.substeps.len() > 1 {
            self.rattle.write_state(&mut self.before);
        }
        for (k, substep) in self.substeps.iter().enumerate() {
            if let Err(failure) = self.rattle.step(*substep) {
                self.failed = k > 0;
                let detail = describe(failure, self.taken as f64 * self.step, self.step, &self.names);
                return Err(match failure {
                    Failure::NotFinite { .. } => StepFailure::Diverged { detail },
                    _ => StepFailure::NotConverged { detail },
                });
            }
        }
        self.taken += 1;
        Ok(())
    }

    fn write_state(&self, out: &mut State) {
        if self.failed {
            out.clone_from(&self.before);
        } else {
            self.rattle.write_state(out);
        }
    }
}

/// What failures are named by.
struct Names {
    bodies: Vec<String>,
    joints: Vec<String>,
    /// Loops, then couplings, then springs between points.
    bonds: Vec<String>,
}

impl Names {
    fn of(system: &System) -> Names {
        let parts = &system.parts;
        let joint = |body: usize| &system.bodies[body].joint.name;
        let loops = parts.loops.iter().map(|closure| format!("loop '{}'", closure.name));
        let couplings = parts.couplings.iter().map(|c| format!("the mimic of joint '{}'", joint(c.follower)));
        let springs = (0..parts.point_springs.len()).map(|i| format!("spring {i} between points"));
        Names {
            bodies: system.bodies.iter().map(|b| b.name.clone()).collect(),
            joints: system.bodies.iter().map(|b| b.joint.name.clone()).collect(),
            bonds: loops.chain(couplings).chain(springs).collect(),
        }
    }
}

/// A failure with names, time and remedy.
fn describe(failure: Failure, time: f64, step: f64, names: &Names) -> String {
    match failure {
        Failure::Rotation { body, angle } => format!(
            "t = {time:.6} s: body '{}' turns by h |Omega| = {angle:.3} rad in one step of {step} s, too far for the \
             Moser-Veselov equation; take a step below {:.1e} s, or rotation=cayley",
            names.bodies[body],
            0.5 * step / angle
        ),
        Failure::Constraint { joint, rounds, residual } => format!(
            "t = {time:.6} s: joint '{}' does not close after {rounds} rounds, residual {residual:.1e} m at a step of \
             {step} s; take a smaller step",
            names.joints[joint]
        ),
        Failure::Loop { index, rounds, residual } => format!(
            "t = {time:.6} s: {} does not close after {rounds} rounds, residual {residual:.1e} m at a step of {step} s, as \
             where it passes a singular configuration; take a smaller step",
            names.bonds[index]
        ),
        Failure::Leap { gained } => format!(
            "t = {time:.6} s: the linkage passes a singular configuration, where a step of {step} s would throw it onto another \
             branch with {gained:.2} of its kinetic energy from nowhere; take another step, or start it elsewhere"
        ),
        Failure::Singular { joint } => format!(
            "t = {time:.6} s: joint '{}' can move without moving any mass; give the links behind it mass and inertia",
            names.joints[joint]
        ),
        Failure::NotFinite { body } => {
            format!("t = {time:.6} s: the state of body '{}' is not a number at a step of {step} s", names.bodies[body])
        }
    }
}
