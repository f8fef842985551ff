//! The variational RATTLE core as an engine.

use super::{Choice, Engine, Entry, Key, Number, Spec, StepFailure, Unsupported};
use crate::mechanics::{Body, Part, State, System};
use crate::variational::composition;
use crate::variational::lobatto::Unfit;
use crate::variational::substep::{step_in_halves, step_that_works};
use crate::variational::{Adaptive, Failure, Fault, Lobatto, Method, Rattle, Rotation};

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

static ON_FAILURE: Choice = Choice {
    name: "on_failure",
    words: &["stop", "substep"],
    summary: "what follows a step that does not converge: stop ends the run with its reason; substep takes the step in halves, \
              down to 1/1024, which is not symplectic there and is counted",
};

static STEP: Choice = Choice {
    name: "step",
    words: &["fixed", "adaptive"],
    summary: "fixed takes the run's step; adaptive takes time-reversible steps of its own, from tol, and hands out states at the \
              run's step (not symplectic; the energy error stays bounded)",
};

static TOL: Number = Number {
    name: "tol",
    min: 1e-14,
    max: 1e-1,
    default: 1e-4,
    whole: false,
    summary: "relative energy error that step=adaptive aims at",
};

pub(super) const ENTRY: Entry = Entry {
    name: "rattle",
    summary: "variational RATTLE with holonomic joint constraints: symplectic, time-reversible",
    keys: &[
        Key::Choice(&ORDER),
        Key::Choice(&METHOD),
        Key::Number(&STAGES),
        Key::Choice(&ROTATION),
        Key::Choice(&STEP),
        Key::Number(&TOL),
        Key::Choice(&ON_FAILURE),
    ],
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
        core => core,
    };
    Ok(Box::new(RattleEngine { core, ..sound }))
}

fn engine(spec: &Spec, system: &System, step: f64) -> Result<RattleEngine, Unsupported> {
    let unsupported = |what: String| Unsupported { engine: spec.to_string(), what };
    let order = spec.word(&ORDER);
    let composition =
        composition::ALL.iter().find(|c| c.order.to_string() == order).copied().unwrap_or(composition::ORDER_2);
    fits(spec, composition.stages() > 1, system).map_err(unsupported)?;
    steps_fit(spec, composition.stages() > 1, system).map_err(unsupported)?;
    let core = core(spec, system, step).map_err(unsupported)?;
    Ok(RattleEngine {
        core,
        substeps: composition.weights().map(|w| w * step).collect(),
        step,
        taken: 0,
        names: Names::of(system),
        before: system.initial.clone(),
        failed: false,
        halved: (spec.word(&ON_FAILURE) == "substep")
            .then(|| Halved { first: Vec::with_capacity(NAMED), ..Halved::default() }),
    })
}

