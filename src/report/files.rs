//! Writes a report's folder. Files are written whole or not at all.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::charts::{CHARTS, ChartError};
use super::{Report, page};

/// Why a file or folder could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    #[error("{}: cannot be written: {error}", path.display())]
    File { path: PathBuf, error: io::Error },
    #[error("{}: the folder cannot be made: {error}", path.display())]
    Folder { path: PathBuf, error: io::Error },
    #[error("{}: no files can be made in this folder: {error}", path.display())]
    NotWritable { path: PathBuf, error: io::Error },
    #[error(transparent)]
    Chart(#[from] ChartError),
    #[error("the report cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

/// Makes a folder if need be and tries that files can be made in it, so that a bad path is found before a long run.
///
/// # Errors
/// A folder that cannot be made or written to.
pub fn prepare(folder: &Path) -> Result<(), WriteError> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    fs::create_dir_all(folder).map_err(|error| WriteError::Folder { path: folder.to_path_buf(), error })?;
    tempfile::NamedTempFile::new_in(folder)
        .map(drop)
        .map_err(|error| WriteError::NotWritable { path: folder.to_path_buf(), error })
}

/// Writes bytes to a temporary file beside `path` and renames it.
///
/// # Errors
/// The file cannot be made, written or renamed.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let written = || -> io::Result<()> {
        let mut file = temporary_beside(path)?;
        file.write_all(bytes)?;
        file.persist(path)?;
        Ok(())
    };
    written().map_err(|error| WriteError::File { path: path.to_path_buf(), error })
}

/// A temporary file in the folder of `path`, which others may read as far as the umask lets them.
///
/// # Errors
/// The folder is not there or not writable.
pub fn temporary_beside(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")))
}

/// Writes `report.json`, the charts and the page, and returns the page's path.
///
/// # Errors
/// A chart that cannot be drawn, a file that cannot be written.
pub fn write(report: &Report, folder: &Path) -> Result<PathBuf, WriteError> {
    prepare(folder)?;
    write_whole(&folder.join("report.json"), report.to_json()?.as_bytes())?;
    draw(report, folder)
}

/// Writes the charts that have something to show and `index.html`, and returns the page's path. A chart of an earlier
/// report that this one does not have is removed.
///
/// # Errors
/// A chart that cannot be drawn, a file that cannot be written.
pub fn draw(report: &Report, folder: &Path) -> Result<PathBuf, WriteError> {
    prepare(folder)?;
    let mut pictures = Vec::new();
    for chart in &CHARTS {
        let path = folder.join(chart.file);
        match (chart.draw)(report)? {
            Some(png) => {
                write_whole(&path, &png)?;
                pictures.push(page::Picture { caption: chart.caption, png });
            }
            None if path.exists() => fs::remove_file(&path).map_err(|error| WriteError::File { path, error })?,
            None => {}
        }
    }
    let page = folder.join("index.html");
    write_whole(&page, page::html(report, &pictures).as_bytes())?;
    Ok(page)
}
