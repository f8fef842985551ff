//! Scenes and options that several subcommands read.

use std::path::{Path, PathBuf};

use super::CliError;
use crate::engines::{Role, Spec, line_up};
use crate::mechanics::System;
use crate::model::Scene;

/// Reads a scene.
pub fn scene(path: &Path) -> Result<Scene, CliError> {
    Ok(Scene::load(path)?)
}

/// Compiles a scene that was read from `path`.
pub fn system(path: &Path, scene: &Scene) -> Result<System, CliError> {
    System::compile(scene).map_err(|error| CliError::Compile { input: path.to_path_buf(), error })
}

/// Reads specs, none twice.
pub fn specs<T: AsRef<str>>(texts: &[T]) -> Result<Vec<Spec>, CliError> {
    let mut specs: Vec<Spec> = Vec::new();
    for text in texts {
        let spec = Spec::parse(text.as_ref())?;
        if !specs.iter().any(|other| other.to_string() == spec.to_string()) {
            specs.push(spec);
        }
    }
    Ok(specs)
}

/// Help of an option that names engines, with those of a line-up as its default.
pub(crate) fn engine_help(role: Role) -> String {
    format!(
        "Engine, such as rapier:joints=multibody,precision=f64; may be given several times [default: {}]",
        line_up(role).join(", ")
    )
}

/// The scenes `*/scene.json` in a folder, by name.
pub fn shipped(models: &Path) -> Result<Vec<PathBuf>, CliError> {
    let failed = |error| CliError::Read { path: models.to_path_buf(), error };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(models).map_err(failed)? {
        let file = entry.map_err(failed)?.path().join("scene.json");
        if file.is_file() {
            files.push(file);
        }
    }
    files.sort();
    Ok(files)
}

/// A time that must be positive and finite.
pub fn positive(option: &'static str, value: f64) -> Result<f64, CliError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(CliError::NotPositive { option, value }) }
}

/// The command line as a shell would take it.
pub(crate) fn command_line() -> String {
    let arguments = std::env::args().skip(1).map(|argument| quoted(&argument));
    std::iter::once("rattlebench".to_string()).chain(arguments).collect::<Vec<_>>().join(" ")
}

fn quoted(argument: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,+@%".contains(c);
    if !argument.is_empty() && argument.chars().all(plain) {
        argument.to_string()
    } else {
        format!("'{}'", argument.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_quoted_where_a_shell_needs_it() {
        assert_eq!(quoted("rapier:joints=multibody,precision=f64"), "rapier:joints=multibody,precision=f64");
        assert_eq!(quoted("my scene.json"), "'my scene.json'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }
}
