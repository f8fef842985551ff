//! The table of `cost`: processor time a step of every engine at every length.

use super::number::plain;
use super::summary::Words;
use crate::report::record::cost::{Cost, CostPoint};

/// One row an engine, one column a number of links, µs a step; last the growth over the two longest chains.
pub fn table(cost: &Cost) -> Words {
    let mut links: Vec<usize> = cost.points.iter().map(|p| p.links).collect();
    links.sort_unstable();
    links.dedup();
    let find = |engine: &str, n: usize| cost.points.iter().find(|p| p.engine == engine && p.links == n);
    let rows = cost.points.chunk_by(|a, b| a.engine == b.engine).map(|points| {
        let engine = &points[0].engine;
        let cells = links.iter().map(|&n| find(engine, n).map_or("–".to_string(), |p| plain(p.us_per_step, 3)));
        let growth = growth(points).map_or("–".to_string(), |power| plain(power, 2));
        std::iter::once(engine.clone()).chain(cells).chain([growth]).collect()
    });
    let head = std::iter::once("µs a step, links:".to_string());
    let columns = links.iter().map(usize::to_string).chain(["grows like n^".to_string()]);
    Words { head: head.chain(columns).collect(), rows: rows.collect() }
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
