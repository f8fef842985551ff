//! Bounds: what figures of a run must keep to, in a scene file or in a file of their own.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::{SceneError, SceneProblem, positive};
use super::json::read_json;

/// What a figure of a run must keep to.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// Engine spec, as written.
    pub engine: String,
    /// s
    pub step: f64,
    /// s
    pub duration: f64,
    /// Path of the figure in a report's run, such as `energy.max_relative_error`.
    pub metric: String,
    /// Engine that a ratio is taken against.
    pub against: Option<String>,
    pub max: Option<Limit>,
    pub min: Option<Limit>,
}

/// An end of a bound: a number, or a word for a figure that is one, such as a verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "a number, or a verdict in quotes")]
pub enum Limit {
    Number(f64),
    Word(String),
}

/// A file of bounds.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoundsFile {
    pub bounds: Vec<BoundFile>,
}

/// What a figure of a run must keep to; `max`, `min` or both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("anyOf" = [{ "required": ["max"] }, { "required": ["min"] }]))]
pub struct BoundFile {
    /// Engine spec, such as `rattle` or `rapier:joints=multibody`.
    pub engine: String,
    /// s
    pub step: f64,
    /// s
    pub duration: f64,
    /// Path of the figure in a report's run, such as `energy.max_relative_error`; `list metrics` prints them.
    pub metric: String,
    /// Engine spec that `time.us_per_step_ratio` is taken against.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub against: Option<String>,
    /// Number, or verdict for `energy.verdict`: bounded, random_walk, drift or blow_up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<Limit>,
    /// As `max`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<Limit>,
}

/// Reads `{"bounds": [...]}`.
///
/// # Errors
/// A file that cannot be read, is no JSON or not of this form, or a bound without an end or with an impossible step.
pub(crate) fn read_bounds(path: &Path) -> Result<Vec<Bound>, SceneError> {
    let file: BoundsFile = read_json(path)?;
    let resolved = file.bounds.iter().enumerate().map(|(i, bound)| resolve(&format!("bounds[{i}]"), bound));
    resolved.collect::<Result<Vec<Bound>, SceneProblem>>().map_err(|problem| SceneError::of(path, problem))
}

/// Checks a bound; `key` reads like `bounds[0]`.
pub(super) fn resolve(key: &str, file: &BoundFile) -> Result<Bound, SceneProblem> {
    if file.max.is_none() && file.min.is_none() {
        let why = "a bound needs \"max\", \"min\" or both";
        return Err(SceneProblem::MissingKey { key: key.to_owned(), missing: "max", why });
    }
    Ok(Bound {
        engine: file.engine.clone(),
        step: positive(&format!("{key}.step"), "s", file.step)?,
        duration: positive(&format!("{key}.duration"), "s", file.duration)?,
        metric: file.metric.clone(),
        against: file.against.clone(),
        max: file.max.clone(),
        min: file.min.clone(),
    })
}
