//! What `rattlebench cost` writes: `cost.json`, `cost.png` and a page.

use std::path::{Path, PathBuf};

use super::files::{WriteError, prepare, write_whole};
use crate::report::charts::cost as chart;
use crate::report::page::{self, document::Picture};
use crate::report::record::cost::Cost;

/// Writes the folder and returns the page's path.
///
/// # Errors
/// A chart that cannot be drawn, a file that cannot be written.
pub(crate) fn write(cost: &Cost, folder: &Path) -> Result<PathBuf, WriteError> {
    prepare(folder)?;
    write_whole(&folder.join("cost.json"), (serde_json::to_string(cost)? + "\n").as_bytes())?;
    draw(cost, folder)
}

/// Writes the chart and the page, and returns the page's path.
///
/// # Errors
/// As for [`write`].
pub(crate) fn draw(cost: &Cost, folder: &Path) -> Result<PathBuf, WriteError> {
    prepare(folder)?;
    let mut pictures = Vec::new();
    if let Some(png) = chart::draw(cost)? {
        write_whole(&folder.join(chart::FILE), &png)?;
        pictures.push(Picture { caption: chart::CAPTION, png });
    }
    let index = folder.join("index.html");
    write_whole(&index, page::cost::html(cost, &pictures).as_bytes())?;
    Ok(index)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::cost::scaling::Point;

    #[test]
    fn a_saved_cost_is_read_back_and_drawn_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let timing = crate::measure::cost::clock::Timing {
            median: 2e-6,
            low: 1e-6,
            min: 1e-6,
            max: 3e-6,
            rounds: 5,
            steps: 10,
            passes: 1,
        };
        let points = [1, 10].map(|links| Point { engine: "rattle".into(), links, timing });
        let cost = Cost::new(&points, "chains".into(), 1e-3, 0.2, "rattlebench cost".into());
        write(&cost, folder.path()).expect("written");
        let read = |name: &str| std::fs::read(folder.path().join(name)).expect("read");
        let again: Cost = serde_json::from_slice(&read("cost.json")).expect("a cost");
        assert_eq!(again, cost);
        let (png, page) = (read("cost.png"), read("index.html"));
        std::fs::remove_file(folder.path().join("cost.png")).expect("removed");
        draw(&again, folder.path()).expect("drawn");
        assert_eq!((read("cost.png"), read("index.html")), (png, page));
    }
}
