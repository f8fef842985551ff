//! The variational RATTLE core as an engine.

use super::{Choice, Engine, Entry, Key, Number, Spec, StepFailure, Unsupported};
use crate::mechanics::{Body, Part, State, System};
use crate::variational::composition;
use crate::variational::lobatto::Unfit;
use crate::variational::{Failure, Fault, Lobatto, Method, Rattle, Rotation};

static ORDER: Choice = Choice {
    name: "order",
    words: &["2", "4", "6", "8"],
    summary: "order of the symmetric composition of RATTLE steps: 1, 5, 13 or 17 of them a step",
};

static ROTATION: Choice = Choice {
    name: "rotation",
    words: &["auto", "moser_veselov", "splitting", "cayley"],
    summary: "how bodies turn: moser_veselov is RATTLE proper, for less than about 1 rad a step, the others have no such \
              limit; auto moves a body from the first to splitting, once, when it turns too fast",
};

static METHOD: Choice = Choice {
    name: "method",
    words: &["rattle", "midpoint", "euler_a", "euler_b", "shake", "lobatto"],
    summary: "the map of one step: rattle, the same by the midpoint rule, the two symplectic Euler maps (order 1), rattle in \
              positions, or Lobatto IIIA-IIIB (order 2 stages - 2)",
};

static STAGES: Number = Number {
    name: "stages",
    min: 2.0,
    max: 5.0,
    default: 3.0,
    whole: true,
    summary: "stages of method=lobatto; with 2 it is rattle",
};

pub(super) const ENTRY: Entry = Entry {
    name: "rattle",
    summary: "variational RATTLE with holonomic joint constraints: symplectic, time-reversible",
    keys: &[Key::Choice(&ORDER), Key::Choice(&METHOD), Key::Number(&STAGES), Key::Choice(&ROTATION)],
    parts: &[Part::Loops, Part::Mimics, Part::JointSprings, Part::PointSprings, Part::Drives],
    build,
};

fn build(spec: &Spec, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    Ok(Box::new(engine(spec, system, step)?))
}

/// An engine `rattle` with a planted fault, for tests of what checks catch.
///
/// # Errors
/// As [`super::build`].
pub fn faulty(spec: &Spec, system: &System, step: f64, fault: Fault) -> Result<Box<dyn Engine>, Unsupported> {
    let sound = engine(spec, system, step)?;
    let core = match sound.core {
        Core::Rattle(rattle) => Core::Rattle(rattle.with_fault(fault)),
        Core::Lobatto(lobatto) => Core::Lobatto(lobatto),
    };
    Ok(Box::new(RattleEngine { core, ..sound }))
}

fn engine(spec: &Spec, system: &System, step: f64) -> Result<RattleEngine, Unsupported> {
    let unsupported = |what: String| Unsupported { engine: spec.to_string(), what };
    let order = spec.word(&ORDER);
    let composition =
        composition::ALL.iter().find(|c| c.order.to_string() == order).copied().unwrap_or(composition::ORDER_2);
    fits(spec, composition.stages() > 1, system).map_err(unsupported)?;
    let core = core(spec, system, step).map_err(unsupported)?;
    Ok(RattleEngine {
        core,
        substeps: composition.weights().map(|w| w * step).collect(),
        step,
        taken: 0,
        names: Names::of(system),
        before: system.initial.clone(),
        failed: false,
    })
}

