//! Which settings of the engine `rattle` go together, and with what a system has: by the facts of the method.

use super::settings::{ON_FAILURE, ORDER, OnFailure, ROTATION, STAGES, Settings, StepChoice, TOL};
use crate::engines::values::Values;
use crate::mechanics::{Body, Part, PointSpring, System};
use crate::variational::method::{Facts, Order, Steps};

/// Says what does not go together, and the remedy.
pub(super) fn fits(spec: &Values, settings: &Settings, system: &System) -> Result<(), String> {
    settings_fit(spec, settings)?;
    parts_fit(settings.method, system)?;
    dampers_fit(settings, system)?;
    halves_fit(settings)?;
    adaptive_fits(spec, settings, system)?;
    energy_fits(settings, system)
}

fn is_composed(settings: &Settings) -> bool {
    settings.composition.stages() > 1
}

/// Whether the method has what the settings set.
fn settings_fit(spec: &Values, settings: &Settings) -> Result<(), String> {
    let (order, method, name) = (settings.composition.order, settings.method, settings.method.name);
    let of_stages = method.order == Order::OfStages;
    if !of_stages && spec.given(STAGES.name).is_some() {
        let others = Facts::names_of(|facts| facts.order == Order::OfStages);
        return Err(format!("stages with method={name}: only method={others} has stages"));
    }
    if !method.rotation_rules && spec.given(ROTATION.name).is_some() {
        return Err(format!("rotation with method={name}: its stages turn the bodies; leave rotation out"));
    }
    if of_stages && spec.given(ORDER.name).is_some() {
        return Err(format!("order with method={name}: its order is 2 stages - 2; set stages and leave order out"));
    }
    if is_composed(settings) && !method.time_reversible {
        return Err(format!("order={order} with method={name}: only a time-reversible map can be composed to it"));
    }
    Ok(())
}

/// Whether the method has means for what the system has beside its tree of bodies.
fn parts_fit(method: &Facts, system: &System) -> Result<(), String> {
    if let (Some(reason), Some(part)) = (method.refuses.parts, system.parts.kinds().next()) {
        return Err(format!("{} with method={}{reason}; use method=rattle", part.name(), method.name));
    }
    let pointlike = |body: &&Body| body.mass == 0.0 || body.inertia.min() == 0.0;
    if let Some(body) = system.bodies.iter().find(pointlike).filter(|_| method.refuses.light_bodies) {
        return Err(format!(
            "link '{}', which moves without inertia, with method={}; use method=rattle",
            body.name, method.name
        ));
    }
    let rows = system.parts.kinds().any(|part| match part {
        Part::Loops | Part::Mimics | Part::PointSprings => true,
        Part::JointSprings | Part::Drives => false,
    });
    if let Some(body) = system.bodies.iter().find(|body| rows && body.inertia.max() == 0.0) {
        return Err(format!(
            "link '{}', which moves without moments of inertia, beside loops, mimic joints or springs between points; \
             give it an <inertia>",
            body.name
        ));
    }
    if let Some(i) = system.parts.point_springs.iter().position(|s| directionless(s, system)) {
        return Err(format!(
            "spring {i} between points, whose points coincide at the start, where a spring with a rest_length has no \
             direction; move them apart, or set rest_length to 0"
        ));
    }
    Ok(())
}

/// Whether the points of a spring with a rest length coincide at the start.
fn directionless(spring: &PointSpring, system: &System) -> bool {
    spring.stiffness > 0.0 && spring.distance(&system.initial).0 < 1e-12 * spring.rest_length
}

fn dampers_fit(settings: &Settings, system: &System) -> Result<(), String> {
    let Some(damper) = system.first_damper() else { return Ok(()) };
    if is_composed(settings) {
        return Err(format!(
            "damping ({damper}) at order {}: a composition of order above 2 has backward substeps, in which a damper \
             would give energy; use order=2",
            settings.composition.order
        ));
    }
    match (settings.method.refuses.dampers, settings.method.steps) {
        (Some(reason), Steps::Given | Steps::GivenOrAdaptive) => {
            Err(format!("damping ({damper}) with method={}{reason}; use method=rattle", settings.method.name))
        }
        (Some(_), Steps::HoldingEnergy) | (None, _) => Ok(()),
    }
}

/// Whether steps may be taken in halves.
fn halves_fit(settings: &Settings) -> Result<(), String> {
    if settings.on_failure == OnFailure::Substep && is_composed(settings) {
        return Err(format!(
            "{}=substep with order={}: a substep in halves breaks the symmetry that gives the composition its order; \
             use order=2",
            ON_FAILURE.name, settings.composition.order
        ));
    }
    Ok(())
}

/// Whether adaptive steps, where they are asked for, go with the settings and the system.
fn adaptive_fits(spec: &Values, settings: &Settings, system: &System) -> Result<(), String> {
    match settings.step {
        StepChoice::Fixed if spec.given(TOL.name).is_some() => {
            return Err("tol with step=fixed: only step=adaptive has a tolerance".to_string());
        }
        StepChoice::Fixed => return Ok(()),
        StepChoice::Adaptive => {}
    }
    let (order, method) = (settings.composition.order, settings.method);
    if is_composed(settings) || method.steps != Steps::GivenOrAdaptive {
        return Err(format!(
            "step=adaptive with order={order},method={}: it varies the step of rattle of order 2",
            method.name
        ));
    }
    if settings.on_failure == OnFailure::Substep {
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

/// Whether the system has an energy that the steps can hold, where the method chooses them so.
fn energy_fits(settings: &Settings, system: &System) -> Result<(), String> {
    match settings.method.steps {
        Steps::HoldingEnergy => {}
        Steps::Given | Steps::GivenOrAdaptive => return Ok(()),
    }
    let (refuses, method) = (settings.method.refuses, format!("method={}", settings.method.name));
    if is_composed(settings) {
        let order = settings.composition.order;
        return Err(format!("order={order} with {method}: it solves for the step of rattle of order 2"));
    }
    if settings.on_failure == OnFailure::Substep {
        return Err(format!("on_failure=substep with {method}: halves of a step have another discrete energy"));
    }
    if let Some(reason) = refuses.drives.filter(|_| !system.parts.drives.is_empty()) {
        return Err(format!("drives with {method}{reason}; use method=rattle"));
    }
    match (refuses.dampers, system.first_damper()) {
        (Some(reason), Some(damper)) => Err(format!("damping ({damper}) with {method}{reason}; use method=rattle")),
        (Some(_), None) | (None, _) => Ok(()),
    }
}
