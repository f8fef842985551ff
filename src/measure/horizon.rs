//! How many steps of which size make up a run.

/// A run of `steps` steps of `step` seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    /// Step size, s.
    pub step: f64,
    /// Number of steps, at least one.
    pub steps: u64,
    /// End of the run, s: the duration asked for where it is a whole number of steps, else `steps * step`.
    pub end: f64,
}

/// Why a step size and a duration make no run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HorizonError {
    #[error("{name} must be > 0 s, got {value}")]
    NotPositive { name: &'static str, value: f64 },
    #[error("{steps:.3e} steps of {step} s make up {duration} s; at most 2^52 steps can be counted")]
    TooLong { steps: f64, step: f64, duration: f64 },
    #[error(
        "--duration {duration} s is not a whole number of steps of {step} s; use --step {shorter} or --step {longer}, \
         or --duration {below} or {above}"
    )]
    NotWhole { duration: f64, step: f64, shorter: f64, longer: f64, below: f64, above: f64 },
    #[error("--duration {duration} s is shorter than one step of {step} s; use --step {duration} or less")]
    ShorterThanAStep { duration: f64, step: f64 },
}

/// How far, relative to it, a duration may be from a whole number of steps.
const WHOLE: f64 = 1e-9;

impl Horizon {
    /// The run that ends exactly at `duration` (s).
    ///
    /// # Errors
    /// A number that is not positive, and a duration that is not a whole number of steps to 1e-9 relative.
    pub fn exact(step: f64, duration: f64) -> Result<Horizon, HorizonError> {
        let count = count(step, duration)?;
        let steps = count.round();
        if (steps * step - duration).abs() <= WHOLE * duration {
            return Ok(Horizon { step, steps: steps as u64, end: duration });
        }
        let below = count.floor();
        if below < 1.0 {
            return Err(HorizonError::ShorterThanAStep { duration, step });
        }
        Err(HorizonError::NotWhole {
            duration,
            step,
            shorter: significant(duration / (below + 1.0)),
            longer: significant(duration / below),
            below: significant(below * step),
            above: significant((below + 1.0) * step),
        })
    }

    /// The run of at least one step that ends nearest to `duration` (s).
    ///
    /// # Errors
    /// A number that is not positive.
    pub fn nearest(step: f64, duration: f64) -> Result<Horizon, HorizonError> {
        let steps = count(step, duration)?.round().max(1.0);
        let whole = (steps * step - duration).abs() <= WHOLE * duration;
        let end = if whole { duration } else { significant(steps * step) };
        Ok(Horizon { step, steps: steps as u64, end })
    }

    /// Time after `n` steps, s; exactly [`Horizon::end`] after the last.
    pub fn time(&self, n: u64) -> f64 {
        if n == self.steps { self.end } else { n as f64 * self.step }
    }
}

fn count(step: f64, duration: f64) -> Result<f64, HorizonError> {
    for (name, value) in [("--step", step), ("--duration", duration)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(HorizonError::NotPositive { name, value });
        }
    }
    let steps = duration / step;
    if steps > (1u64 << 52) as f64 {
        return Err(HorizonError::TooLong { steps, step, duration });
    }
    Ok(steps)
}

/// A number to 12 significant digits, so that 3333 steps of 0.003 s end at 9.999 s.
fn significant(x: f64) -> f64 {
    format!("{x:.11e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_number_of_steps_ends_exactly_at_the_duration() {
        for (step, duration, steps) in [(1e-3, 10.0, 10_000), (0.1, 0.3, 3), (1.0 / 240.0, 2.0, 480), (0.7, 0.7, 1)] {
            let horizon = Horizon::exact(step, duration).expect("whole");
            assert_eq!((horizon.steps, horizon.end, horizon.time(horizon.steps)), (steps, duration, duration));
        }
    }

    #[test]
    fn a_duration_between_two_steps_is_refused_and_names_what_fits() {
        let error = Horizon::exact(0.003, 10.0).expect_err("not whole").to_string();
        assert_eq!(
            error,
            "--duration 10 s is not a whole number of steps of 0.003 s; use --step 0.00299940011998 or --step \
             0.00300030003, or --duration 9.999 or 10.002"
        );
        assert_eq!(Horizon::nearest(0.003, 10.0).expect("nearest"), Horizon { step: 0.003, steps: 3333, end: 9.999 });
    }

    #[test]
    fn numbers_that_are_not_positive_are_named() {
        let message = |step, duration| Horizon::exact(step, duration).expect_err("refused").to_string();
        assert_eq!(message(-0.01, 1.0), "--step must be > 0 s, got -0.01");
        assert_eq!(message(f64::NAN, 1.0), "--step must be > 0 s, got NaN");
        assert_eq!(message(0.01, 0.0), "--duration must be > 0 s, got 0");
        assert_eq!(message(2.0, 1.0), "--duration 1 s is shorter than one step of 2 s; use --step 1 or less");
        assert!(message(1e-300, 1.0).starts_with("1.000e300 steps"));
    }
}
