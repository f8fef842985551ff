//! The bounds of one scene, checked and judged.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64};

use super::judge::{Finding, judge};
use super::requirement::{BoundError, Requirement};
use super::scope::{Scope, scoped};
use super::{run, table};
use crate::engines::{self, Unsupported};
use crate::mechanics::{CompileError, System};
use crate::model::{Bound, Scene, SceneError};
use crate::report::Report;

/// What became of the bounds of a scene.
#[derive(Clone, Debug)]
pub struct Checked {
    pub report: Report,
    /// One for each bound that was checked, in their order.
    pub findings: Vec<Finding>,
    /// Bounds that the scope left out.
    pub left_out: usize,
}

/// Why a scene could not be checked.
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error("{input}: {error}", input = input.display())]
    Compile { input: PathBuf, error: CompileError },
    #[error("{input}: {error}", input = input.display())]
    Bound { input: PathBuf, error: Box<BoundError> },
    #[error("{input}: {key}: {error}", input = input.display())]
    Unsupported { input: PathBuf, key: String, error: Unsupported },
    #[error(
        "{input}: has no bounds to check; add \"bounds\" to the scene, give them by --bounds, or let check --propose \
         measure some", input = input.display()
    )]
    NoBounds { input: PathBuf },
}

/// Checks every bound against what engines and scene know, before anything runs. `input` is where the bounds stand.
///
/// # Errors
/// The first bound that cannot be held to, with what exists instead.
pub fn requirements(input: &Path, bounds: &[Bound], system: &System) -> Result<Vec<Requirement>, CheckError> {
    let mut found = Vec::with_capacity(bounds.len());
    for (i, bound) in bounds.iter().enumerate() {
        let required = Requirement::new(&format!("bounds[{i}]"), bound)
            .map_err(|error| CheckError::Bound { input: input.to_path_buf(), error: Box::new(error) })?;
        for spec in required.engines() {
            engines::build(spec, system, required.horizon.step).map_err(|error| CheckError::Unsupported {
                input: input.to_path_buf(),
                key: required.key.clone(),
                error,
            })?;
        }
        found.push(required);
    }
    Ok(found)
}

/// Runs and judges the bounds of a scene file, as `rattlebench check` does.
///
/// # Errors
/// A scene or a bound that cannot be used.
pub fn check(path: impl AsRef<Path>, scope: Scope) -> Result<Checked, CheckError> {
    let path = path.as_ref();
    let scene = Scene::load(path)?;
    let compiled = |error| CheckError::Compile { input: path.to_path_buf(), error };
    let system = System::compile(&scene).map_err(compiled)?;
    let all = requirements(path, &scene.bounds, &system)?;
    if all.is_empty() {
        return Err(CheckError::NoBounds { input: path.to_path_buf() });
    }
    let (kept, left_out) = scoped(all, scope);
    let settings = run::Settings { jobs: 1, interrupted: &AtomicBool::new(false), taken: &AtomicU64::new(0) };
    let found = run::run(&system, &run::units(&kept), &settings);
    let report = Report::of_study(&scene, &system, &found, String::new());
    let findings = judge(&kept, &report);
    Ok(Checked { report, findings, left_out })
}

/// Checks a scene file and says what is broken.
///
/// # Panics
/// A bound is broken, or the scene cannot be checked: for use in tests.
#[track_caller]
pub fn assert_bounds(path: impl AsRef<Path>, scope: Scope) {
    match check(path, scope) {
        Ok(checked) if checked.findings.iter().all(|f| f.passed) => {}
        Ok(checked) => panic!("bounds are broken\n{}", table::text(&checked.report.scene.name, &checked.findings)),
        Err(error) => panic!("{error}"),
    }
}

/// Asserts in a test that a scene file keeps its bounds: `check!("models/arm/scene.json")`. With `quick` as a second
/// argument only bounds on runs of at most [`QUICK_STEPS`](crate::check::QUICK_STEPS) steps are checked.
#[macro_export]
macro_rules! check {
    ($scene:expr) => {
        $crate::check::assert_bounds($scene, $crate::check::Scope::All)
    };
    ($scene:expr, quick) => {
        $crate::check::assert_bounds($scene, $crate::check::Scope::Quick)
    };
}
