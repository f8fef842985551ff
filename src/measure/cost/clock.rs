//! Timed runs: the processor time of the stepping alone.
//!
//! Every candidate is stepped from the scene's initial state on one thread, with nothing between two steps: no state is
//! converted, nothing is measured. A pass takes the whole run, or, where that would take long, its first part
//! (`Effort::longest_pass`). One pass warms up and is thrown away; then the candidates take turns, one pass each a
//! round, so that a change of the machine's speed meets all of them. A pass that is too short for the clock
//! (`Effort::shortest_turn`) is repeated within its turn. The figure is the median over the rounds; what candidates
//! are ranked by is their lower decile: other work on the machine takes caches and clock from a turn and gives nothing
//! back, so that the fastest turns are those that it left alone. What the loop around the steps costs is in both:
//! `overhead` measures that.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use cpu_time::ThreadTime;

use crate::engines::{Engine, StepFailure};
use crate::mechanics::State;

/// How long candidates are timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Effort {
    /// Rounds that count.
    pub rounds: usize,
    /// A turn lasts at least this long.
    pub shortest_turn: Duration,
    /// A pass ends after this time in the warm-up; the rounds then take the same steps.
    pub longest_pass: Duration,
}

impl Effort {
    /// For the runs of a comparison.
    pub(crate) const FULL: Effort =
        Effort { rounds: 5, shortest_turn: Duration::from_millis(20), longest_pass: Duration::from_millis(400) };
    /// For the many settings of a sweep.
    pub(crate) const SWEEP: Effort =
        Effort { rounds: 5, shortest_turn: Duration::from_millis(5), longest_pass: Duration::from_millis(40) };
    /// For the few whose costs decide a rank.
    pub(crate) const RANKING: Effort =
        Effort { rounds: 60, shortest_turn: Duration::from_millis(3), longest_pass: Duration::from_millis(40) };

    /// Turns of a candidate, the warm-up included.
    pub fn turns(&self) -> u64 {
        self.rounds as u64 + 1
    }
}

/// The warm-up looks at the clock after this many steps.
const CHUNK: u64 = 16;

/// An engine to be timed over its first `steps` steps.
pub(crate) struct Candidate<'a> {
    /// A new engine at the initial state; `None` where it cannot be built.
    pub build: Box<dyn Fn() -> Option<Box<dyn Engine>> + 'a>,
    pub steps: u64,
}

/// Processor time a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Median, lower decile, smallest and largest over the rounds, s.
    pub median: f64,
    pub low: f64,
    pub min: f64,
    pub max: f64,
    pub rounds: usize,
    /// Steps of a pass, counted from the initial state.
    pub steps: u64,
    /// Passes in a turn.
    pub passes: u64,
}

/// Times all candidates, taking turns. An entry is `None` where a step failed; the whole is `None` where it was
/// interrupted. `taken` counts turns, [`Effort::turns`] for each candidate.
pub(crate) fn time(
    candidates: &[Candidate],
    effort: Effort,
    interrupted: &AtomicBool,
    taken: &AtomicU64,
) -> Option<Vec<Option<Timing>>> {
    time_by(&|| ThreadTime::now().as_duration(), candidates, effort, interrupted, taken)
}

/// Reads a time that only grows.
type Clock<'a> = &'a dyn Fn() -> Duration;

fn time_by(
    clock: Clock,
    candidates: &[Candidate],
    effort: Effort,
    interrupted: &AtomicBool,
    taken: &AtomicU64,
) -> Option<Vec<Option<Timing>>> {
    let turn = || {
        taken.fetch_add(1, Ordering::Relaxed);
        !interrupted.load(Ordering::Relaxed)
    };
    let mut plans = Vec::with_capacity(candidates.len());
    for candidate in candidates {
        plans.push(warm_up(clock, candidate, effort));
        if !turn() {
            return None;
        }
    }
    let mut times = vec![Vec::with_capacity(effort.rounds); candidates.len()];
    for _ in 0..effort.rounds {
        for ((candidate, plan), times) in candidates.iter().zip(&plans).zip(&mut times) {
            times.extend(plan.and_then(|plan| pass(clock, candidate, plan)));
            if !turn() {
                return None;
            }
        }
    }
    Some(plans.iter().zip(times).map(|(plan, times)| summary((*plan)?, times)).collect())
}

/// What a turn of a candidate consists of.
#[derive(Clone, Copy)]
struct Plan {
    steps: u64,
    passes: u64,
}

fn warm_up(clock: Clock, candidate: &Candidate, effort: Effort) -> Option<Plan> {
    let mut engine = (candidate.build)()?;
    let begin = clock();
    let mut steps = 0;
    while steps < candidate.steps && clock() - begin < effort.longest_pass {
        for _ in 0..CHUNK.min(candidate.steps - steps) {
            engine.step().ok()?;
            steps += 1;
        }
    }
    let seconds = (clock() - begin).as_secs_f64().max(1e-9);
    let passes = (effort.shortest_turn.as_secs_f64() / seconds).ceil().clamp(1.0, 1e4) as u64;
    (steps > 0).then_some(Plan { steps, passes })
}

