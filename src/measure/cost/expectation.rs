//! What is expected of the engines' order, and whether the runs of a sweep show it.
//!
//! On smooth motions, at an error that single steps of low order do not reach, `galerkin` is expected to cost at most
//! as much as `dop853` and `rattle` at most four times as much; and at the cost of rapier's most accurate run `rattle`
//! is expected to err 1e4 times less. Over long times, whose energy error only symplectic methods bound, both are
//! expected to keep the energy ten times better than `dop853` at equal cost. Each comes with the runs that show it or
//! do not.

use super::ranking;
use crate::measure::run::Run;

/// Times the cost of `dop853` that is expected at most.
const MOST_COST: [(&str, f64); 2] = [("galerkin", 1.0), ("rattle", 4.0)];

/// Times the error of `rattle` that rapier's is expected to be at least, at equal cost.
pub(crate) const LEAST_GAIN: f64 = 1e4;

/// Runs of at least this time, s, are long.
const LONG: f64 = 100.0;

/// Times the energy error of `galerkin` and `rattle` that `dop853`'s is expected to be at least over a long run, at
/// equal cost.
pub(crate) const LEAST_ENERGY_GAIN: f64 = 10.0;

/// Energy errors of one engine that differ by less than this factor are taken as equal.
const AS_GOOD: f64 = 2.0;

/// A run of known cost and error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Known<'a> {
    pub run: &'a Run,
    /// Processor seconds a simulated second.
    pub cost: f64,
    /// Largest joint position error, rad or m, or energy error.
    pub error: f64,
}

/// What the runs say about an expectation.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Expectation<'a> {
    /// For a joint position error of `target` the engine costs at most `most` times as much as `rival`; `own` is its
    /// cheapest run that reaches the target or, where none does, its most accurate.
    Cost { engine: &'static str, most: f64, target: f64, rival: Known<'a>, reached: bool, own: Known<'a> },
    /// At the cost of `rival`, rapier's most accurate run, rattle errs [`LEAST_GAIN`] times less; `own` is its most
    /// accurate that is as cheap, `enough` its cheapest that is accurate enough.
    Gain { rival: Known<'a>, own: Option<Known<'a>>, enough: Option<Known<'a>> },
    /// In the time of `own`, the cheapest run of the engine that keeps the energy best, `dop853` errs
    /// [`LEAST_ENERGY_GAIN`] times more; where it is cheaper than half, `cheap` is what the engine does in its time.
    Energy { engine: &'static str, own: Known<'a>, rival: Known<'a>, cheap: Option<Option<Known<'a>>> },
}

impl Expectation<'_> {
    pub fn holds(&self) -> bool {
        match self {
            Expectation::Cost { most, rival, reached, own, .. } => *reached && own.cost / rival.cost <= *most,
            Expectation::Gain { rival, own, .. } => own.is_some_and(|own| rival.error / own.error >= LEAST_GAIN),
            Expectation::Energy { own, rival, .. } => rival.error >= LEAST_ENERGY_GAIN * own.error,
        }
    }
}

/// What the runs of a sweep say.
pub(crate) fn expectations(runs: &[Run], reference_error: f64) -> Vec<Expectation<'_>> {
    let cost = MOST_COST.into_iter().filter_map(|(engine, most)| cost(runs, reference_error, engine, most));
    cost.chain(gain(runs)).collect()
}

/// What long runs say, where `dop853` was run.
pub(crate) fn over_long_times(runs: &[Run]) -> Vec<Expectation<'_>> {
    ["galerkin", "rattle"].into_iter().filter_map(|engine| energy(runs, engine)).collect()
}

fn known<'a>(runs: &'a [Run], engine: &str) -> Vec<Known<'a>> {
    let own = runs.iter().filter(|run| run.engine.entry().name == engine);
    own.filter_map(|run| Some(Known { run, cost: run.cost()?, error: run.joint_error()? })).collect()
}

fn cheapest<'a>(runs: impl IntoIterator<Item = Known<'a>>) -> Option<Known<'a>> {
    runs.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost))
}

fn most_accurate<'a>(runs: impl IntoIterator<Item = Known<'a>>) -> Option<Known<'a>> {
    runs.into_iter().min_by(|a, b| a.error.total_cmp(&b.error))
}

fn cost<'a>(runs: &'a [Run], reference_error: f64, engine: &'static str, most: f64) -> Option<Expectation<'a>> {
    let reaching = |engine: &str, error: f64| cheapest(known(runs, engine).into_iter().filter(|k| k.error <= error));
    let judged = ranking::FINE_TARGETS.into_iter().filter(|error| ranking::is_judged(*error, reference_error));
    let (target, rival) = judged.filter_map(|error| Some((error, reaching("dop853", error)?))).next()?;
    let (reached, own) = match reaching(engine, target) {
        Some(own) => (true, own),
        None => (false, most_accurate(known(runs, engine))?),
    };
    Some(Expectation::Cost { engine, most, target, rival, reached, own })
}

