//! What is expected of the engines' order, and whether the runs of a sweep show it.
//!
//! On smooth motions, at an error that single steps of low order do not reach, `galerkin` is expected to cost at most as much
//! as `dop853` and `rattle` at most four times as much; and at the cost of rapier's most accurate run `rattle` is expected
//! to err 1e4 times less. Over long times, whose energy error only symplectic methods bound, both are expected to keep the
//! energy ten times better than `dop853` at equal cost. Each is told with the figures of the runs, and with the reason where
//! it is not so.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::number::{duration, plain, power_of_ten, written};
use crate::engines::tolerance;
use crate::measure::cost::ranking;
use crate::report::record::front::{self, family};
use crate::report::record::run::Run;
use crate::variational::composition;

/// An expectation and what the runs say about it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Expectation {
    pub expected: String,
    pub holds: bool,
    /// The figures, and the reason where it does not hold.
    pub found: String,
}

/// Times the cost of `dop853` that is expected at most.
const MOST_COST: [(&str, f64); 2] = [("galerkin", 1.0), ("rattle", 4.0)];
/// Times the error of `rattle` that rapier's is expected to be at least, at equal cost.
const LEAST_GAIN: f64 = 1e4;
/// Runs of at least this time, s, are long.
const LONG: f64 = 100.0;
/// Times the energy error of `galerkin` and `rattle` that `dop853`'s is expected to be at least over a long run, at equal cost.
const LEAST_ENERGY_GAIN: f64 = 10.0;

/// Energy errors of one engine that differ by less than this factor are taken as equal.
const AS_GOOD: f64 = 2.0;

pub(in crate::report) fn expectations(runs: &[Run], reference_error: f64) -> Vec<Expectation> {
    let cost = MOST_COST.into_iter().filter_map(|(engine, most)| cost(runs, reference_error, engine, most));
    cost.chain(gain(runs)).collect()
}

/// A timed run of known error.
#[derive(Clone, Copy)]
struct Known<'a> {
    run: &'a Run,
    cost: f64,
    error: f64,
}

fn known<'a>(runs: &'a [Run], engine: &'a str) -> impl Iterator<Item = Known<'a>> {
    let own = runs.iter().filter(move |run| family(&run.engine) == engine);
    own.filter_map(|run| Some(Known { run, cost: front::cost(run)?, error: front::error(run)? }))
}

fn cheapest<'a>(runs: &'a [Run], engine: &'a str, error: f64) -> Option<Known<'a>> {
    known(runs, engine).filter(|k| k.error <= error).min_by(|a, b| a.cost.total_cmp(&b.cost))
}

fn cost(runs: &[Run], reference_error: f64, engine: &str, most: f64) -> Option<Expectation> {
    let judged = ranking::FINE_TARGETS.into_iter().filter(|error| ranking::is_judged(*error, reference_error));
    let (error, rival) = judged.filter_map(|error| Some((error, cheapest(runs, "dop853", error)?))).next()?;
    let bound = power_of_ten(error.log10().round() as i32);
    let times = if most == 1.0 { String::new() } else { format!("{} times ", plain(most, 2)) };
    let expected = format!("for {bound} {engine} costs at most {times}as much as dop853");
    let seconds = format!("{} needs {} s a simulated second for {bound}", rival.run.engine, plain(rival.cost, 2));
    let Some(own) = cheapest(runs, engine, error) else {
        let best = known(runs, engine).min_by(|a, b| a.error.total_cmp(&b.error))?;
        let found = format!(
            "{seconds}; no setting of {engine} that was tried reaches it, the best, {}, errs by {}",
            setting(best.run),
            written(best.error)
        );
        return Some(Expectation { expected, holds: false, found });
    };
    let ratio = own.cost / rival.cost;
    let mut found = format!("{seconds}, {} {} times that", setting(own.run), plain(ratio, 2));
    let holds = ratio <= most;
    if !holds {
        found += ": ";
        found += &reason(own.run);
    }
    Some(Expectation { expected, holds, found })
}

/// Why a method can cost more than an explicit one of variable steps: what it takes a simulated second, as measured, and what
/// the two methods do.
fn reason(run: &Run) -> String {
    let steps = plain(1.0 / run.step_s, 4);
    let micros = |parts: usize| plain(run.time.as_ref().map_or(0.0, |t| t.us_per_step) / parts as f64, 2);
    let composed = composition::ALL.iter().find(|c| run.engine.contains(&format!("order={}", c.order)));
    let own = match composed {
        _ if family(&run.engine) == "galerkin" => format!(
            "its {steps} steps a simulated second are all as long as the most violent moment allows, and it iterates the stages of \
             each to roundoff in {} µs",
            micros(1)
        ),
        _ if run.engine.contains("step=adaptive") => {
            "its steps fit the motion too, but are of order 2 and solve the joints to roundoff".to_string()
        }
        Some(c) => format!(
            "each of its {steps} steps a simulated second is {} steps of order 2, which solve the joints {} roundoff in {} µs each",
            c.stages(),
            if c.reaches_roundoff() { "to far below" } else { "to" },
            micros(c.stages())
        ),
        None => {
            format!("each of its {steps} steps a simulated second solves the joints to roundoff in {} µs", micros(1))
        }
    };
    own + ", while dop853 fits its steps to the motion and takes 12 evaluations for each"
}

