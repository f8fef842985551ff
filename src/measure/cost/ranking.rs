//! What an accuracy costs each engine, and which engine reaches it for less.
//!
//! Every run of a sweep is timed in a few rounds, which on a machine with other work tell costs apart to a tenth or so.
//! Ranks need more: the runs that can be the cheapest of their engine at a target, where two engines are near each
//! other there, are timed again in many rounds (`Effort::RANKING`).

use crate::measure::run::Run;

/// Joint position errors that engines are ranked at, rad or m.
pub(crate) const TARGETS: [f64; 4] = [1e-2, 1e-4, 1e-6, 1e-8];

/// Joint position errors at which the cost of an engine is held against that of another beside them; the first that can
/// be judged is taken.
pub(crate) const FINE_TARGETS: [f64; 2] = [1e-9, 1e-8];

/// Engines share a rank whose costs differ by less than this factor. Measured, on machines with other work: the ratio
/// of two engines' costs differs from run to run by 1.5 to 2.7 % (nine pairs in ten), and by 7.5 % (`galerkin` to
/// `dop853`) where something else keeps the whole processor slow all through a run.
const ALIKE: f64 = 1.15;
/// First timings may be wrong by a factor of nearly this for one run against another.
const UNSURE: f64 = 1.5;
/// Engines whose costs differ by more than this factor keep their order however they are timed.
const APART: f64 = UNSURE * UNSURE;

/// Whether an error can be judged by a reference that is known to `reference_error`.
pub(crate) fn is_judged(target: f64, reference_error: f64) -> bool {
    target >= 3.0 * reference_error
}

/// A run that stands for its engine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Standing {
    /// Index into the runs.
    pub run: usize,
    pub reached: bool,
    /// 1 where no engine reaches the target for less; none where it is not reached.
    pub rank: Option<usize>,
    /// Largest joint position error, rad or m.
    pub error: f64,
    /// Processor seconds a simulated second.
    pub cost: f64,
}

impl Standing {
    /// `None` for runs that were not completed or not timed.
    fn of(index: usize, run: &Run, target: f64) -> Option<Standing> {
        let (error, cost) = (run.joint_error()?, run.cost()?);
        Some(Standing { run: index, reached: error <= target, rank: None, error, cost })
    }
}

/// For every engine, in the order of the runs, its cheapest run that reaches the target, or the one that comes nearest.
pub(crate) fn rank(runs: &[Run], target: f64) -> Vec<Standing> {
    let mut found: Vec<Standing> = engines(runs, target).into_iter().filter_map(|standings| best(&standings)).collect();
    share(&mut found);
    found
}

/// The targets that a reference known to `reference_error` can judge, each with its standings; those that no run can be
/// held to are left out.
pub(crate) fn targets(runs: &[Run], reference_error: f64) -> Vec<(f64, Vec<Standing>)> {
    let judged = TARGETS.into_iter().filter(|target| is_judged(*target, reference_error));
    judged.map(|target| (target, rank(runs, target))).filter(|(_, standings)| !standings.is_empty()).collect()
}

/// The runs whose costs decide a rank, or could once they are known better.
pub(crate) fn contested(runs: &[Run], reference_error: f64) -> Vec<usize> {
    let judged = TARGETS.into_iter().chain(FINE_TARGETS).filter(|target| is_judged(*target, reference_error));
    let mut found: Vec<usize> = judged.flat_map(|target| contested_at(runs, target)).collect();
    found.sort_unstable();
    found.dedup();
    found
}

fn contested_at(runs: &[Run], target: f64) -> Vec<usize> {
    let reaching =
        |standings: Vec<Standing>| standings.into_iter().filter(|standing| standing.reached).collect::<Vec<Standing>>();
    let engines: Vec<Vec<Standing>> = engines(runs, target).into_iter().map(reaching).collect();
    let costs: Vec<f64> = engines.iter().filter_map(|standings| Some(best(standings)?.cost)).collect();
    let near = |cost: f64| costs.iter().filter(|other| cost.max(**other) <= APART * cost.min(**other)).count() > 1;
    let of_engine = |standings: Vec<Standing>| {
        let least = best(&standings).map(|standing| standing.cost).filter(|cost| near(*cost));
        standings.into_iter().filter(move |standing| least.is_some_and(|least| standing.cost <= UNSURE * least))
    };
    engines.into_iter().flat_map(of_engine).map(|standing| standing.run).collect()
}

