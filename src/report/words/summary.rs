//! What an accuracy costs, and how errors fall with the step: the tables of the sweep, for the terminal and the page.

use super::number::{duration, plain, power_of_ten, short};
use crate::engines::tolerance;
use crate::report::record::sweep::{Cheapest, Sweep, Target};

/// A table of words: its heading row, then its rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Words {
    pub head: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

/// One row an engine, one column a target: the processor seconds a simulated second of the cheapest setting that
/// reaches it, and the setting.
pub fn targets(sweep: &Sweep) -> Option<Words> {
    let first = sweep.targets.first()?;
    let head = std::iter::once("engine".to_string());
    let columns = sweep.targets.iter().map(|t| power_of_ten(t.max_joint_error.log10().round() as i32));
    let rows = first.engines.iter().map(|e| {
        let cells = sweep.targets.iter().map(|target| cell(target, &e.family));
        std::iter::once(e.family.clone()).chain(cells).collect()
    });
    Some(Words { head: head.chain(columns).collect(), rows: rows.collect() })
}

fn cell(target: &Target, family: &str) -> String {
    match target.engines.iter().find(|e| e.family == family) {
        Some(e) if e.reached => format!("{} {}", short(e.s_per_simulated_s), setting(e)),
        _ => "not reached".to_string(),
    }
}

/// `(order=8, 20 ms)`: the settings without the engine's name, and the step.
pub fn setting(e: &Cheapest) -> String {
    let step = duration(e.step_s);
    match e.engine.split_once(':') {
        // The step of an engine with a tolerance says only how often its state was read.
        Some((_, settings)) if tolerance(&e.engine).is_some() => format!("({settings})"),
        Some((_, settings)) => format!("({settings}, {step})"),
        None => format!("({step})"),
    }
}

/// One row an engine setting: fitted order, floor, verdict.
pub fn convergence(sweep: &Sweep) -> Option<Words> {
    let absent = || "–".to_string();
    let rows: Vec<Vec<String>> = sweep
        .convergence
        .iter()
        .map(|c| {
            let order = c.order.map_or_else(absent, |order| plain(order, 2));
            vec![c.engine.clone(), order, c.floor.map_or_else(absent, short), c.verdict.words().to_string()]
        })
        .collect();
    let head = ["engine", "order", "floor", "verdict"].map(String::from).to_vec();
    (!rows.is_empty()).then_some(Words { head, rows })
}

impl Words {
    /// Aligned text; the first column has no indent.
    pub fn text(&self) -> String {
        let all = || std::iter::once(&self.head).chain(&self.rows);
        let width = |i: usize| all().filter_map(|row| row.get(i)).map(|w| w.chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.head.len()).map(width).collect();
        all()
            .map(|row| {
                let cells: Vec<String> = row.iter().zip(&widths).map(|(w, width)| format!("{w:width$}")).collect();
                cells.join("  ").trim_end().to_string() + "\n"
            })
            .collect()
    }
}

/// What the sweep shows, in a sentence: for the target nearest to 1e-6 that an engine reaches, what it costs each of
/// them, the cheapest first, those of one rank as they are listed, and which do not reach it.
pub fn sentence(sweep: &Sweep) -> Option<String> {
    let reached = sweep.targets.iter().filter(|t| t.engines.iter().any(|e| e.reached));
    let far = |t: &Target| (t.max_joint_error / 1e-6).ln().abs();
    let target = reached.min_by(|a, b| far(a).total_cmp(&far(b)))?;
    let mut engines: Vec<&Cheapest> = target.engines.iter().filter(|e| e.reached).collect();
    // Engines of one rank stay as they are listed.
    engines.sort_by_key(|e| e.rank);
    let cost = |e: &Cheapest| plain(e.s_per_simulated_s, 2);
    let alike = |i: usize| i > 0 && engines[i].rank.is_some() && engines[i].rank == engines[i - 1].rank;
    let mut parts: Vec<String> = engines
        .iter()
        .enumerate()
        .map(|(i, e)| {
            let words = if i == 0 { " s of CPU time a simulated second" } else { " s" };
            let verb = if alike(i) { "is as cheap with" } else { "needs" };
            format!("{} {verb} {}{words}", named(e), cost(e))
        })
        .collect();
    for e in target.engines.iter().filter(|e| !e.reached) {
        let (error, cost) = (super::number::written(e.max_joint_error), cost(e));
        parts.push(format!("{} does not reach it: its best here is {error} for {cost} s", e.family));
    }
    let bound = power_of_ten(target.max_joint_error.log10().round() as i32);
    let until = plain(sweep.until_s, 4);
    Some(format!("For joint positions to {bound} rad or m over the first {until} s, {}.", parts.join("; ")))
}

/// `rattle:order=8 at 20 ms`.
fn named(e: &Cheapest) -> String {
    match tolerance(&e.engine) {
        Some(_) => e.engine.clone(),
        None => format!("{} at {}", e.engine, duration(e.step_s)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cheapest(engine: &str, rank: Option<usize>, cost: f64, error: f64) -> Cheapest {
        Cheapest {
            family: crate::report::record::run::family(engine).to_string(),
            reached: rank.is_some(),
            rank,
            engine: engine.to_string(),
            step_s: 0.02,
            max_joint_error: error,
            s_per_simulated_s: cost,
        }
    }

    fn sweep() -> Sweep {
        let target = |max_joint_error: f64, engines: Vec<Cheapest>| Target { max_joint_error, engines };
        let rapier = cheapest("rapier:preset=strong", None, 0.2, 3e-5);
        Sweep {
            until_s: 2.0,
            reference_error: 1e-12,
            runs: Vec::new(),
            convergence: Vec::new(),
            expectations: Vec::new(),
            targets: vec![
                target(
                    1e-6,
                    vec![
                        cheapest("rattle:order=8", Some(3), 0.004, 2e-7),
                        rapier.clone(),
                        cheapest("galerkin:stages=6", Some(1), 0.0012, 1e-7),
                        cheapest("dop853:tolerance=1e-8", Some(1), 0.0011, 1e-7),
                    ],
                ),
                target(1e-8, vec![cheapest("rattle:order=8", None, 0.01, 2e-8), rapier]),
            ],
        }
    }

    #[test]
    fn the_sentence_names_the_cheapest_first_and_who_does_not_reach_it() {
        assert_eq!(
            sentence(&sweep()).expect("a target is reached"),
            "For joint positions to 10⁻⁶ rad or m over the first 2 s, galerkin:stages=6 at 20 ms needs 0.0012 s of \
             CPU time a simulated second; dop853:tolerance=1e-8 is as cheap with 0.0011 s; rattle:order=8 at 20 ms \
             needs 0.004 s; rapier does not reach it: its best here is 3.0 × 10⁻⁵ for 0.2 s."
        );
    }

    #[test]
    fn the_table_has_a_cell_for_every_engine_and_target() {
        let table = targets(&sweep()).expect("targets");
        assert_eq!(table.head, ["engine", "10⁻⁶", "10⁻⁸"]);
        assert_eq!(table.rows[0], ["rattle", "4.0e-3 (order=8, 20 ms)", "not reached"]);
        assert_eq!(table.rows[1], ["rapier", "not reached", "not reached"]);
        assert_eq!(table.rows[2], ["galerkin", "1.2e-3 (stages=6, 20 ms)", "not reached"]);
        assert_eq!(table.rows[3], ["dop853", "1.1e-3 (tolerance=1e-8)", "not reached"]);
        assert!(table.text().lines().nth(2).is_some_and(|line| line.starts_with("rapier    not reached  ")));
    }
}