/// Whether the settings go together, and with what the system has.
fn fits(spec: &Spec, composed: bool, system: &System) -> Result<(), String> {
    let (order, method) = (spec.word(&ORDER), spec.word(&METHOD));
    let lobatto = method == "lobatto";
    if !lobatto && spec.given(STAGES.name).is_some() {
        return Err(format!("stages with method={method}: only method=lobatto has stages"));
    }
    if lobatto && spec.given(ROTATION.name).is_some() {
        return Err("rotation with method=lobatto: its stages turn the bodies; leave rotation out".to_string());
    }
    if lobatto && spec.given(ORDER.name).is_some() {
        return Err("order with method=lobatto: its order is 2 stages - 2; set stages and leave order out".to_string());
    }
    if composed && method.starts_with("euler") {
        return Err(format!("order={order} with method={method}: only a time-reversible map can be composed to it"));
    }
    let plain = !matches!(method, "rattle" | "midpoint");
    if let Some(part) = system.parts.kinds().next().filter(|_| plain) {
        return Err(format!(
            "{} with method={method}, which knows the joints of a tree and their dampers only; use method=rattle",
            part.name()
        ));
    }
    let pointlike = |body: &&Body| body.mass == 0.0 || body.inertia.min() == 0.0;
    if let Some(body) = system.bodies.iter().find(pointlike).filter(|_| plain) {
        return Err(format!(
            "link '{}', which moves without inertia, with method={method}; use method=rattle",
            body.name
        ));
    }
    let rows = system.parts.kinds().any(|part| matches!(part, Part::Loops | Part::Mimics | Part::PointSprings));
    if let Some(body) = system.bodies.iter().find(|body| rows && body.inertia.max() == 0.0) {
        return Err(format!(
            "link '{}', which moves without moments of inertia, beside loops, mimic joints or springs between points; give \
             it an <inertia>",
            body.name
        ));
    }
    match system.first_damper() {
        Some(damper) if composed => Err(format!(
            "damping ({damper}) at order {order}: a composition of order above 2 has backward substeps, in which a damper \
             would give energy; use order=2"
        )),
        Some(damper) if lobatto => Err(format!(
            "damping ({damper}) with method=lobatto: its stages hold forces that have a potential only; use method=rattle"
        )),
        _ => Ok(()),
    }
}

fn core(spec: &Spec, system: &System, step: f64) -> Result<Core, String> {
    let names = Names::of(system);
    let failed = |failure| describe(failure, 0.0, step, &names);
    let method = match spec.word(&METHOD) {
        "lobatto" => {
            let lobatto = Lobatto::new(system, spec.number(&STAGES) as usize);
            return lobatto.map(Core::Lobatto).map_err(|unfit| match unfit {
                Unfit::Failure(failure) => failed(failure),
                Unfit::Damped { joint } => format!("damping (joint '{}') with method=lobatto", names.joints[joint]),
                Unfit::Flat { body, least } => format!(
                    "body '{}' with method=lobatto: its moments of inertia are those of a flat plate (J1 + J2 - J3 = \
                     {:.1e} kg m^2), which has no inertia along its normal on the space of attitude matrices; use \
                     method=rattle",
                    names.bodies[body],
                    2.0 * least
                ),
            });
        }
        "euler_a" => Method::EulerA,
        "euler_b" => Method::EulerB,
        "shake" => Method::Shake,
        _ => Method::Rattle,
    };
    let rattle = Rattle::new(system).map_err(failed)?.with_method(method);
    Ok(Core::Rattle(match spec.word(&ROTATION) {
        "moser_veselov" => rattle.with_rotation(Rotation::MoserVeselov),
        "splitting" => rattle.with_rotation(Rotation::Splitting),
        "cayley" => rattle.with_rotation(Rotation::Cayley),
        _ => rattle.with_automatic_rotation(),
    }))
}

/// One step of a map.
enum Core {
    Rattle(Rattle),
    Lobatto(Lobatto),
}

impl Core {
    fn step(&mut self, h: f64) -> Result<(), Failure> {
        match self {
            Core::Rattle(rattle) => rattle.step(h),
            Core::Lobatto(lobatto) => lobatto.step(h),
        }
    }

    fn write_state(&self, out: &mut State) {
        match self {
            Core::Rattle(rattle) => rattle.write_state(out),
            Core::Lobatto(lobatto) => lobatto.write_state(out),
        }
    }

    /// Bodies that left Moser-Veselov, and when (s).
    fn switched(&self) -> &[(usize, f64)] {
        match self {
            Core::Rattle(rattle) => rattle.switched(),
            Core::Lobatto(_) => &[],
        }
    }
}

/// A composition of RATTLE steps at a fixed step.
struct RattleEngine {
    core: Core,
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
            self.core.write_state(&mut self.before);
        }
        for (k, substep) in self.substeps.iter().enumerate() {
            if let Err(failure) = self.core.step(*substep) {
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
            self.core.write_state(out);
        }
    }

    fn remarks(&self) -> Vec<String> {
        let switched = self.core.switched().iter().map(|&(body, time)| {
            format!(
                "body '{}' turns too fast for the Moser-Veselov equation at t = {time:.6} s; from there on it turns by \
                 rotation=splitting",
                self.names.bodies[body]
            )
        });
        switched.collect()
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
             Moser-Veselov equation; take a step below {:.1e} s, or rotation=auto",
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
