//! The settings of the engine `rattle`: what they are, and which go together.

use super::super::{Choice, Key, Number, Spec};
use crate::mechanics::{Body, Part, PointSpring, System};

pub(super) static ORDER: Choice = Choice {
    name: "order",
    words: &["2", "4", "6", "8"],
    summary: "order of the symmetric composition of RATTLE steps: 1, 5, 13 or 17 of them a step",
};

pub(super) static ROTATION: Choice = Choice {
    name: "rotation",
    words: &["auto", "moser_veselov", "splitting", "cayley"],
    summary: "how bodies turn: moser_veselov is RATTLE proper, for less than about 1 rad a step, the others have no such \
              limit; auto moves a body from the first to splitting, once, when it turns too fast",
};

pub(super) static METHOD: Choice = Choice {
    name: "method",
    words: &["rattle", "midpoint", "euler_a", "euler_b", "shake", "lobatto", "energy_momentum"],
    summary: "the map of one step: rattle, the same by the midpoint rule, the two symplectic Euler maps (order 1), rattle in \
              positions, Lobatto IIIA-IIIB (order 2 stages - 2), or energy_momentum: rattle with steps of its own, from the \
              run's step on, that hold the discrete energy to roundoff and end, by name, where none does",
};

pub(super) static STAGES: Number = Number {
    name: "stages",
    min: 2.0,
    max: 5.0,
    default: 3.0,
    whole: true,
    summary: "stages of method=lobatto; with 2 it is rattle",
};

pub(super) static ON_FAILURE: Choice = Choice {
    name: "on_failure",
    words: &["stop", "substep"],
    summary: "what follows a step that does not converge: stop ends the run with its reason; substep takes the step in halves, \
              down to 1/1024, which is not symplectic there and is counted",
};

pub(super) static STEP: Choice = Choice {
    name: "step",
    words: &["fixed", "adaptive"],
    summary: "fixed takes the run's step; adaptive takes time-reversible steps of its own, from tol, and hands out states at the \
              run's step (not symplectic; the energy error stays bounded)",
};

pub(super) static TOL: Number = Number {
    name: "tol",
    min: 1e-14,
    max: 1e-1,
    default: 1e-4,
    whole: false,
    summary: "relative energy error that step=adaptive aims at",
};

/// All settings, in the order in which they are listed.
pub(super) static KEYS: &[Key] = &[
    Key::Choice(&ORDER),
    Key::Choice(&METHOD),
    Key::Number(&STAGES),
    Key::Choice(&ROTATION),
    Key::Choice(&STEP),
    Key::Number(&TOL),
    Key::Choice(&ON_FAILURE),
];

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
