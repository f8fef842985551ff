//! Finds the truth of a system: the reference trajectory, checked by a looser tolerance of its own and by
//! `rattle:order=8`, which shares nothing with it but the system.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::sampling::{sampling_interval, sampling_times};
use super::trusted::{TRUSTED, Trajectory, Truth, disagreement};
use crate::engines::{self, Spec, reference};
use crate::measure::{Horizon, scales};
use crate::mechanics::{State, System};

/// The engine that checks the reference.
const CHECK: &str = "rattle:order=8";

/// Its steps, s, the next one where the disagreement does not come from the reference.
const CHECK_STEPS: [f64; 5] = [0.01, 0.005, 0.002, 0.001, 0.0005];

/// A disagreement that is small enough to try no shorter step.
const CLOSE: f64 = 1e-10;

/// The truth at times that the horizons have, as far as it is found within a budget on the wall clock. `None` where the
/// reference does not take the system.
pub fn find(system: &System, horizons: &[Horizon], budget: Duration, interrupted: &AtomicBool) -> Option<Truth> {
    let begin = Instant::now();
    let times = sampling_times(horizons);
    let interval = sampling_interval(horizons.iter().map(|h| h.end).fold(0.0, f64::max));
    let go_on = || begin.elapsed() < budget && !interrupted.load(Ordering::Relaxed);
    let reach = scales::reach(system);
    let mut pair = |a: &State, b: &State| go_on() && disagreement(a, b, reach) <= TRUSTED;
    let found = reference::trajectory_while(system, &times, &mut pair).ok()?;
    let looser: Trajectory = found.looser.into_iter().map(Some).collect();
    let alone = Truth::new(system, found.method.clone(), &times, found.states.clone(), std::slice::from_ref(&looser));
    let mut best: Option<Truth> = None;
    let mut refused = None;
    for step in CHECK_STEPS {
        match check(system, &alone.times, interval / (interval / step).ceil(), &go_on) {
            Ok(check) => {
                let method = format!("{}; and against {CHECK} at a step of about {step} s", found.method);
                let others = [looser.clone(), check];
                let truth = Truth::new(system, method, &alone.times, alone.states.clone(), &others);
                let close = truth.trusted_until == alone.trusted_until && truth.error_estimate() <= CLOSE;
                let worth = |truth: &Truth| (truth.trusted_until, -truth.error_estimate());
                let better = |best: &Truth| worth(&truth) > worth(best);
                if best.as_ref().is_none_or(better) {
                    best = Some(truth);
                }
                if close || !go_on() {
                    break;
                }
            }
            Err(what) => refused = Some(what),
        }
    }
    Some(best.unwrap_or_else(|| Truth {
        method: format!("{}; not checked by {CHECK}: {}", found.method, refused.unwrap_or_default()),
        ..alone
    }))
}

/// The states of the check at those of `times` that are whole numbers of its steps.
///
/// # Errors
/// Why it does not take the system.
fn check(system: &System, times: &[f64], step: f64, go_on: &dyn Fn() -> bool) -> Result<Trajectory, String> {
    let spec = Spec::parse(CHECK).map_err(|error| error.to_string())?;
    let mut engine = engines::build(&spec, system, step).map_err(|unsupported| unsupported.what)?;
    let mut states = Vec::with_capacity(times.len());
    let mut taken = 0.0;
    for time in times {
        let steps = (time / step).round();
        while taken < steps {
            if !go_on() || engine.step().is_err() {
                return Ok(states);
            }
            taken += 1.0;
        }
        let whole = (steps * step - time).abs() <= 1e-9 * step;
        states.push(whole.then(|| {
            let mut state = system.initial.clone();
            engine.write_state(&mut state);
            state
        }));
    }
    Ok(states)
}