/// At the cost of rapier's most accurate run.
fn gain(runs: &[Run]) -> Option<Expectation> {
    let rival = known(runs, "rapier").min_by(|a, b| a.error.total_cmp(&b.error))?;
    let affordable = known(runs, "rattle").filter(|k| k.cost <= rival.cost);
    let expected = format!(
        "at the cost of rapier's most accurate run rattle errs {} times less",
        power_of_ten(LEAST_GAIN.log10() as i32)
    );
    let run = format!(
        "{} errs by {} for {} s a simulated second",
        setting(rival.run),
        written(rival.error),
        plain(rival.cost, 2)
    );
    let Some(own) = affordable.min_by(|a, b| a.error.total_cmp(&b.error)) else {
        return Some(Expectation {
            expected,
            holds: false,
            found: format!("{run}; no setting of rattle that was tried is as cheap"),
        });
    };
    let ratio = rival.error / own.error;
    let mut found = format!("{run}, {} by {} for {}", setting(own.run), written(own.error), plain(own.cost, 2));
    let holds = ratio >= LEAST_GAIN;
    if !holds {
        found += &format!(": {} times less", written(ratio));
        let longer = known(runs, "rattle").filter(|k| k.error * LEAST_GAIN <= rival.error);
        if let Some(next) = longer.min_by(|a, b| a.cost.total_cmp(&b.cost)) {
            found += &format!("; {} does for {} s", setting(next.run), plain(next.cost, 2));
        }
    }
    Some(Expectation { expected, holds, found })
}

/// What long runs say, where `dop853` was run.
pub(in crate::report) fn over_long_times(runs: &[Run]) -> Vec<Expectation> {
    let long: Vec<&Run> = runs.iter().filter(|run| run.duration_s >= LONG).collect();
    ["galerkin", "rattle"].into_iter().filter_map(|engine| energy(&long, engine)).collect()
}

/// In the time of the run of `engine` that keeps the energy best, the cheapest of those within a factor [`AS_GOOD`], which differ
/// by roundoff: `dop853` at any setting that takes no longer, or its cheapest.
fn energy(runs: &[&Run], engine: &'static str) -> Option<Expectation> {
    let known = |engine: &'static str| {
        let own = runs.iter().filter(move |run| family(&run.engine) == engine);
        own.filter_map(|run| Some((*run, front::cost(run)?, run.energy.as_ref()?.max_relative_error)))
    };
    let best = |engine, most: f64| known(engine).filter(|k| k.1 <= most).min_by(|a, b| a.2.total_cmp(&b.2));
    let smallest = known(engine).map(|k| k.2).min_by(f64::total_cmp)?;
    let as_good = known(engine).filter(|k| k.2 <= AS_GOOD * smallest);
    let (own, own_cost, own_error) = as_good.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let over = plain(own.duration_s, 2);
    let expected = format!(
        "over {over} s {engine} errs in energy {} times less than dop853 at equal cost",
        plain(LEAST_ENERGY_GAIN, 2)
    );
    let mut found =
        format!("{} errs by {} for {} s a simulated second", setting(own), written(own_error), plain(own_cost, 2));
    let told =
        |(run, cost, error): (&Run, f64, f64)| format!("{} by {} for {}", setting(run), written(error), plain(cost, 2));
    let least = known("dop853").map(|k| k.1).min_by(f64::total_cmp)?;
    let rival = best("dop853", own_cost.max(least))?;
    found += &format!(", {}", told(rival));
    let holds = rival.2 >= LEAST_ENERGY_GAIN * own_error;
    if !holds {
        found += "; the error of dop853 grows with time, and has not grown so far by then";
    }
    // Where dop853 is cheaper, what the same engine does in its time.
    if rival.1 < 0.5 * own_cost {
        found += &match best(engine, rival.1) {
            Some(cheap) => format!("; in the time of the latter, {}", told(cheap)),
            None => format!("; no run of {engine} is as cheap as the latter"),
        };
    }
    Some(Expectation { expected, holds, found })
}

/// `rattle:order=8 at 20 ms`; the step of an engine with a tolerance says only how often its state was read.
fn setting(run: &Run) -> String {
    match tolerance(&run.engine) {
        Some(_) => run.engine.clone(),
        None => format!("{} at {}", run.engine, duration(run.step_s)),
    }
}

