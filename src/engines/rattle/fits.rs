//! Which settings of the engine `rattle` go together, and with what a system has.

use super::settings::{METHOD, ON_FAILURE, ORDER, ROTATION, STAGES, STEP, TOL};
use crate::engines::Spec;
use crate::mechanics::{Body, Part, PointSpring, System};

/// Whether the settings of the step go together, and with what the system has.
pub(super) fn steps_fit(spec: &Spec, composed: bool, system: &System) -> Result<(), String> {
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

/// Whether the settings go with method=energy_momentum, where that is the method, and the system has an energy.
pub(super) fn energy_fits(spec: &Spec, composed: bool, system: &System) -> Result<(), String> {
    let method = "method=energy_momentum";
    if spec.word(&METHOD) != "energy_momentum" {
        return Ok(());
    }
    if composed {
        return Err(format!("order={} with {method}: it solves for the step of rattle of order 2", spec.word(&ORDER)));
    }
    if spec.word(&ON_FAILURE) == "substep" {
        return Err(format!("on_failure=substep with {method}: halves of a step have another discrete energy"));
    }
    if !system.parts.drives.is_empty() {
        return Err(format!("drives with {method}, which keeps the energy; use method=rattle"));
    }
    system.first_damper().map_or(Ok(()), |damper| {
        Err(format!("damping ({damper}) with {method}, which keeps the energy; use method=rattle"))
    })
}

/// Whether the settings go together, and with what the system has.
pub(super) fn fits(spec: &Spec, composed: bool, system: &System) -> Result<(), String> {
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
    let plain = !matches!(method, "rattle" | "midpoint" | "energy_momentum");
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
    if let Some(i) = system.parts.point_springs.iter().position(|s| directionless(s, system)) {
        return Err(format!(
            "spring {i} between points, whose points coincide at the start, where a spring with a rest_length has no direction; \
             move them apart, or set rest_length to 0"
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

/// Whether the points of a spring with a rest length coincide at the start.
fn directionless(spring: &PointSpring, system: &System) -> bool {
    spring.stiffness > 0.0 && spring.distance(&system.initial).0 < 1e-12 * spring.rest_length
}
