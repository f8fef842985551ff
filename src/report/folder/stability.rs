//! The folder of a stability suite: `stability.json`, a map for each family, and a page that says where borders lie.
//!
//! Everything is drawn from the JSON alone.

use std::path::{Path, PathBuf};

use super::files::{WriteError, prepare, write_whole};
use crate::report::charts::stability_map;
use crate::report::page::{self, document::Picture};
use crate::report::record::stability::StabilityReport;

/// Writes `stability.json`, the maps and the page, and returns the page's path.
///
/// # Errors
/// A map that cannot be drawn, a file that cannot be written.
pub(crate) fn write(report: &StabilityReport, folder: &Path) -> Result<PathBuf, WriteError> {
    prepare(folder)?;
    write_whole(&folder.join("stability.json"), report.to_json()?.as_bytes())?;
    draw(report, folder)
}

/// Writes `stability_<family>.png` for each family and `index.html`, and returns the page's path.
///
/// # Errors
/// A map that cannot be drawn, a file that cannot be written.
pub(crate) fn draw(report: &StabilityReport, folder: &Path) -> Result<PathBuf, WriteError> {
    prepare(folder)?;
    let mut pictures = Vec::new();
    for family in &report.results {
        let png = stability_map::draw(family)?;
        write_whole(&folder.join(format!("stability_{}.png", family.name)), &png)?;
        pictures.push(Picture {
            caption: "Class of every cell: the parameter to the right, the step upwards, a column an engine",
            png,
        });
    }
    let page = folder.join("index.html");
    write_whole(&page, page::stability::html(report, &pictures).as_bytes())?;
    Ok(page)
}
