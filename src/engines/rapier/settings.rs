//! The keys of a rapier spec and what they set.

use crate::engines::key::{Choice, Key, Number, Word};
use crate::engines::values::Values;

static JOINTS: Choice<Joints> = Choice {
    name: "joints",
    words: &[Word::new("impulse", Joints::Impulse), Word::new("multibody", Joints::Multibody)],
    summary: "impulse: velocity constraints, solved iteratively; multibody: reduced coordinates",
};

static PRECISION: Choice<Precision> = Choice {
    name: "precision",
    words: &[Word::new("f32", Precision::Single), Word::new("f64", Precision::Double)],
    summary: "floating point type; f64 with preset=strong",
};

static PRESET: Choice<Preset> = Choice {
    name: "preset",
    words: &[Word::new("default", Preset::Default), Word::new("strong", Preset::Strong)],
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

static GYRO: Choice<bool> = Choice {
    name: "gyro",
    words: &[Word::new("on", true), Word::new("off", false)],
    summary: "gyroscopic torque of each body; a multibody always has it",
};

static WARMSTART: Choice<bool> = Choice {
    name: "warmstart",
    words: &[Word::new("off", false), Word::new("on", true)],
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
pub(super) enum Joints {
    Impulse,
    Multibody,
}

impl Joints {
    /// Whether the joints' coordinates are what rapier advances, and constraints leave nothing to solve.
    pub(super) fn are_coordinates(self) -> bool {
        match self {
            Joints::Impulse => false,
            Joints::Multibody => true,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Precision {
    Single,
    Double,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Preset {
    Default,
    Strong,
}

impl Preset {
    fn precision(self) -> Precision {
        match self {
            Preset::Default => Precision::Single,
            Preset::Strong => Precision::Double,
        }
    }

    /// The default of a whole number.
    fn count(self, key: &Number, strong: f64) -> f64 {
        match self {
            Preset::Default => key.default,
            Preset::Strong => strong,
        }
    }
}

/// What a spec sets, with the preset's values where it does not.
#[derive(Clone, Debug)]
pub(super) struct Settings {
    /// The spec as written, for messages.
    pub spec: String,
    pub joints: Joints,
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
    pub(super) fn new(spec: &Values) -> Settings {
        let preset = spec.choice(&PRESET);
        let precision = match spec.given(PRECISION.name) {
            Some(_) => spec.choice(&PRECISION),
            None => preset.precision(),
        };
        // Whole numbers within the keys' ranges, so the conversions are exact.
        let count = |key: &Number, strong: f64| spec.number_or(key, preset.count(key, strong)) as usize;
        Settings {
            spec: spec.to_string(),
            joints: spec.choice(&JOINTS),
            precision,
            substeps: count(&SUBSTEPS, 1.0),
            iterations: count(&ITERATIONS, 4.0),
            stabilization: count(&STABILIZATION, 0.0),
            softness: spec.number(&SOFTNESS),
            damping_ratio: spec.number(&DAMPING_RATIO),
            gyro: spec.choice(&GYRO),
            warmstart: spec.choice(&WARMSTART),
        }
    }
}