/// Whether the settings of the step go together, and with what the system has.
fn steps_fit(spec: &Spec, composed: bool, system: &System) -> Result<(), String> {
    let (order, method) = (spec.word(&ORDER), spec.word(&METHOD));
    let (adaptive, halved) = (spec.word(&STEP) == "adaptive", spec.word(&ON_FAILURE) == "substep");
    if halved && composed {
        return Err(format!(
            "on_failure=substep with order={order}: a substep in halves breaks the symmetry that gives the composition its order; \
             use order=2"
        ));
    }
    if !adaptive {
        return match spec.given(TOL.name) {
            Some(_) => Err("tol with step=fixed: only step=adaptive has a tolerance".to_string()),
            None => Ok(()),
        };
    }
    if composed || !matches!(method, "rattle" | "midpoint") {
        return Err(format!(
            "step=adaptive with order={order},method={method}: it varies the step of rattle of order 2"
        ));
    }
    if halved {
        return Err(
            "on_failure=substep with step=adaptive: halves would break the sequence of steps, which is what keeps the \
             energy; take a smaller tol"
                .to_string(),
        );
    }
    system.first_damper().map_or(Ok(()), |damper| {
        Err(format!("damping ({damper}) with step=adaptive: its steps are made for reversible motion; use step=fixed"))
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
    let rattle = match spec.word(&ROTATION) {
        "moser_veselov" => rattle.with_rotation(Rotation::MoserVeselov),
        "splitting" => rattle.with_rotation(Rotation::Splitting),
        "cayley" => rattle.with_rotation(Rotation::Cayley),
        _ => rattle.with_automatic_rotation(),
    };
    Ok(match spec.word(&STEP) {
        "adaptive" => Core::Adaptive(Box::new(Adaptive::new(system, rattle, spec.number(&TOL)))),
        _ => Core::Rattle(rattle),
    })
}

/// One step of a map.
#[derive(Clone)]
enum Core {
    Rattle(Rattle),
    Lobatto(Lobatto),
    Adaptive(Box<Adaptive>),
}

impl Core {
    fn step(&mut self, h: f64) -> Result<(), Failure> {
        match self {
            Core::Rattle(rattle) => rattle.step(h),
            Core::Lobatto(lobatto) => lobatto.step(h),
            Core::Adaptive(adaptive) => adaptive.advance_to(adaptive.output_time() + h),
        }
    }

    fn write_state(&self, out: &mut State) {
        match self {
            Core::Rattle(rattle) => rattle.write_state(out),
            Core::Lobatto(lobatto) => lobatto.write_state(out),
            Core::Adaptive(adaptive) => adaptive.write_state(out),
        }
    }

    /// Bodies that left Moser-Veselov, and when (s).
    fn switched(&self) -> &[(usize, f64)] {
        match self {
            Core::Rattle(rattle) => rattle.switched(),
            Core::Lobatto(_) => &[],
            Core::Adaptive(adaptive) => adaptive.switched(),
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
    /// The state before the present step, which stands after a part of the step has failed.
    before: State,
    failed: bool,
    halved: Option<Halved>,
}

/// Steps of a run that were taken in halves.
#[derive(Default)]
struct Halved {
    steps: u64,
    most: u32,
    /// When the first of them began, s.
    first: Vec<f64>,
}

/// How many of these are named.
const NAMED: usize = 3;

/// A rate times the step, rad, up to which failures are not put down to it.
const RESOLVED: f64 = 0.3;

/// The same for the sway of a linkage, whose forces grow large near a singular configuration without being the cause.
const SWAYS: f64 = 1.0;

impl RattleEngine {
    /// Takes the substeps. The state may be one of between when one of them fails.
    fn take(&mut self) -> Result<(), (usize, Failure)> {
        let core = &mut self.core;
        let Some(halved) = &mut self.halved else {
            return self
                .substeps
                .iter()
                .enumerate()
                .try_for_each(|(k, h)| core.step(*h).map_err(|failure| (k, failure)));
        };
        let halvings = step_in_halves(self.step, &mut |h| core.step(h)).map_err(|failure| (0, failure))?;
        if halvings > 0 {
            halved.steps += 1;
            halved.most = halved.most.max(halvings);
            if halved.first.len() < NAMED {
                halved.first.push(self.taken as f64 * self.step);
            }
        }
        Ok(())
    }

    /// What went wrong, how fast bodies turn, and the step with which it would have gone right.
    fn explain(&self, taken: usize, failure: Failure) -> String {
        let time = self.taken as f64 * self.step;
        if let Core::Adaptive(adaptive) = &self.core {
            return describe(failure, adaptive.node_time(), adaptive.step_size(), &self.names);
        }
        let what = describe(failure, time, self.step, &self.names);
        if matches!(failure, Failure::Singular { .. } | Failure::NotFinite { .. }) {
            return what;
        }
        let cause = self.cause();
        if self.halved.is_some() {
            return format!("{what}; {cause}; halves of it down to 1/1024 fail too");
        }
        let cure = match self.step_that_works(taken) {
            Some(step) => format!("a step of {step:.3e} s goes on from there, as would on_failure=substep (order 2)"),
            None => "halves of it down to 1/1024 fail too".to_string(),
        };
        format!("{what}; {cause}; {cure}")
    }

    /// What of the motion is too fast for the step: the turn of a body, or the sway of a body under the forces in its joints.
    fn cause(&self) -> String {
        let turning = self.before.bodies.iter().map(|body| self.step * body.angular_velocity.norm()).enumerate();
        let (turned, turn) = turning.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
        let (swayed, sway) = match &self.core {
            Core::Rattle(rattle) => rattle.fastest_sway().map_or((0, 0.0), |(body, rate)| (body, self.step * rate)),
            Core::Lobatto(_) | Core::Adaptive(_) => (0, 0.0),
        };
        let names = &self.names.bodies;
        let fastest = format!("h |Omega| is at most {turn:.2} (body '{}')", names[turned]);
        let linkage = !self.names.bonds.is_empty();
        if sway > turn && sway > if linkage { SWAYS } else { RESOLVED } {
            return format!(
                "the forces in the joints make body '{}' sway with h omega = {sway:.1}, which the step does not resolve; {fastest}",
                names[swayed]
            );
        }
        if turn > RESOLVED {
            return format!("{fastest}, which the step does not resolve");
        }
        let place = if linkage { ", as where a linkage passes a singular configuration" } else { "" };
        format!("{fastest} and h omega of the sway {sway:.2}: the motion changes within the step{place}")
    }

    /// Found on copies of the state before the step; that of a composition, a reversible map, by going back the substeps taken.
    fn step_that_works(&self, taken: usize) -> Option<f64> {
        let mut start = self.core.clone();
        self.substeps[..taken].iter().rev().try_for_each(|h| start.step(-h)).ok()?;
        step_that_works(&start, 1.0, |core, part| self.substeps.iter().try_for_each(|h| core.step(part * h)))
            .map(|part| part * self.step)
    }
}

impl Engine for RattleEngine {
    fn step(&mut self) -> Result<(), StepFailure> {
        let partly = self.substeps.len() > 1 || self.halved.is_some() || matches!(self.core, Core::Adaptive(_));
        if partly {
            self.core.write_state(&mut self.before);
        }
        if let Err((taken, failure)) = self.take() {
            if !partly {
                self.core.write_state(&mut self.before);
            }
            self.failed = partly;
            let detail = self.explain(taken, failure);
            return Err(match failure {
                Failure::NotFinite { .. } => StepFailure::Diverged { detail },
                _ => StepFailure::NotConverged { detail },
            });
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

    fn chooses_its_steps(&self) -> bool {
        matches!(self.core, Core::Adaptive(_))
    }

    fn warning(&self) -> Option<String> {
        let jump = match &self.core {
            // Substeps of different sizes and signs are not compared.
            Core::Rattle(rattle) if self.substeps.len() == 1 => rattle.jump(),
            _ => None,
        };
        jump.map(|(part, time)| {
            format!(
                "t = {time:.6} s: a step changes the kinetic energy of a linkage by {part:.2} of it without work, as where it \
                 passes a singular configuration within a step; take a smaller step"
            )
        })
    }

    fn remarks(&self) -> Vec<String> {
        let switched = self.core.switched().iter().map(|&(body, time)| {
            format!(
                "body '{}' turns too fast for the Moser-Veselov equation at t = {time:.6} s; from there on it turns by \
                 rotation=splitting",
                self.names.bodies[body]
            )
        });
        let halved = self.halved.as_ref().filter(|halved| halved.steps > 0).map(|halved| {
            let first: Vec<String> = halved.first.iter().map(|time| format!("{time:.6} s")).collect();
            format!(
                "on_failure=substep: {} of {} steps did not converge and were taken in halves, at the finest in {} parts, first at \
                 t = {}; the map is not symplectic there",
                halved.steps,
                self.taken,
                1_u32 << halved.most,
                first.join(", ")
            )
        });
        let steps = match &self.core {
            Core::Adaptive(adaptive) => Some(format!("step=adaptive took {} steps of its own", adaptive.steps())),
            _ => None,
        };
        switched.chain(halved).chain(steps).collect()
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
            "t = {time:.6} s: {} does not close after {rounds} rounds, residual {residual:.1e} m at a step of {step} s; take \
             a smaller step",
            names.bonds[index]
        ),
        Failure::Leap { gained } => format!(
            "t = {time:.6} s: a step of {step} s goes to a false solution only, with {gained:.2} of the kinetic energy from \
             nowhere; take a smaller step"
        ),
        Failure::Stalled { step } => format!(
            "t = {time:.6} s: the adaptive step of {step:.1e} s is too short for the time to advance; take a larger tol"
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
