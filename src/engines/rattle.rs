//! The variational RATTLE core as an engine.

mod messages;
mod settings;

use super::{Engine, Entry, Spec, StepFailure, Unsupported};
use crate::mechanics::{Part, State, System};
use crate::variational::composition;
use crate::variational::lobatto::Unfit;
use crate::variational::substep::{step_in_halves, step_that_works};
use crate::variational::{Adaptive, EnergyMomentum, Failure, Fault, Faulty, Lobatto, Method, Rattle, Rotation};
use messages::{Names, describe};
use settings::{KEYS, METHOD, ON_FAILURE, ORDER, ROTATION, STAGES, STEP, TOL, energy_fits, fits, steps_fit};

pub(super) const ENTRY: Entry = Entry {
    name: "rattle",
    summary: "variational RATTLE with holonomic joint constraints: symplectic, time-reversible",
    keys: KEYS,
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
        Core::Rattle(rattle) => Core::Faulty(Faulty::new(rattle, fault)),
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
    energy_fits(spec, composition.stages() > 1, system).map_err(unsupported)?;
    let core = match core(spec, system, step).map_err(unsupported)? {
        Core::Rattle(rattle) if composition.reaches_roundoff() => Core::Rattle(rattle.with_unbiased_roundoff()),
        core => core,
    };
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
    if spec.word(&METHOD) == "energy_momentum" {
        return Ok(Core::EnergyMomentum(Box::new(EnergyMomentum::new(rattle, step))));
    }
    Ok(match spec.word(&STEP) {
        "adaptive" => Core::Adaptive(Box::new(Adaptive::new(system, rattle, spec.number(&TOL)))),
        _ => Core::Rattle(rattle),
    })
}

/// One step of a map.
#[derive(Clone)]
enum Core {
    Rattle(Rattle),
    Faulty(Faulty),
    Lobatto(Lobatto),
    Adaptive(Box<Adaptive>),
    EnergyMomentum(Box<EnergyMomentum>),
}

impl Core {
    fn step(&mut self, h: f64) -> Result<(), Failure> {
        match self {
            Core::Rattle(rattle) => rattle.step(h),
            Core::Faulty(faulty) => faulty.step(h),
            Core::Lobatto(lobatto) => lobatto.step(h),
            Core::Adaptive(adaptive) => adaptive.advance_to(adaptive.output_time() + h),
            Core::EnergyMomentum(varied) => varied.advance_to(varied.output_time() + h),
        }
    }

    fn write_state(&self, out: &mut State) {
        match self {
            Core::Rattle(rattle) => rattle.write_state(out),
            Core::Faulty(faulty) => faulty.write_state(out),
            Core::Lobatto(lobatto) => lobatto.write_state(out),
            Core::Adaptive(adaptive) => adaptive.write_state(out),
            Core::EnergyMomentum(varied) => varied.write_state(out),
        }
    }

    /// Bodies that left Moser-Veselov, and when (s).
    fn switched(&self) -> &[(usize, f64)] {
        match self {
            Core::Rattle(rattle) => rattle.switched(),
            Core::Faulty(_) | Core::Lobatto(_) | Core::EnergyMomentum(_) => &[],
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
        if let Core::EnergyMomentum(varied) = &self.core {
            return describe(failure, varied.node_time(), varied.step_size(), &self.names);
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
            Core::Faulty(_) | Core::Lobatto(_) | Core::Adaptive(_) | Core::EnergyMomentum(_) => (0, 0.0),
        };
        let names = &self.names.bodies;
        let fastest = format!("h |Omega| is at most {turn:.2} (body '{}')", names[turned]);
        let linkage = self.names.first_spring > 0;
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
        let own_steps = matches!(self.core, Core::Adaptive(_) | Core::EnergyMomentum(_));
        let partly = self.substeps.len() > 1 || self.halved.is_some() || own_steps;
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
        matches!(self.core, Core::Adaptive(_) | Core::EnergyMomentum(_))
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
            Core::EnergyMomentum(varied) => varied.report().map(|report| {
                format!(
                    "method=energy_momentum took {} steps of its own, of {:.3e} to {:.3e} s, by {} solves; they keep a discrete energy \
                     of {:.9e} J to {:.1e} of its terms",
                    report.steps, report.shortest, report.longest, report.solves, report.energy, report.worst
                )
            }),
            _ => None,
        };
        switched.chain(halved).chain(steps).collect()
    }
}
