//! Files of JSON, with errors that name place and key.

use std::path::Path;

use super::error::{SceneError, SceneProblem};
use crate::model::urdf::{Position, read_text};

/// A file of JSON, nothing before or after it.
pub(super) fn read_json<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, SceneError> {
    let text = read_text(path).map_err(|problem| SceneError::of(path, SceneProblem::File(problem)))?;
    let mut json = serde_json::Deserializer::from_str(&text);
    let file = serde_path_to_error::deserialize(&mut json).map_err(|e| {
        let key = e.path().to_string();
        json_error(path, &key, e.inner())
    })?;
    json.end().map_err(|e| json_error(path, ".", &e))?;
    Ok(file)
}

/// serde_json's own message, with its place put in front and in the words of JSON instead of those of Rust. `key` is
/// `.` for the file as a whole.
fn json_error(path: &Path, key: &str, error: &serde_json::Error) -> SceneError {
    let place = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let position = Position { line: place(error.line()), column: place(error.column()) };
    let mut detail = error.to_string();
    let suffix = format!(" at line {} column {}", error.line(), error.column());
    detail.truncate(detail.strip_suffix(&suffix).unwrap_or(&detail).len());
    for (rust, json) in [(" field ", " key "), ("variant", "value"), ("f64", "a number"), ("`", "'")] {
        detail = detail.replace(rust, json);
    }
    if key != "." {
        detail = format!("{key}: {detail}");
    }
    SceneError::Json { file: path.display().to_string(), position, detail }
}
