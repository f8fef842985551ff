//! The settings of the engine `rattle`.

use crate::engines::key::{Choice, Key, Number, Word};
use crate::engines::values::Values;
use crate::variational::Rotation;
use crate::variational::composition::{self, Composition};
use crate::variational::method::{Facts, METHODS};

pub(super) static ORDER: Choice<Composition> = Choice {
    name: "order",
    words: &ORDERS,
    summary: "order of the symmetric composition of RATTLE steps: 1, 5, 13 or 17 of them a step",
};

const ORDERS: [Word<Composition>; composition::ALL.len()] = {
    let mut words = [Word::new("", composition::ORDER_2); composition::ALL.len()];
    let mut i = 0;
    while i < words.len() {
        words[i] = Word::new(composition::ALL[i].name, composition::ALL[i]);
        i += 1;
    }
    words
};

/// Which rule turns the bodies.
#[derive(Clone, Copy, Debug)]
pub(super) enum Turning {
    /// Moser-Veselov while that has a solution.
    Automatic,
    By(Rotation),
}

pub(super) static ROTATION: Choice<Turning> = Choice {
    name: "rotation",
    words: &[
        Word::new("auto", Turning::Automatic),
        Word::new("moser_veselov", Turning::By(Rotation::MoserVeselov)),
        Word::new("splitting", Turning::By(Rotation::Splitting)),
        Word::new("cayley", Turning::By(Rotation::Cayley)),
    ],
    summary: "how bodies turn: moser_veselov is RATTLE proper, for less than about 1 rad a step, the others have no \
              such limit; auto moves a body from the first to splitting, once, when it turns too fast",
};

pub(super) static METHOD: Choice<&'static Facts> =
    Choice { name: "method", words: &METHOD_WORDS, summary: "the map of one step" };

const METHOD_WORDS: [Word<&'static Facts>; METHODS.len()] = {
    let mut words = [Word::new("", &METHODS[0]); METHODS.len()];
    let mut i = 0;
    while i < words.len() {
        words[i] = Word::meaning(METHODS[i].name, METHODS[i].summary, &METHODS[i]);
        i += 1;
    }
    words
};

pub(super) static STAGES: Number = Number {
    name: "stages",
    min: 2.0,
    max: 5.0,
    default: 3.0,
    whole: true,
    summary: "stages of method=lobatto; with 2 it is rattle",
};

/// Where the constraint iteration ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Roundoff {
    Usual,
    Unbiased,
}

pub(super) static ROUNDOFF: Choice<Roundoff> = Choice {
    name: "roundoff",
    words: &[
        Word::meaning("usual", "ends at roundoff", Roundoff::Usual),
        Word::meaning(
            "unbiased",
            "goes on to 1e-13 of it, at half more time a step, so that what is left does not make the energy drift, by \
             some 1e-22 of its scale a solve: for order 6 and 8 over 1e7 steps and more",
            Roundoff::Unbiased,
        ),
    ],
    summary: "where the constraint iteration ends",
};

/// What follows a step that does not converge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OnFailure {
    Stop,
    Substep,
}

pub(super) static ON_FAILURE: Choice<OnFailure> = Choice {
    name: "on_failure",
    words: &[
        Word::meaning("stop", "ends the run with its reason", OnFailure::Stop),
        Word::meaning(
            "substep",
            "takes the step in halves, down to 1/1024, which is not symplectic there and is counted",
            OnFailure::Substep,
        ),
    ],
    summary: "what follows a step that does not converge",
};

/// Who chooses the steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StepChoice {
    Fixed,
    Adaptive,
}

pub(super) static STEP: Choice<StepChoice> = Choice {
    name: "step",
    words: &[
        Word::meaning("fixed", "takes the run's step", StepChoice::Fixed),
        Word::meaning(
            "adaptive",
            "takes time-reversible steps of its own, from tol, and hands out states at the run's step (not symplectic; \
             the energy error stays bounded)",
            StepChoice::Adaptive,
        ),
    ],
    summary: "",
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
pub(super) const KEYS: &[Key] = &[
    Key::Choice(&ORDER),
    Key::Choice(&METHOD),
    Key::Number(&STAGES),
    Key::Choice(&ROTATION),
    Key::Choice(&STEP),
    Key::Number(&TOL),
    Key::Choice(&ON_FAILURE),
    Key::Choice(&ROUNDOFF),
];

/// What a spec chooses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settings {
    pub composition: Composition,
    pub method: &'static Facts,
    pub stages: usize,
    pub turning: Turning,
    pub step: StepChoice,
    pub tolerance: f64,
    pub on_failure: OnFailure,
    pub roundoff: Roundoff,
}

impl Settings {
    pub(super) fn new(spec: &Values) -> Settings {
        Settings {
            composition: spec.choice(&ORDER),
            method: spec.choice(&METHOD),
            // A whole number within the range of its key.
            stages: spec.number(&STAGES) as usize,
            turning: spec.choice(&ROTATION),
            step: spec.choice(&STEP),
            tolerance: spec.number(&TOL),
            on_failure: spec.choice(&ON_FAILURE),
            roundoff: spec.choice(&ROUNDOFF),
        }
    }
}
