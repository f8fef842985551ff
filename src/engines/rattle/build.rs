//! From a spec to the map that it names, as an engine.

use super::engine::RattleEngine;
use super::fits::fits;
use super::messages::{Names, describe};
use super::remarks::Told;
use super::settings::{OnFailure, Roundoff, Settings, StepChoice, Turning};
use crate::engines::engine::{Engine, Unsupported};
use crate::engines::values::Values;
use crate::mechanics::System;
use crate::variational::composition::Composed;
use crate::variational::lobatto::Unfit;
use crate::variational::method::Kind;
use crate::variational::substep::Halving;
use crate::variational::{Adaptive, EnergyMomentum, Fault, Faulty, Lobatto, Method, Rattle};

pub(super) fn build(spec: &Values, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    build_with(spec, system, step, None)
}

/// An engine with a planted fault, for tests of what checks catch.
pub(in crate::engines) fn faulty(
    spec: &Values,
    system: &System,
    step: f64,
    fault: Fault,
) -> Result<Box<dyn Engine>, Unsupported> {
    build_with(spec, system, step, Some(fault))
}

fn build_with(spec: &Values, system: &System, step: f64, fault: Option<Fault>) -> Result<Box<dyn Engine>, Unsupported> {
    let settings = Settings::new(spec);
    let making = Making { settings, system, step, fault };
    let engine = fits(spec, &settings, system).and_then(|()| making.engine());
    engine.map_err(|what| Unsupported { engine: spec.to_string(), what })
}

/// What an engine is made from.
struct Making<'a> {
    settings: Settings,
    system: &'a System,
    step: f64,
    fault: Option<Fault>,
}

impl Making<'_> {
    fn engine(&self) -> Result<Box<dyn Engine>, String> {
        match self.settings.method.kind {
            Kind::Rattle | Kind::Midpoint => self.stepping_by(Method::Rattle),
            Kind::EulerA => self.stepping_by(Method::EulerA),
            Kind::EulerB => self.stepping_by(Method::EulerB),
            Kind::Shake => self.stepping_by(Method::Shake),
            Kind::Lobatto => Ok(self.with_halves(self.lobatto()?)),
            Kind::EnergyMomentum => Ok(self.boxed(EnergyMomentum::new(self.rattle(Method::Rattle)?, self.step))),
        }
    }

    /// Steps of RATTLE or a relative: adaptive ones, a composition of them, or those of the run.
    fn stepping_by(&self, method: Method) -> Result<Box<dyn Engine>, String> {
        let rattle = self.rattle(method)?;
        Ok(match (self.settings.step, self.fault) {
            (StepChoice::Adaptive, _) => self.boxed(Adaptive::new(self.system, rattle, self.settings.tolerance)),
            (StepChoice::Fixed, Some(fault)) => self.composed(Faulty::new(rattle, fault)),
            (StepChoice::Fixed, None) => self.composed(rattle),
        })
    }

    fn composed(&self, map: impl Told + 'static) -> Box<dyn Engine> {
        let composition = self.settings.composition;
        if composition.stages() > 1 { self.boxed(Composed::new(map, composition)) } else { self.with_halves(map) }
    }

    fn rattle(&self, method: Method) -> Result<Rattle, String> {
        let failed = |failure| describe(failure, 0.0, self.step, &Names::of(self.system));
        let rattle = Rattle::new(self.system).map_err(failed)?.with_method(method);
        let rattle = match self.settings.turning {
            Turning::Automatic => rattle.with_automatic_rotation(),
            Turning::By(rotation) => rattle.with_rotation(rotation),
        };
        Ok(match self.settings.roundoff {
            Roundoff::Usual => rattle,
            Roundoff::Unbiased => rattle.with_unbiased_roundoff(),
        })
    }

    fn lobatto(&self) -> Result<Lobatto, String> {
        let names = Names::of(self.system);
        Lobatto::new(self.system, self.settings.stages).map_err(|unfit| match unfit {
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

    /// The steps of the run, in halves where they fail and that is asked for.
    fn with_halves(&self, map: impl Told + 'static) -> Box<dyn Engine> {
        match self.settings.on_failure {
            OnFailure::Stop => self.boxed(map),
            OnFailure::Substep => self.boxed(Halving::new(map)),
        }
    }

    fn boxed(&self, map: impl Told + 'static) -> Box<dyn Engine> {
        Box::new(RattleEngine::new(map, self.system, self.step, self.settings.method.remark))
    }
}
