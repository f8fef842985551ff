//! Adaptive integration of `dy/dt = f(t, y)`: stages, estimate of the error, control of the step and the first step of
//! DOP853 (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, 2nd ed. 1993, sections II.4 and
//! II.10). No dense output, no test of stiffness.

use super::tableau::{A, B, C, LESS_FIFTH, STAGES, THIRD};

/// The step has become too small to go on, or the equations have no value.
#[derive(Debug)]
pub struct TooSmall;

/// `f(t, y)`, written into its last argument.
pub type Rates<'a> = &'a mut dyn FnMut(f64, &[f64], &mut [f64]);

/// A step is not to change by less or more than these factors, nor to aim at the tolerance itself.
const LEAST_GROWTH: f64 = 0.2;
const MOST_GROWTH: f64 = 10.0;
const SAFETY: f64 = 0.9;

pub struct Integrator {
    pub time: f64,
    /// The step that will be tried next, s.
    pub step: f64,
    pub y: Vec<f64>,
    tolerance: f64,
    /// The last step that was accepted, s; 0 before the first.
    accepted: f64,
    /// Whether the last try was rejected.
    rejected: bool,
    /// `k_i`; the first is `f` at the present state.
    rates: [Vec<f64>; STAGES],
}

impl Integrator {
    /// From a state, with the step to be tried first or, where there is none, one that the equations suggest.
    pub fn new(tolerance: f64, time: f64, y: Vec<f64>, step: Option<f64>, f: Rates) -> Result<Integrator, TooSmall> {
        let mut rates = std::array::from_fn(|_| vec![0.0; y.len()]);
        f(time, &y, &mut rates[0]);
        let step = step.unwrap_or_else(|| first_step(tolerance, time, &y, &rates[0], f));
        if !(step > 0.0 && step.is_finite()) {
            return Err(TooSmall);
        }
        Ok(Integrator { time, step, y, tolerance, accepted: 0.0, rejected: false, rates })
    }

    /// Tries a step; the time stays where it is rejected.
    pub fn step(&mut self, f: Rates) -> Result<(), TooSmall> {
        if self.step < self.accepted * 1e-14 {
            return Err(TooSmall);
        }
        let h = self.step;
        for i in 1..STAGES {
            let mut at = self.y.clone();
            for (a, rate) in A[i][..i].iter().zip(&self.rates) {
                add_scaled(&mut at, a * h, rate);
            }
            f(self.time + C[i] * h, &at, &mut self.rates[i]);
        }
        let slope = self.combined(vec![0.0; self.y.len()], &B);
        let mut next = self.y.clone();
        add_scaled(&mut next, h, &slope);
        let error = self.error(&next, slope);
        let wanted = SAFETY * error.powf(-0.125);
        let growth = if wanted.is_nan() { LEAST_GROWTH } else { wanted.clamp(LEAST_GROWTH, MOST_GROWTH) };
        let accepted = error <= 1.0;
        if accepted {
            (self.accepted, self.time, self.y) = (h, self.time + h, next);
            f(self.time, &self.y, &mut self.rates[0]);
        }
        // After a rejection the step does not grow at once.
        self.step *= if accepted && self.rejected { growth.min(1.0) } else { growth };
        self.rejected = !accepted;
        Ok(())
    }

    /// `start + sum_i w_i k_i`
    fn combined(&self, mut start: Vec<f64>, weights: &[f64; STAGES]) -> Vec<f64> {
        for (weight, rate) in weights.iter().zip(&self.rates) {
            add_scaled(&mut start, *weight, rate);
        }
        start
    }

    /// `h e5^2 / sqrt(n (e5^2 + e3^2 / 100))` in units of the tolerance, of the differences from the embedded methods
    /// (section II.10).
    fn error(&self, next: &[f64], slope: Vec<f64>) -> f64 {
        let squares = |difference: &[f64]| {
            let scales = self.y.iter().zip(next).map(|(a, b)| self.tolerance + self.tolerance * a.abs().max(b.abs()));
            difference.iter().zip(scales).map(|(d, scale)| d / scale).fold(0.0, |sum, e| sum + e * e)
        };
        let fifth = squares(&self.combined(vec![0.0; self.y.len()], &LESS_FIFTH));
        let third = squares(&self.combined(slope, &THIRD.map(|weight| -weight)));
        let mut size = fifth + 0.01 * third;
        if size <= 0.0 {
            size = 1.0;
        }
        self.step.abs() * fifth * (1.0 / (size * self.y.len() as f64)).sqrt()
    }
}

fn add_scaled(to: &mut [f64], factor: f64, values: &[f64]) {
    to.iter_mut().zip(values).for_each(|(to, value)| *to += factor * value);
}

/// A step whose explicit Euler error is about 0.01 of the tolerance (section II.4, "starting step size").
fn first_step(tolerance: f64, time: f64, y: &[f64], rate: &[f64], f: Rates) -> f64 {
    let scales: Vec<f64> = y.iter().map(|y| tolerance + tolerance * y.abs()).collect();
    let squares = |values: &mut dyn Iterator<Item = f64>| {
        values.zip(&scales).map(|(value, scale)| value / scale).fold(0.0, |sum, e| sum + e * e)
    };
    let (of_rate, of_state) = (squares(&mut rate.iter().copied()), squares(&mut y.iter().copied()));
    let small = of_rate <= 1e-10 || of_state <= 1e-10;
    let h = if small { 1e-6 } else { (of_state / of_rate).sqrt() * 0.01 };
    let mut euler = y.to_vec();
    add_scaled(&mut euler, h, rate);
    let mut then = vec![0.0; y.len()];
    f(time + h, &euler, &mut then);
    let second = squares(&mut then.iter().zip(rate).map(|(a, b)| a - b)).sqrt() / h.abs();
    let largest = of_rate.sqrt().max(second);
    let wanted = if largest <= 1e-15 { h * 1e-3 } else { (0.01 / largest).powf(0.125) };
    (h * 100.0).min(wanted)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error after a time of `y'' = -y` from `(1, 0)`, and the steps that were tried.
    fn oscillator(tolerance: f64, duration: f64) -> (f64, u32) {
        let f: Rates = &mut |_, y, rate| (rate[0], rate[1]) = (y[1], -y[0]);
        let mut integrator = Integrator::new(tolerance, 0.0, vec![1.0, 0.0], None, f).expect("a first step");
        let mut tried = 0;
        while integrator.time < duration {
            integrator.step = integrator.step.min(duration - integrator.time);
            integrator.step(f).expect("a step");
            tried += 1;
        }
        let error = (integrator.y[0] - duration.cos()).hypot(integrator.y[1] + duration.sin());
        (error, tried)
    }

    #[test]
    fn the_error_follows_the_tolerance() {
        for tolerance in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
            let (error, tried) = oscillator(tolerance, 10.0);
            println!("{tolerance:e}: {error:.1e}, {tried} steps");
            assert!(error > 0.0 && error <= 10.0 * tolerance, "{tolerance:e}: {error:e}");
        }
    }

    /// `y' = y^2` from 1 is infinite at 1.
    #[test]
    fn an_equation_that_runs_away_ends_with_an_error() {
        let f: Rates = &mut |_, y, rate| rate[0] = y[0] * y[0];
        let mut integrator = Integrator::new(1e-10, 0.0, vec![1.0], None, f).expect("a first step");
        let ended = (0..100_000).find_map(|_| integrator.step(f).err());
        assert!(ended.is_some() && (integrator.time - 1.0).abs() < 1e-9, "{}", integrator.time);
        assert!(Integrator::new(1e-10, 0.0, vec![f64::NAN], None, f).is_err());
    }
}
