//! Steps an engine over a horizon and measures every state.

use std::sync::atomic::Ordering;
use std::time::Instant;

use super::figures::Trace;
use super::probe::Probe;
use crate::engines::{Engine, StepFailure};
use crate::measure::Horizon;
use crate::measure::outcome::{Limits, Outcome};
use crate::measure::truth::accuracy::Follower;
use crate::measure::truth::trusted::Truth;
use crate::mechanics::System;

/// Steps an engine over the horizon, starting from the system's initial state, and measures every state. `None` where
/// it was interrupted.
pub fn trace(system: &System, engine: &mut dyn Engine, horizon: Horizon, limits: &Limits) -> Option<Trace> {
    trace_against(None, system, engine, horizon, limits)
}

/// The same, with the positions compared with the truth.
pub fn trace_against<'a>(
    truth: Option<&'a Truth>,
    system: &'a System,
    engine: &mut dyn Engine,
    horizon: Horizon,
    limits: &Limits,
) -> Option<Trace> {
    let mut probe = Probe::new(system, engine, horizon);
    probe.follower = truth.map(|truth| Follower::new(system, truth));
    let begin = Instant::now();
    let outcome = loop {
        if probe.taken == horizon.steps {
            break Outcome::Completed;
        }
        if limits.interrupted.load(Ordering::Relaxed) {
            return None;
        }
        if begin.elapsed() > limits.budget {
            break Outcome::OverBudget {
                detail: format!(
                    "reached {} of {} steps in {} s on the wall clock; allow more with --budget",
                    probe.taken,
                    horizon.steps,
                    limits.budget.as_secs_f64()
                ),
            };
        }
        match engine.step() {
            Ok(()) => {}
            Err(StepFailure::NotConverged { detail }) => break Outcome::NotConverged { detail },
            Err(StepFailure::Diverged { detail }) => break Outcome::Diverged { detail },
        }
        if let Err(detail) = probe.measure(engine) {
            break Outcome::Diverged { detail };
        }
        limits.taken.fetch_add(1, Ordering::Relaxed);
    };
    limits.taken.fetch_add(horizon.steps - probe.taken, Ordering::Relaxed);
    Some(probe.finish(engine, outcome))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, AtomicU64};
    use std::time::Duration;

    use super::*;
    use crate::measure::growth::Verdict;
    use crate::measure::synthetic::{Scripted, flywheel};
    use crate::measure::trace::figures::{ENERGY, EnergyError};

    fn run<F: Fn(u64) -> f64>(engine: &mut Scripted<F>, steps: u64, budget: Duration) -> Trace {
        let system = flywheel(2.0, 0.0, 1.0);
        let horizon = Horizon::exact(1e-3, steps as f64 * 1e-3).expect("whole");
        let limits = Limits { budget, interrupted: &AtomicBool::new(false), taken: &AtomicU64::new(0) };
        trace(&system, engine, horizon, &limits).expect("not interrupted")
    }

    const LONG: Duration = Duration::from_secs(100);

    #[test]
    fn one_wrong_step_among_thousands_is_the_largest_error() {
        // The energy scale is J omega^2 / 2 at omega = 1, so the error is omega^2 - 1.
        let found = run(&mut Scripted::new(|n| if n == 3217 { 1.5 } else { 1.0 }), 5000, LONG);
        let error = found.energy.expect("measured");
        assert_eq!(found.outcome, Outcome::Completed);
        assert!((error.max - 1.25).abs() < 1e-15 && error.last == 0.0, "{error:?}");
        assert!(found.series.blocks.iter().any(|b| b.values[ENERGY].max == error.max));
        assert!((found.momentum[0].max - 0.5).abs() < 1e-15, "{:?}", found.momentum);
        assert_eq!(found.growth.expect("judged").verdict, Verdict::Bounded);
    }

    #[test]
    fn an_exploding_run_ends_as_diverged_where_it_does() {
        let found = run(&mut Scripted::new(|n| 1.01f64.powi(n as i32)), 5000, LONG);
        // 1.01^(2 n) passes 1e6 + 1 at n = 695.
        assert_eq!(found.steps, 694);
        assert!(matches!(&found.outcome, Outcome::Diverged { detail } if detail.starts_with("t = 0.695000 s: ")));
        assert_eq!(found.growth.expect("judged").verdict, Verdict::BlowUp);
        let found = run(&mut Scripted::new(|n| if n > 10 { f64::NAN } else { 1.0 }), 100, LONG);
        assert_eq!(found.outcome, Outcome::Diverged { detail: "t = 0.011000 s: the state is not a number".into() });
        assert_eq!((found.steps, found.energy), (10, Some(EnergyError { max: 0.0, last: 0.0 })));
    }

    #[test]
    fn a_failed_step_keeps_the_figures_before_it() {
        let mut engine = Scripted::new(|_| 1.0);
        let failure = StepFailure::NotConverged { detail: "joint 'axle'".into() };
        engine.fails_at = Some((21, failure));
        let found = run(&mut engine, 100, LONG);
        assert_eq!(found.outcome, Outcome::NotConverged { detail: "joint 'axle'".into() });
        assert_eq!((found.steps, found.ended_at), (20, 0.02));
    }

    #[test]
    fn a_run_over_its_budget_says_how_far_it_came() {
        let found = run(&mut Scripted::new(|_| 1.0), 100, Duration::ZERO);
        let detail = "reached 0 of 100 steps in 0 s on the wall clock; allow more with --budget";
        assert_eq!(found.outcome, Outcome::OverBudget { detail: detail.into() });
        assert_eq!((found.energy, found.growth), (None, None));
    }

    #[test]
    fn the_start_of_a_wrong_model_is_seen() {
        let found = run(&mut Scripted::new(|_| 1.0 + 1e-6), 10, LONG);
        let start = found.start.expect("measured");
        assert!((start.angular_velocity - 1e-6).abs() < 1e-15 && (start.energy - 2e-6).abs() < 1e-11, "{start:?}");
    }
}