impl Expectation {
    /// `Expected and not so: ...`.
    pub fn sentence(&self) -> String {
        let head = if self.holds { "As expected" } else { "Expected and not so" };
        format!("{head}, {}: {}.", self.expected, self.found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::record::front::tests::run;
    use crate::report::record::run::Energy;

    fn all(galerkin: f64, rattle: f64, rapier: f64) -> Vec<Run> {
        vec![
            run("dop853:tolerance=1e-9", 1e-4, 4e-10),
            run("dop853:tolerance=1e-6", 5e-5, 1e-6),
            run("galerkin:stages=6", galerkin, 2e-10),
            run("rattle:order=8", rattle, 3e-10),
            run("rapier:preset=strong", 1e-1, rapier),
        ]
    }

    #[test]
    fn expectations_that_the_runs_show_hold_and_others_do_not() {
        let holds = |runs: &[Run]| expectations(runs, 1e-12).iter().map(|e| e.holds).collect::<Vec<bool>>();
        assert_eq!(holds(&all(9e-5, 3.9e-4, 1e-4)), [true, true, true]);
        assert_eq!(holds(&all(1.1e-4, 5e-4, 1e-6)), [false, false, false]);
        // A rattle that costs more than rapier is not at equal cost.
        assert_eq!(holds(&all(9e-5, 0.2, 1e-4)), [true, false, false]);
    }

    #[test]
    fn the_sentence_has_the_figures_and_the_reason() {
        let found = expectations(&all(1.5e-4, 3e-4, 1e-4), 1e-12);
        assert_eq!(
            found[0].sentence(),
            "Expected and not so, for 10⁻⁹ galerkin costs at most as much as dop853: dop853:tolerance=1e-9 needs 0.0001 s a \
             simulated second for 10⁻⁹, galerkin:stages=6 at 0.1 s 1.5 times that: its 10 steps a simulated second are all as long as the \
             most violent moment allows, and it iterates the stages of each to roundoff in 15 µs, while dop853 fits its \
             steps to the motion and takes 12 evaluations for each."
        );
        assert!(
            found[1].sentence().starts_with("As expected, for 10⁻⁹ rattle costs at most 4 times as much as dop853: ")
        );
        let found = expectations(&all(9e-5, 1.7e-3, 1e-4), 1e-12)[1].sentence();
        let reason = "rattle:order=8 at 0.1 s 17 times that: each of its 10 steps a simulated second is 17 steps of order 2, which \
                      solve the joints to far below roundoff in 10 µs each, while dop853 fits";
        assert!(found.starts_with("Expected and not so") && found.contains(reason), "{found}");
        let adaptive = run("rattle:step=adaptive,tol=1e-6", 1.7e-3, 3e-10);
        let found = super::reason(&adaptive);
        assert!(found.starts_with("its steps fit the motion too, but are of order 2"), "{found}");
    }

    #[test]
    fn long_runs_are_judged_by_their_energy() {
        let with = |engine: &str, cost: f64, energy: f64, duration: f64| {
            let energy = Energy {
                scale_j: 1.0,
                max_relative_error: energy,
                final_relative_error: energy,
                slope_per_s: None,
                growth_exponent: None,
                growth_exponent_interval: None,
                verdict: None,
                time_level_corrected: None,
            };
            Run { duration_s: duration, energy: Some(energy), ..run(engine, cost, 1.0) }
        };
        let runs = |rattle: f64, duration: f64| {
            vec![
                with("dop853", 1e-3, 2e-11, duration),
                with("dop853", 8e-3, 1e-13, duration),
                with("galerkin", 9e-4, 1e-12, duration),
                with("rattle:order=8", 8e-4, 5e-10, duration),
                with("rattle:order=8", 4e-3, rattle, duration),
                // No better than the one above, and no reason to judge at its cost.
                with("rattle:order=8", 2e-2, 0.9 * rattle, duration),
                with("dop853", 1.5e-2, 2e-15, duration),
            ]
        };
        let found = over_long_times(&runs(1e-15, 100.0));
        // Galerkin is cheaper than any run of dop853, and rattle than the better one.
        assert_eq!(found.iter().map(|e| e.holds).collect::<Vec<bool>>(), [true, true]);
        let told = found[1].sentence();
        assert!(told.contains("rattle errs in energy 10 times less"), "{told}");
        assert!(told.contains("; in the time of the latter, rattle:order=8 at 0.1 s by 5.0 × 10⁻¹⁰"), "{told}");
        let found = over_long_times(&runs(1e-11, 100.0));
        assert_eq!(found.iter().map(|e| e.holds).collect::<Vec<bool>>(), [true, false]);
        assert_eq!(over_long_times(&runs(1e-15, 10.0)), []);
    }

    #[test]
    fn what_the_runs_do_not_show_is_not_told() {
        let some = &all(9e-5, 3e-4, 1e-4)[2..4];
        assert_eq!(expectations(some, 1e-12), []);
        // A reference that is known to 1e-8 judges nothing below 3e-8.
        assert_eq!(expectations(&all(9e-5, 3e-4, 1e-4), 1e-8).len(), 1);
    }
}
