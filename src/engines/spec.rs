//! Engine specs, `name` or `name:key=value,key=value`, and what is made from them.

use std::fmt;

use super::engine::{Engine, Unsupported};
use super::entry::Entry;
use super::held::Held;
use super::list::{ENGINES, named};
use super::rattle;
use super::values::Values;
use crate::mechanics::System;
use crate::variational::Fault;

/// A spec that has been checked against the engine's keys.
#[derive(Clone, Debug)]
pub struct Spec {
    entry: &'static Entry,
    values: Values,
}

impl Spec {
    /// Reads `name:key=value,...` and checks name, keys and values.
    ///
    /// # Errors
    /// An unknown engine, key or value, and a key given twice; the message lists what is known.
    pub fn parse(text: &str) -> Result<Spec, SpecError> {
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        let entry = named(text).ok_or_else(|| SpecError::UnknownEngine {
            name: name.to_string(),
            known: ENGINES.iter().map(|e| e.name).collect::<Vec<_>>().join(", "),
        })?;
        let mut values = Values::none(entry.name);
        for setting in rest.split(',').filter(|_| text.contains(':')) {
            let (key_name, value) = setting
                .split_once('=')
                .ok_or_else(|| SpecError::NotASetting { spec: text.to_string(), setting: setting.to_string() })?;
            let key = entry.keys.iter().find(|k| k.name() == key_name).ok_or_else(|| SpecError::UnknownKey {
                engine: name.to_string(),
                key: key_name.to_string(),
                known: entry.keys.iter().map(|k| k.name()).collect::<Vec<_>>().join(", "),
            })?;
            if !key.accepts(value) {
                return Err(SpecError::BadValue {
                    engine: name.to_string(),
                    key: key_name.to_string(),
                    value: value.to_string(),
                    values: key.values(),
                });
            }
            if values.given(key_name).is_some() {
                return Err(SpecError::Twice { spec: text.to_string(), key: key_name.to_string() });
            }
            values.add(key_name, value);
        }
        Ok(Spec { entry, values })
    }

    pub fn entry(&self) -> &'static Entry {
        self.entry
    }

    /// Nominal time of a step of a system of so many bodies, us.
    pub(crate) fn nominal_cost(&self, bodies: usize) -> f64 {
        (self.entry.nominal_cost)(&self.values, bodies as f64)
    }
}

impl fmt::Display for Spec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.values.fmt(f)
    }
}

/// Why a spec could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SpecError {
    #[error("engine '{name}' is not known; engines are: {known}")]
    UnknownEngine { name: String, known: String },
    #[error("engine spec '{spec}': '{setting}' is not of the form key=value")]
    NotASetting { spec: String, setting: String },
    #[error("engine '{engine}' has no key '{key}'; keys are: {known}")]
    UnknownKey { engine: String, key: String, known: String },
    #[error("engine '{engine}': {key}={value} is not possible; {key} takes {values}")]
    BadValue { engine: String, key: String, value: String, values: String },
    #[error("engine spec '{spec}': key '{key}' is given twice")]
    Twice { spec: String, key: String },
}

/// Builds the engine that a spec names for a system, at its initial state, with a step size in s.
///
/// # Errors
/// The engine has no means for something that the system needs.
pub fn build(spec: &Spec, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    if let Some(part) = system.parts.kinds().find(|part| !spec.entry.parts.contains(part)) {
        return Err(Unsupported { engine: spec.to_string(), what: part.name().to_string() });
    }
    (spec.entry.build)(&spec.values, system, step)
}

/// As [`build`] for the engine `rattle`, with a planted fault, for tests of what checks catch.
///
/// # Errors
/// As [`build`].
#[doc(hidden)]
pub fn faulty(spec: &Spec, system: &System, step: f64, fault: Fault) -> Result<Box<dyn Engine>, Unsupported> {
    rattle::faulty(&spec.values, system, step, fault)
}

/// What an engine holds of a system before the first step, read back from its own data: the evidence that it simulates
/// the same system. `None` for engines that compute on the [`System`] itself, and where the engine cannot be built.
pub fn held(spec: &Spec, system: &System, step: f64) -> Option<Held> {
    spec.entry.hold.and_then(|hold| hold(&spec.values, system, step).ok())
}

/// The same engine with its constraints solved to the end, for engines whose settings leave them half solved.
pub(crate) fn converged(spec: &Spec) -> Option<Spec> {
    (spec.entry.converged)(&spec.values).and_then(|text| Spec::parse(&text).ok())
}
