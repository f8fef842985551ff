//! Timed runs: the processor time of the stepping alone.
//!
//! Every candidate is stepped from the scene's initial state on one thread, with nothing between two steps: no state is
//! converted, nothing is measured. A pass takes the whole run, or, where that would take long, its first part
//! ([`Effort::longest_pass`]). One pass warms up and is thrown away; then the candidates take turns, one pass each a round,
//! so that a change of the machine's speed meets all of them. A pass that is too short for the clock
//! ([`Effort::shortest_turn`]) is repeated within its turn. The figure is the median over the rounds; what candidates are
//! ranked by is their lower decile: other work on the machine takes caches and clock from a turn and gives nothing back, so
//! that the fastest turns are those that it left alone. What the loop around the steps costs is in both: [`overhead`]
//! measures that.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use cpu_time::ThreadTime;

use crate::engines::{Engine, StepFailure};
use crate::mechanics::State;

/// How long candidates are timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Rounds that count.
    pub rounds: usize,
    /// A turn lasts at least this long.
    pub shortest_turn: Duration,
    /// A pass ends after this time in the warm-up; the rounds then take the same steps.
    pub longest_pass: Duration,
}

impl Effort {
    /// For the runs of a comparison.
    pub const FULL: Effort =
        Effort { rounds: 5, shortest_turn: Duration::from_millis(20), longest_pass: Duration::from_millis(400) };
    /// For the many settings of a sweep.
    pub const SWEEP: Effort =
        Effort { rounds: 5, shortest_turn: Duration::from_millis(5), longest_pass: Duration::from_millis(40) };
    /// For the few whose costs decide a rank.
    pub const RANKING: Effort =
        Effort { rounds: 60, shortest_turn: Duration::from_millis(3), longest_pass: Duration::from_millis(40) };

    /// Turns of a candidate, the warm-up included.
    pub fn turns(&self) -> u64 {
        self.rounds as u64 + 1
    }
}

/// The warm-up looks at the clock after this many steps.
const CHUNK: u64 = 16;

/// An engine to be timed over its first `steps` steps.
pub struct Candidate<'a> {
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
pub fn time(
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
        plans.push(warm_up(candidate, effort));
        if !turn() {
            return None;
        }
    }
    let mut times = vec![Vec::with_capacity(effort.rounds); candidates.len()];
    for _ in 0..effort.rounds {
        for ((candidate, plan), times) in candidates.iter().zip(&plans).zip(&mut times) {
            times.extend(plan.and_then(|plan| pass(candidate, plan)));
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

fn warm_up(candidate: &Candidate, effort: Effort) -> Option<Plan> {
    let mut engine = (candidate.build)()?;
    let begin = ThreadTime::now();
    let mut steps = 0;
    while steps < candidate.steps && begin.elapsed() < effort.longest_pass {
        for _ in 0..CHUNK.min(candidate.steps - steps) {
            engine.step().ok()?;
            steps += 1;
        }
    }
    let seconds = begin.elapsed().as_secs_f64().max(1e-9);
    let passes = (effort.shortest_turn.as_secs_f64() / seconds).ceil().clamp(1.0, 1e4) as u64;
    (steps > 0).then_some(Plan { steps, passes })
}

/// Processor time a step in one turn, s.
fn pass(candidate: &Candidate, plan: Plan) -> Option<f64> {
    let mut spent = Duration::ZERO;
    for _ in 0..plan.passes {
        let mut engine = (candidate.build)()?;
        let begin = ThreadTime::now();
        for _ in 0..plan.steps {
            engine.step().ok()?;
        }
        spent += begin.elapsed();
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
pub fn overhead() -> Option<f64> {
    let idle = Candidate { build: Box::new(|| Some(std::hint::black_box(Box::new(Idle)))), steps: 1_000_000 };
    let timings = time(&[idle], Effort::SWEEP, &AtomicBool::new(false), &AtomicU64::new(0))?;
    timings.first().copied().flatten().map(|timing| timing.median)
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    /// Spends about the given processor time in every step.
    struct Busy(Duration);

    impl Engine for Busy {
        fn step(&mut self) -> Result<(), StepFailure> {
            let begin = ThreadTime::now();
            while begin.elapsed() < self.0 {
                std::hint::spin_loop();
            }
            Ok(())
        }

        fn write_state(&self, _: &mut State) {}
    }

    fn candidate(step: Duration, steps: u64) -> Candidate<'static> {
        Candidate { build: Box::new(move || Some(Box::new(Busy(step)))), steps }
    }

    #[test]
    fn an_engine_that_takes_twice_as_long_is_found_to() {
        let (one, two) = (Duration::from_micros(50), Duration::from_micros(100));
        let found =
            time(&[candidate(one, 40), candidate(two, 40)], Effort::FULL, &AtomicBool::new(false), &AtomicU64::new(0));
        let found = found.expect("not interrupted");
        let (a, b) = (found[0].expect("timed"), found[1].expect("timed"));
        assert!((a.median / 50e-6 - 1.0).abs() < 0.1, "{a:?}");
        assert!((b.median / a.median - 2.0).abs() < 0.1, "{a:?} {b:?}");
        assert_eq!((a.rounds, a.steps), (5, 40));
        // 10 and 5 where nothing disturbs the warm-up
        assert!(a.passes >= 2 && b.passes >= 2, "short passes are repeated: {a:?} {b:?}");
    }

    #[test]
    fn a_long_run_is_timed_over_its_first_part() {
        let begin = Instant::now();
        let slow = candidate(Duration::from_millis(2), 1_000_000);
        let plan = warm_up(&slow, Effort::FULL).expect("steps");
        assert!(plan.steps >= 190 && plan.steps <= 224 && plan.passes == 1, "{} steps", plan.steps);
        assert!(begin.elapsed() < Duration::from_secs(20));
    }

    #[test]
    fn the_loop_around_a_step_costs_less_than_a_tenth_of_a_microsecond() {
        let overhead = overhead().expect("timed");
        // measured 2 ns
        assert!(overhead > 0.0 && overhead < 1e-7, "{overhead:e}");
    }

    #[test]
    fn an_engine_that_cannot_be_built_has_no_time() {
        let none = Candidate { build: Box::new(|| None), steps: 10 };
        assert_eq!(time(&[none], Effort::FULL, &AtomicBool::new(false), &AtomicU64::new(0)), Some(vec![None]));
    }
}
