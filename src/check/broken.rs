//! Charts of broken bounds.

use std::path::Path;

use super::judge::Finding;
use super::session_error::SessionError;
use crate::report::Report;
use crate::report::charts::broken_bound::{self, Broken};
use crate::report::folder::files::{WriteError, write_whole};
use crate::report::record::run::Run;

/// A chart of every broken bound in a folder, and the paths; charts of an earlier check are removed.
pub(super) fn draw(
    scene: &str,
    folder: &Path,
    report: &Report,
    findings: &[Finding],
) -> Result<Vec<String>, SessionError> {
    remove_earlier(folder).map_err(|error| SessionError::Folder { path: folder.to_path_buf(), error })?;
    let mut paths = Vec::new();
    for finding in findings.iter().filter(|f| !f.passed) {
        let r = &finding.requirement;
        let of = |run: &&Run| {
            run.engine == r.engine.to_string() && run.step_s == r.horizon.step && run.steps == r.horizon.steps
        };
        let Some(run) = report.runs.iter().find(of) else { continue };
        let broken = Broken {
            scene,
            metric: r.metric.name,
            unit: r.metric.unit,
            measured: &finding.measured_text(),
            required: &r.limits(),
            figure: finding.measured,
            max: r.max,
            min: r.min,
        };
        let number: String = r.key.chars().filter(char::is_ascii_digit).collect();
        let path = folder.join(format!("broken_{number}_{}.png", r.metric.name.replace('.', "_")));
        write_whole(&path, &broken_bound::draw(run, &broken).map_err(WriteError::from)?)?;
        paths.push(path.display().to_string());
    }
    Ok(paths)
}

fn remove_earlier(folder: &Path) -> std::io::Result<()> {
    for old in std::fs::read_dir(folder)?.flatten() {
        if old.file_name().to_string_lossy().starts_with("broken_") {
            std::fs::remove_file(old.path())?;
        }
    }
    Ok(())
}