/// The completed and timed runs by engine without its settings, in the order of the runs.
fn engines(runs: &[Run], target: f64) -> Vec<Vec<Standing>> {
    let mut found: Vec<(&str, Vec<Standing>)> = Vec::new();
    for (index, run) in runs.iter().enumerate() {
        let Some(standing) = Standing::of(index, run, target) else { continue };
        let name = run.engine.entry().name;
        match found.iter_mut().find(|(engine, _)| *engine == name) {
            Some((_, standings)) => standings.push(standing),
            None => found.push((name, vec![standing])),
        }
    }
    found.into_iter().map(|(_, standings)| standings).collect()
}

fn best(standings: &[Standing]) -> Option<Standing> {
    let reaching = standings.iter().filter(|standing| standing.reached);
    let nearest = || standings.iter().min_by(|a, b| a.error.total_cmp(&b.error));
    reaching.min_by(|a, b| a.cost.total_cmp(&b.cost)).or_else(nearest).copied()
}

/// A rank is shared by the costs that are alike to the least of them.
fn share(engines: &mut [Standing]) {
    let mut reached: Vec<&mut Standing> = engines.iter_mut().filter(|standing| standing.reached).collect();
    reached.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let (mut rank, mut least) = (0, 0.0);
    for (i, standing) in reached.into_iter().enumerate() {
        if i == 0 || standing.cost >= ALIKE * least {
            (rank, least) = (i + 1, standing.cost);
        }
        standing.rank = Some(rank);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::synthetic::timed_run;
    use crate::measure::trace::Trace;

    fn run(engine: &str, error: f64, cost: f64) -> Run {
        timed_run(engine, cost, error)
    }

    #[test]
    fn costs_that_are_alike_share_a_rank() {
        let ranks = |costs: [f64; 4]| {
            let engines = ["rattle", "galerkin", "dop853", "rk4"];
            let runs: Vec<Run> =
                engines.iter().zip(costs).map(|(e, cost)| run(e, if cost < 9.0 { 1e-7 } else { 1e-5 }, cost)).collect();
            rank(&runs, 1e-6).iter().map(|standing| standing.rank).collect::<Vec<_>>()
        };
        assert_eq!(ranks([1.1, 3.0, 1.0, 9.0]), [Some(1), Some(3), Some(1), None]);
        // Changed by a few percent each, the rank is the same; by more, it is not.
        assert_eq!(ranks([1.0, 2.9, 1.08, 9.0]), [Some(1), Some(3), Some(1), None]);
        assert_eq!(ranks([1.2, 3.0, 1.0, 9.0]), [Some(2), Some(3), Some(1), None]);
        // Each is near the one before it, but the third is not near the first.
        assert_eq!(ranks([1.0, 1.1, 1.2, 1.3]), [Some(1), Some(1), Some(3), Some(3)]);
    }

    #[test]
    fn an_engine_stands_by_its_cheapest_run_that_reaches_the_target() {
        let failed = Run { trace: Trace::unsupported(String::new()), ..run("rattle", 1e-9, 0.1) };
        let untimed = Run { timing: None, ..run("rattle", 1e-9, 0.1) };
        let runs = [
            failed,
            untimed,
            run("rattle", 1e-5, 0.5),
            run("rattle:order=8", 1e-8, 2.0),
            run("rattle:order=6", 1e-7, 1.0),
            run("rapier", 1e-3, 5.0),
            run("rapier:preset=strong", 1e-4, 9.0),
        ];
        let found = rank(&runs, 1e-6);
        assert_eq!(found.iter().map(|p| (p.run, p.reached)).collect::<Vec<_>>(), [(4, true), (6, false)]);
        assert!((found[0].cost - 1.0).abs() < 1e-12 && found[0].error == 1e-7, "{found:?}");
    }

    #[test]
    fn runs_are_contested_where_two_engines_are_near() {
        let runs = [
            run("rattle", 1e-3, 9.0),
            run("galerkin", 1e-3, 1.0),
            run("galerkin:stages=6", 1e-3, 1.4),
            run("galerkin:stages=8", 1e-3, 1.6),
            run("dop853", 1e-3, 2.0),
            run("rapier", 1.0, 1.0),
        ];
        assert_eq!(contested(&runs, 1e-12), [1, 2, 4]);
        // A reference that is known to 0.1 judges nothing.
        assert!(contested(&runs, 0.1).is_empty());
    }
}
