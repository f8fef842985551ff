//! The folder of a report: `report.json`, the charts and the page.

use std::fs;
use std::path::{Path, PathBuf};

use super::files::{WriteError, prepare, write_whole};
use crate::report::Report;
use crate::report::charts::CHARTS;
use crate::report::page::{self, document::Picture};

/// Writes `report.json`, the charts and the page, and returns the page's path.
///
/// # Errors
/// A chart that cannot be drawn, a file that cannot be written.
pub(crate) fn write(report: &Report, folder: &Path) -> Result<PathBuf, WriteError> {
    prepare(folder)?;
    write_whole(&folder.join("report.json"), report.to_json()?.as_bytes())?;
    draw(report, folder)
}

/// Writes the charts that have something to show and `index.html`, and returns the page's path. A chart of an earlier
/// report that this one does not have is removed.
///
/// # Errors
/// A chart that cannot be drawn, a file that cannot be written.
pub(crate) fn draw(report: &Report, folder: &Path) -> Result<PathBuf, WriteError> {
    prepare(folder)?;
    let mut pictures = Vec::new();
    for chart in &CHARTS {
        let path = folder.join(chart.file);
        match (chart.draw)(report)? {
            Some(png) => {
                write_whole(&path, &png)?;
                pictures.push(Picture { caption: chart.caption, png });
            }
            None if path.exists() => fs::remove_file(&path).map_err(|error| WriteError::File { path, error })?,
            None => {}
        }
    }
    let page = folder.join("index.html");
    write_whole(&page, page::report::html(report, &pictures).as_bytes())?;
    Ok(page)
}
