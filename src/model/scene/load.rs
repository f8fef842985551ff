//! Scenes from files.

use std::path::Path;

use super::data::Scene;
use super::error::{SceneError, SceneProblem, positive};
use super::file::SceneFile;
use super::json::read_json;
use super::resolve;
use crate::model::urdf::{read_urdf, read_urdf_with_density};

impl Scene {
    /// Reads a scene `.json` file, or a `.urdf` file as a scene with defaults: fixed base, everything at rest at zero.
    ///
    /// # Errors
    /// A file that is neither, or that says something impossible; the message names file, element, value and remedy.
    pub fn load(path: impl AsRef<Path>) -> Result<Scene, SceneError> {
        let path = path.as_ref();
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "urdf" => {
                let name = path.file_stem().unwrap_or_default().to_string_lossy();
                Ok(Scene::of_model(&name, read_urdf(path)?))
            }
            "json" => load_scene(path),
            _ => Err(SceneError::of(path, SceneProblem::UnknownExtension)),
        }
    }
}

/// Reads a scene `.json` file and the URDF that it names.
fn load_scene(path: &Path) -> Result<Scene, SceneError> {
    let file: SceneFile = read_json(path)?;
    let urdf = path.parent().unwrap_or(Path::new("")).join(&file.model);
    let fault = |problem| SceneError::of(path, problem);
    if !urdf.is_file() {
        let at = urdf.display().to_string();
        return Err(fault(SceneProblem::ModelMissing { model: file.model, path: at }));
    }
    let density = file.density.map(|d| positive("density", "kg/m^3", d)).transpose().map_err(fault)?;
    let model = read_urdf_with_density(&urdf, density)?;
    resolve::scene(file, &name_of(path), model).map_err(fault)
}

/// The folder of a `scene.json`, the stem of any other file.
fn name_of(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let absolute = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    match absolute.parent().and_then(Path::file_name) {
        Some(folder) if stem == "scene" => folder.to_string_lossy().into_owned(),
        _ => stem,
    }
}
