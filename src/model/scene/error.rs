//! Why a scene could not be read: file, key, value and remedy in one line.

use std::path::Path;

use crate::model::names::known;
use crate::model::urdf::{ModelError, Position, Problem};

/// Why a scene could not be read.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The URDF is wrong.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The scene file is no JSON, or not of the form of a scene.
    #[error("{file}:{position}: {detail}; `rattlebench schema scene` prints what a scene may hold")]
    Json { file: String, position: Position, detail: String },
    /// The scene file says something that cannot be.
    #[error("{file}: {problem}")]
    Scene { file: String, problem: Box<SceneProblem> },
}

impl SceneError {
    pub(super) fn of(path: &Path, problem: SceneProblem) -> Self {
        SceneError::Scene { file: path.display().to_string(), problem: Box::new(problem) }
    }
}

/// What is wrong with a scene. `key` reads like `springs[0].stiffness`.
#[derive(Debug, thiserror::Error)]
pub enum SceneProblem {
    #[error(transparent)]
    File(Problem),
    #[error("is neither a .urdf file nor a scene .json file; give one of these")]
    UnknownExtension,
    #[error("model '{model}' is not found at {path}; the path is relative to the scene file")]
    ModelMissing { model: String, path: String },
    #[error("{key} must be > 0{}, got {value}", unit_text(.unit))]
    NotPositive { key: String, unit: &'static str, value: f64 },
    #[error("{key} must be >= 0{}, got {value}", unit_text(.unit))]
    Negative { key: String, unit: &'static str, value: f64 },
    #[error("{key}: joint '{joint}' is not defined; {}", known("joints", .joint, .joints))]
    UnknownJoint { key: String, joint: String, joints: Vec<String> },
    #[error("{key}: link '{link}' is not defined; {}, and world", known("links", .link, .links))]
    UnknownLink { key: String, link: String, links: Vec<String> },
    #[error("{key}: joint '{joint}' is fixed and has no coordinates; remove it here")]
    FixedJoint { key: String, joint: String },
    #[error(
        "{key}: joint '{joint}' is {kind} and takes {expected} number{}, got {got}",
        if *.expected == 1 { "" } else { "s" }
    )]
    CoordinateCount { key: String, joint: String, kind: &'static str, expected: usize, got: usize },
    #[error("{key}: joint '{joint}' is {kind}; it must be revolute, continuous or prismatic")]
    NotOneCoordinate { key: String, joint: String, kind: &'static str },
    #[error("initial.base.quaternion_wxyz has length {length}; write a quaternion of length 1")]
    NotUnitQuaternion { length: f64 },
    #[error("initial.base is given, but the base is fixed; add \"base\": \"floating\" or remove initial.base")]
    FixedBaseMoves,
    #[error(
        "base is floating, but the root link 'world' is the ground; use \"base\": \"fixed\", or name the root otherwise"
    )]
    WorldFloats,
    #[error("steps is empty; list at least one step in s, or leave it out")]
    NoSteps,
    #[error("{key}: {missing} is missing; {why}")]
    MissingKey { key: String, missing: &'static str, why: &'static str },
    #[error("{key}: {extra} does not go with {with}; remove it")]
    ExtraKey { key: String, extra: &'static str, with: &'static str },
    #[error("{key}.axis is 0 0 0; give it a direction such as [0, 0, 1]")]
    ZeroAxis { key: String },
    #[error("{key}: both ends are on '{link}'; name two links that move against each other")]
    SameLink { key: String, link: String },
    #[error("{key}: name '{name}' is used before; rename one of them")]
    DuplicateLoop { key: String, name: String },
}

fn unit_text(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// Passes a finite number above zero. `unit` may be empty.
///
/// # Errors
/// `{key} must be > 0 {unit}, got {value}`, for NaN and infinity as well.
pub fn positive(key: &str, unit: &'static str, value: f64) -> Result<f64, SceneProblem> {
    let fits = value.is_finite() && value > 0.0;
    if fits { Ok(value) } else { Err(SceneProblem::NotPositive { key: key.to_owned(), unit, value }) }
}

/// Passes a finite number that is not below zero.
pub(in crate::model) fn not_negative(key: &str, unit: &'static str, value: f64) -> Result<f64, SceneProblem> {
    let fits = value.is_finite() && value >= 0.0;
    if fits { Ok(value) } else { Err(SceneProblem::Negative { key: key.to_owned(), unit, value }) }
}
