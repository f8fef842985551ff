//! The keys of a rapier spec and what they set.

use super::super::{Choice, Key, Number, Spec};

static JOINTS: Choice = Choice {
    name: "joints",
    words: &["impulse", "multibody"],
    summary: "impulse: velocity constraints, solved iteratively; multibody: reduced coordinates",
};

static PRECISION: Choice =
    Choice { name: "precision", words: &["f32", "f64"], summary: "floating point type; f64 with preset=strong" };

static PRESET: Choice = Choice {
    name: "preset",
    words: &["default", "strong"],
    summary: "strong: precision=f64,substeps=1,iterations=4,stabilization=0; other keys override it",
};

static SUBSTEPS: Number = Number {
    name: "substeps",
    min: 1.0,
    max: 1e4,
    default: 4.0,
    whole: true,
    summary: "num_solver_iterations: substeps that each step is divided into",
};

static ITERATIONS: Number = Number {
    name: "iterations",
    min: 1.0,
    max: 1e6,
    default: 1.0,
    whole: true,
    summary: "num_internal_pgs_iterations: Gauss-Seidel sweeps a substep; impulse joints only",
};

static STABILIZATION: Number = Number {
    name: "stabilization",
    min: 0.0,
    max: 1e6,
    default: 1.0,
    whole: true,
    summary: "num_internal_stabilization_iterations: sweeps a substep without position correction; impulse joints only",
};

static SOFTNESS: Number = Number {
    name: "softness_hz",
    min: 1e-3,
    max: 1e12,
    default: 1e6,
    whole: false,
    summary: "natural frequency of a joint's position correction, Hz; impulse joints only",
};

static DAMPING_RATIO: Number = Number {
    name: "damping_ratio",
    min: 0.0,
    max: 1e6,
    default: 1.0,
    whole: false,
    summary: "damping ratio of a joint's position correction; impulse joints only",
};

static GYRO: Choice = Choice {
    name: "gyro",
    words: &["on", "off"],
    summary: "gyroscopic torque of each body; a multibody always has it",
};

static WARMSTART: Choice = Choice {
    name: "warmstart",
    words: &["off", "on"],
    summary: "start joint impulses from the last ones; without joint limits the result is the same to roundoff",
};

/// In the order of the help text.
pub(super) static KEYS: &[Key] = &[
    Key::Choice(&JOINTS),
    Key::Choice(&PRECISION),
    Key::Choice(&PRESET),
    Key::Number(&SUBSTEPS),
    Key::Number(&ITERATIONS),
    Key::Number(&STABILIZATION),
    Key::Number(&SOFTNESS),
    Key::Number(&DAMPING_RATIO),
    Key::Choice(&GYRO),
    Key::Choice(&WARMSTART),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Precision {
    Single,
    Double,
}

/// What a spec sets, with the preset's values where it does not.
#[derive(Clone, Debug)]
pub(super) struct Settings {
    /// The spec as written, for messages.
    pub spec: String,
    pub multibody: bool,
    pub precision: Precision,
    pub substeps: usize,
    pub iterations: usize,
    pub stabilization: usize,
    /// Hz
    pub softness: f64,
    pub damping_ratio: f64,
    pub gyro: bool,
    pub warmstart: bool,
}

impl Settings {
    pub(super) fn new(spec: &Spec) -> Settings {
        let strong = spec.word(&PRESET) == "strong";
        let precision = match spec.given(PRECISION.name) {
            None if strong => "f64",
            _ => spec.word(&PRECISION),
        };
        // Whole numbers within the keys' ranges, so the conversions are exact.
        let count =
            |key: &'static Number, preset: f64| spec.number_or(key, if strong { preset } else { key.default }) as usize;
        Settings {
            spec: spec.to_string(),
            multibody: spec.word(&JOINTS) == "multibody",
            precision: if precision == "f64" { Precision::Double } else { Precision::Single },
            substeps: count(&SUBSTEPS, 1.0),
            iterations: count(&ITERATIONS, 4.0),
            stabilization: count(&STABILIZATION, 0.0),
            softness: spec.number(&SOFTNESS),
            damping_ratio: spec.number(&DAMPING_RATIO),
            gyro: spec.word(&GYRO) == "on",
            warmstart: spec.word(&WARMSTART) == "on",
        }
    }
}
