//! What `rattlebench cost` writes: `cost.json`, `cost.png` and a page.

use std::path::{Path, PathBuf};

use maud::html;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::charts::cost as chart;
use super::environment;
use super::files::{WriteError, prepare, write_whole};
use super::number::{plain, short};
use super::page::{self, Picture};
use super::record::{Machine, Versions};
use super::summary::Words;
use crate::measure::scaling::Point;

/// Name and version of `cost.json`.
pub const SCHEMA: &str = "rattlebench/cost/1";

/// Processor time a step of several engines on chains of several lengths.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cost {
    pub schema: String,
    pub machine: Machine,
    pub versions: Versions,
    pub command: String,
    /// The chains, in words.
    pub model: String,
    pub step_s: f64,
    /// Simulated time that was stepped through, s; less where the steps take long.
    pub timed_s: f64,
    pub points: Vec<CostPoint>,
}

/// One engine on one chain; median, smallest and largest over the rounds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CostPoint {
    pub engine: String,
    pub links: usize,
    pub us_per_step: f64,
    pub us_per_step_min: f64,
    pub us_per_step_max: f64,
}

impl Cost {
    pub fn new(points: &[Point], model: String, step_s: f64, timed_s: f64, command: String) -> Cost {
        let point = |p: &Point| CostPoint {
            engine: p.engine.clone(),
            links: p.links,
            us_per_step: 1e6 * p.timing.median,
            us_per_step_min: 1e6 * p.timing.min,
            us_per_step_max: 1e6 * p.timing.max,
        };
        Cost {
            schema: SCHEMA.to_string(),
            machine: environment::machine(),
            versions: environment::versions(),
            command,
            model,
            step_s,
            timed_s,
            points: points.iter().map(point).collect(),
        }
    }

    /// One row an engine, one column a number of links, µs a step; last the growth over the two longest chains.
    pub fn table(&self) -> Words {
        let mut links: Vec<usize> = self.points.iter().map(|p| p.links).collect();
        links.sort_unstable();
        links.dedup();
        let find = |engine: &str, n: usize| self.points.iter().find(|p| p.engine == engine && p.links == n);
        let rows = self.points.chunk_by(|a, b| a.engine == b.engine).map(|points| {
            let engine = &points[0].engine;
            let cells = links.iter().map(|&n| find(engine, n).map_or("–".to_string(), |p| plain(p.us_per_step, 3)));
            let growth = growth(points).map_or("–".to_string(), |power| plain(power, 2));
            std::iter::once(engine.clone()).chain(cells).chain([growth]).collect()
        });
        let head = std::iter::once("µs a step, links:".to_string());
        let columns = links.iter().map(usize::to_string).chain(["grows like n^".to_string()]);
        Words { head: head.chain(columns).collect(), rows: rows.collect() }
    }

    /// Writes the folder and returns the page's path.
    ///
    /// # Errors
    /// A chart that cannot be drawn, a file that cannot be written.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, WriteError> {
        prepare(folder)?;
        write_whole(&folder.join("cost.json"), (serde_json::to_string(self)? + "\n").as_bytes())?;
        self.draw(folder)
    }

    /// Writes the chart and the page, and returns the page's path.
    ///
    /// # Errors
    /// As for [`write`](Self::write).
    pub fn draw(&self, folder: &Path) -> Result<PathBuf, WriteError> {
        prepare(folder)?;
        let mut pictures = Vec::new();
        if let Some(png) = chart::draw(self)? {
            write_whole(&folder.join(chart::FILE), &png)?;
            pictures.push(Picture { caption: chart::CAPTION, png });
        }
        let index = folder.join("index.html");
        write_whole(&index, self.html(&pictures).as_bytes())?;
        Ok(index)
    }

    fn html(&self, pictures: &[Picture]) -> String {
        let body = html! {
            p.description { (self.model) }
            @for picture in pictures { (page::figure(picture)) }
            (page::words(&self.table()))
            p.small {
                "CPU time of the stepping alone at a step of " (short(self.step_s)) " s, on one thread, engines in turns, median of \
                 the rounds, over the first " (plain(self.timed_s, 4)) " s or the part of it that takes 0.4 s."
            }
            (page::machine_list(&self.machine))
            (page::version_list(&self.versions))
            (page::command_line(&self.command))
        };
        page::document("Cost of a step", body)
    }
}

/// The power of the number of links that the time grows with between the two longest chains.
fn growth(points: &[CostPoint]) -> Option<f64> {
    let [.., a, b] = points else { return None };
    Some((b.us_per_step / a.us_per_step).ln() / (b.links as f64 / a.links as f64).ln())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_saved_cost_is_read_back_and_drawn_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let timing = crate::measure::clock::Timing {
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
        cost.write(folder.path()).expect("written");
        let read = |name: &str| std::fs::read(folder.path().join(name)).expect("read");
        let again: Cost = serde_json::from_slice(&read("cost.json")).expect("a cost");
        assert_eq!(again, cost);
        let (png, page) = (read("cost.png"), read("index.html"));
        std::fs::remove_file(folder.path().join("cost.png")).expect("removed");
        again.draw(folder.path()).expect("drawn");
        assert_eq!((read("cost.png"), read("index.html")), (png, page));
    }

    #[test]
    fn time_that_grows_with_the_square_is_seen() {
        let point = |links: usize, us_per_step: f64| CostPoint {
            engine: "e".into(),
            links,
            us_per_step,
            us_per_step_min: us_per_step,
            us_per_step_max: us_per_step,
        };
        let points = [point(1, 5.0), point(10, 50.0), point(20, 200.0)];
        assert!((growth(&points).expect("two points") - 2.0).abs() < 1e-12);
        assert_eq!(growth(&points[..1]), None);
    }
}