/// Processor time a step in one turn, s.
fn pass(clock: Clock, candidate: &Candidate, plan: Plan) -> Option<f64> {
    let mut spent = Duration::ZERO;
    for _ in 0..plan.passes {
        let mut engine = (candidate.build)()?;
        let begin = clock();
        for _ in 0..plan.steps {
            engine.step().ok()?;
        }
        spent += clock() - begin;
    }
    Some(spent.as_secs_f64() / (plan.steps * plan.passes) as f64)
}

fn summary(plan: Plan, mut times: Vec<f64>) -> Option<Timing> {
    times.sort_by(f64::total_cmp);
    Some(Timing {
        median: *times.get(times.len() / 2)?,
        low: *times.get(times.len() / 10)?,
        min: *times.first()?,
        max: *times.last()?,
        rounds: times.len(),
        steps: plan.steps,
        passes: plan.passes,
    })
}

/// An engine whose step does nothing.
struct Idle;

impl Engine for Idle {
    fn step(&mut self) -> Result<(), StepFailure> {
        Ok(())
    }

    fn write_state(&self, _: &mut State) {}
}

/// Processor time that the loop around a step takes, s: what an engine that does nothing would be charged.
pub(crate) fn overhead() -> Option<f64> {
    let idle = Candidate { build: Box::new(|| Some(std::hint::black_box(Box::new(Idle)))), steps: 1_000_000 };
    let timings = time(&[idle], Effort::SWEEP, &AtomicBool::new(false), &AtomicU64::new(0))?;
    timings.first().copied().flatten().map(|timing| timing.median)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::rc::Rc;

    use super::*;

    /// A clock that stands still but for what the engines put on it.
    type Time = Rc<Cell<Duration>>;

    /// Every step puts its duration on the clock.
    struct Busy {
        step: Duration,
        now: Time,
    }

    impl Engine for Busy {
        fn step(&mut self) -> Result<(), StepFailure> {
            self.now.set(self.now.get() + self.step);
            Ok(())
        }

        fn write_state(&self, _: &mut State) {}
    }

    fn candidate(now: &Time, step: Duration, steps: u64) -> Candidate<'_> {
        Candidate { build: Box::new(move || Some(Box::new(Busy { step, now: now.clone() }))), steps }
    }

    /// Of each candidate, with the number of turns that were counted.
    fn timed(now: &Time, candidates: &[Candidate]) -> (Vec<Timing>, u64) {
        let taken = AtomicU64::new(0);
        let found = time_by(&|| now.get(), candidates, Effort::FULL, &AtomicBool::new(false), &taken);
        (found.expect("not interrupted").into_iter().map(|timing| timing.expect("timed")).collect(), taken.into_inner())
    }

    #[test]
    fn an_engine_that_takes_twice_as_long_is_found_to() {
        let now = Time::default();
        let (one, two) = (Duration::from_micros(50), Duration::from_micros(100));
        let (found, turns) = timed(&now, &[candidate(&now, one, 40), candidate(&now, two, 40)]);
        // Turns of at least 20 ms: ten passes of 40 steps of 50 us, and five of 100 us.
        let expected = |step: f64, passes: u64| Timing {
            median: step,
            low: step,
            min: step,
            max: step,
            rounds: Effort::FULL.rounds,
            steps: 40,
            passes,
        };
        assert_eq!(found, [expected(50e-6, 10), expected(100e-6, 5)]);
        assert_eq!(turns, 2 * Effort::FULL.turns());
    }

    #[test]
    fn a_long_run_is_timed_over_its_first_part() {
        let now = Time::default();
        let (found, _) = timed(&now, &[candidate(&now, Duration::from_millis(2), 1_000_000)]);
        // 400 ms are 200 steps, seen at the end of a chunk.
        assert_eq!((found[0].steps, found[0].passes, found[0].median), (200_u64.next_multiple_of(CHUNK), 1, 2e-3));
    }

    #[test]
    fn the_figures_of_a_turn_are_those_of_its_rounds() {
        let plan = Plan { steps: 7, passes: 3 };
        let times = (0..20).rev().map(f64::from).collect();
        let expected = Timing { median: 10.0, low: 2.0, min: 0.0, max: 19.0, rounds: 20, steps: 7, passes: 3 };
        assert_eq!(summary(plan, times), Some(expected));
        assert_eq!(summary(plan, Vec::new()), None);
    }

    #[test]
    fn the_loop_around_a_step_costs_less_than_a_tenth_of_a_microsecond() {
        // The least of several: what else runs on the machine only adds to it. Measured 2 ns.
        let least = (0..5).map(|_| overhead().expect("timed")).fold(f64::INFINITY, f64::min);
        assert!(least > 0.0 && least < 1e-7, "{least:e}");
    }

    #[test]
    fn an_engine_that_cannot_be_built_has_no_time() {
        let none = Candidate { build: Box::new(|| None), steps: 10 };
        assert_eq!(time(&[none], Effort::FULL, &AtomicBool::new(false), &AtomicU64::new(0)), Some(vec![None]));
    }
}
