//! From a spec to the map that it names, as an engine.

use super::engine::RattleEngine;
use super::fits::{energy_fits, fits, steps_fit};
use super::messages::{Names, describe};
use super::remarks::Told;
use super::settings::{KEYS, METHOD, ON_FAILURE, ORDER, ROTATION, STAGES, STEP, TOL};
use crate::engines::{Engine, Entry, Spec, Unsupported};
use crate::mechanics::{Part, System};
use crate::variational::composition::{self, Composed, Composition};
use crate::variational::lobatto::Unfit;
use crate::variational::substep::Halving;
use crate::variational::{Adaptive, EnergyMomentum, Fault, Faulty, Lobatto, Method, Rattle, Rotation};

pub(in crate::engines) const ENTRY: Entry = Entry {
    name: "rattle",
    summary: "variational RATTLE with holonomic joint constraints: symplectic, time-reversible",
    keys: KEYS,
    parts: &[Part::Loops, Part::Mimics, Part::JointSprings, Part::PointSprings, Part::Drives],
    build,
};

fn build(spec: &Spec, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    Making { spec, system, step, fault: None }.engine()
}

/// An engine `rattle` with a planted fault, for tests of what checks catch.
///
/// # Errors
/// As [`crate::engines::build`].
pub fn faulty(spec: &Spec, system: &System, step: f64, fault: Fault) -> Result<Box<dyn Engine>, Unsupported> {
    Making { spec, system, step, fault: Some(fault) }.engine()
}

/// What an engine is made from.
struct Making<'a> {
    spec: &'a Spec,
    system: &'a System,
    step: f64,
    fault: Option<Fault>,
}

impl Making<'_> {
    fn engine(&self) -> Result<Box<dyn Engine>, Unsupported> {
        self.checked().map_err(|what| Unsupported { engine: self.spec.to_string(), what })
    }

    fn checked(&self) -> Result<Box<dyn Engine>, String> {
        let (spec, system) = (self.spec, self.system);
        let order = spec.word(&ORDER);
        let composition =
            composition::ALL.iter().find(|c| c.order.to_string() == order).copied().unwrap_or(composition::ORDER_2);
        let composed = composition.stages() > 1;
        fits(spec, composed, system)?;
        steps_fit(spec, composed, system)?;
        energy_fits(spec, composed, system)?;
        let method = match spec.word(&METHOD) {
            "lobatto" => return Ok(self.stepping(self.lobatto()?)),
            "energy_momentum" => {
                let varied = EnergyMomentum::new(self.rattle(Method::Rattle)?, self.step);
                return Ok(self.engine_of(varied));
            }
            "euler_a" => Method::EulerA,
            "euler_b" => Method::EulerB,
            "shake" => Method::Shake,
            _ => Method::Rattle,
        };
        let rattle = self.rattle(method)?;
        Ok(match spec.word(&STEP) {
            "adaptive" => self.engine_of(Adaptive::new(system, rattle, spec.number(&TOL))),
            _ => self.composed(rattle, composition),
        })
    }

    fn lobatto(&self) -> Result<Lobatto, String> {
        let names = Names::of(self.system);
        Lobatto::new(self.system, self.spec.number(&STAGES) as usize).map_err(|unfit| match unfit {
            Unfit::Failure(failure) => describe(failure, 0.0, self.step, &names),
            Unfit::Damped { joint } => format!("damping (joint '{}') with method=lobatto", names.joints[joint]),
            Unfit::Flat { body, least } => format!(
                "body '{}' with method=lobatto: its moments of inertia are those of a flat plate (J1 + J2 - J3 = \
                 {:.1e} kg m^2), which has no inertia along its normal on the space of attitude matrices; use \
                 method=rattle",
                names.bodies[body],
                2.0 * least
            ),
        })
    }

    fn rattle(&self, method: Method) -> Result<Rattle, String> {
        let failed = |failure| describe(failure, 0.0, self.step, &Names::of(self.system));
        let rattle = Rattle::new(self.system).map_err(failed)?.with_method(method);
        Ok(match self.spec.word(&ROTATION) {
            "moser_veselov" => rattle.with_rotation(Rotation::MoserVeselov),
            "splitting" => rattle.with_rotation(Rotation::Splitting),
            "cayley" => rattle.with_rotation(Rotation::Cayley),
            _ => rattle.with_automatic_rotation(),
        })
    }

    /// The steps of the run by a composition of RATTLE steps.
    fn composed(&self, rattle: Rattle, composition: Composition) -> Box<dyn Engine> {
        let rattle = if composition.reaches_roundoff() { rattle.with_unbiased_roundoff() } else { rattle };
        match self.fault {
            Some(fault) => self.composed_of(Faulty::new(rattle, fault), composition),
            None => self.composed_of(rattle, composition),
        }
    }

    fn composed_of(&self, map: impl Told + 'static, composition: Composition) -> Box<dyn Engine> {
        if composition.stages() > 1 { self.engine_of(Composed::new(map, composition)) } else { self.stepping(map) }
    }

    /// The steps of the run by a map of one step, or in halves where they fail.
    fn stepping(&self, map: impl Told + 'static) -> Box<dyn Engine> {
        if self.spec.word(&ON_FAILURE) == "substep" { self.engine_of(Halving::new(map)) } else { self.engine_of(map) }
    }

    fn engine_of(&self, map: impl Told + 'static) -> Box<dyn Engine> {
        Box::new(RattleEngine::new(map, self.system, self.step))
    }
}