/// At the cost of rapier's most accurate run.
fn gain(runs: &[Run]) -> Option<Expectation<'_>> {
    let rival = most_accurate(known(runs, "rapier"))?;
    let own = known(runs, "rattle");
    let enough = cheapest(own.iter().copied().filter(|k| k.error * LEAST_GAIN <= rival.error));
    Some(Expectation::Gain { rival, own: most_accurate(own.into_iter().filter(|k| k.cost <= rival.cost)), enough })
}

/// In the time of the run of `engine` that keeps the energy best, the cheapest of those within a factor [`AS_GOOD`],
/// which differ by roundoff: `dop853` at any setting that takes no longer, or its cheapest.
fn energy<'a>(runs: &'a [Run], engine: &'static str) -> Option<Expectation<'a>> {
    let known = |engine: &'static str| {
        let long = runs.iter().filter(|run| run.horizon.end >= LONG);
        long.filter(move |run| run.engine.entry().name == engine)
            .filter_map(|run| Some(Known { run, cost: run.cost()?, error: run.trace.energy?.max }))
    };
    let best = |engine, most: f64| most_accurate(known(engine).filter(|k| k.cost <= most));
    let smallest = most_accurate(known(engine))?.error;
    let own = cheapest(known(engine).filter(|k| k.error <= AS_GOOD * smallest))?;
    let rival = best("dop853", own.cost.max(cheapest(known("dop853"))?.cost))?;
    let cheap = (rival.cost < 0.5 * own.cost).then(|| best(engine, rival.cost));
    Some(Expectation::Energy { engine, own, rival, cheap })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::measure::synthetic::timed_run as run;
    use crate::measure::trace::EnergyError;

    /// Runs of `dop853`, galerkin, rattle and rapier with costs of galerkin and rattle, and the error of rapier.
    pub(crate) fn all(galerkin: f64, rattle: f64, rapier: f64) -> Vec<Run> {
        vec![
            run("dop853:tolerance=2e-9", 1e-4, 4e-10),
            run("dop853:tolerance=1e-6", 5e-5, 1e-6),
            run("galerkin:stages=6", galerkin, 2e-10),
            run("rattle:order=8", rattle, 3e-10),
            run("rapier:preset=strong", 1e-1, rapier),
        ]
    }

    /// Runs of 100 s or so; rattle's most accurate errs by `rattle`.
    pub(crate) fn long(rattle: f64, duration: f64) -> Vec<Run> {
        let with = |engine: &str, cost: f64, energy: f64| {
            let mut run = run(engine, cost, 1.0);
            run.horizon.end = duration;
            run.trace.energy = Some(EnergyError { max: energy, last: energy });
            run
        };
        vec![
            with("dop853", 1e-3, 2e-11),
            with("dop853", 8e-3, 1e-13),
            with("galerkin", 9e-4, 1e-12),
            with("rattle:order=8", 8e-4, 5e-10),
            with("rattle:order=8", 4e-3, rattle),
            // No better than the one above, and no reason to judge at its cost.
            with("rattle:order=8", 2e-2, 0.9 * rattle),
            with("dop853", 1.5e-2, 2e-15),
        ]
    }

    fn hold(found: &[Expectation]) -> Vec<bool> {
        found.iter().map(Expectation::holds).collect()
    }

    #[test]
    fn expectations_that_the_runs_show_hold_and_others_do_not() {
        let holds = |runs: &[Run]| hold(&expectations(runs, 1e-12));
        assert_eq!(holds(&all(9e-5, 3.9e-4, 1e-4)), [true, true, true]);
        assert_eq!(holds(&all(1.1e-4, 5e-4, 1e-6)), [false, false, false]);
        // A rattle that costs more than rapier is not at equal cost.
        assert_eq!(holds(&all(9e-5, 0.2, 1e-4)), [true, false, false]);
    }

    #[test]
    fn long_runs_are_judged_by_their_energy() {
        // Galerkin is cheaper than any run of dop853, and rattle than the better one.
        assert_eq!(hold(&over_long_times(&long(1e-15, 100.0))), [true, true]);
        assert_eq!(hold(&over_long_times(&long(1e-11, 100.0))), [true, false]);
        assert!(over_long_times(&long(1e-15, 10.0)).is_empty());
    }

    #[test]
    fn what_the_runs_do_not_show_is_not_told() {
        let some = &all(9e-5, 3e-4, 1e-4)[2..4];
        assert!(expectations(some, 1e-12).is_empty());
        // A reference that is known to 1e-8 judges nothing below 3e-8.
        assert_eq!(expectations(&all(9e-5, 3e-4, 1e-4), 1e-8).len(), 1);
    }
}
