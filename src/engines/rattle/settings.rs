//! The settings of the engine `rattle`.

use crate::engines::{Choice, Key, Number};

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
