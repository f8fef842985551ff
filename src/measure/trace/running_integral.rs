//! The running integral of a function that is known at equal steps, to high order from the first step to the last.

use std::ops::Range;

/// Points that a rule takes in: it integrates polynomials of degree 11 exactly, and the integral has order 12.
pub(super) const POINTS: usize = 12;

/// The interval between the two middle points of a rule, where its error is least.
const MIDDLE: usize = POINTS / 2 - 1;

/// `W_n`, the integral from 0 to `n h`, from the values at `0, h, 2h, ...`.
///
/// Each step `[t_(n-1), t_n]` is integrated with the polynomial through [`POINTS`] values, half of them on either side,
/// so that an integral is known some steps later. The first and the last steps use the first and the last values, so
/// that no rule of low order spoils the ends; a shorter run uses the polynomial through all that it has.
#[derive(Clone, Debug)]
pub(super) struct RunningIntegral {
    /// Step size.
    h: f64,
    /// The last values, oldest first.
    values: Vec<f64>,
    /// Weights for the middle interval.
    middle: [f64; POINTS],
    total: f64,
}

impl RunningIntegral {
    /// Starts with the value at 0.
    pub(super) fn new(h: f64, start: f64) -> RunningIntegral {
        let mut values = Vec::with_capacity(POINTS + 1);
        values.push(start);
        RunningIntegral { h, values, middle: weights(POINTS, MIDDLE), total: 0.0 }
    }

    /// Takes in the next value and calls `known` with each integral that is known from now on, in order.
    pub(super) fn push(&mut self, value: f64, mut known: impl FnMut(f64)) {
        self.values.push(value);
        if self.values.len() == POINTS {
            self.settle(0..MIDDLE + 1, known);
        } else if self.values.len() > POINTS {
            self.values.remove(0);
            self.extend(&self.middle.clone(), &mut known);
        }
    }

    /// Ends the integral: calls `known` with what the last steps still wait for.
    pub(super) fn finish(&mut self, known: impl FnMut(f64)) {
        let count = self.values.len();
        let settled = if count < POINTS { 0 } else { MIDDLE + 1 };
        self.settle(settled..count - 1, known);
    }

    /// Some steps of those between the last values, with the polynomial through all of these.
    fn settle(&mut self, intervals: Range<usize>, mut known: impl FnMut(f64)) {
        for interval in intervals {
            self.extend(&weights(self.values.len(), interval), &mut known);
        }
    }

    fn extend(&mut self, weights: &[f64; POINTS], mut known: impl FnMut(f64)) {
        let sum: f64 = self.values.iter().zip(weights).map(|(value, weight)| value * weight).sum();
        self.total += self.h * sum;
        known(self.total);
    }
}

/// Weights of the values at `0, 1, ..., points - 1` in the integral over `[interval, interval + 1]` of the polynomial
/// through them: the integrals of Lagrange's polynomials.
fn weights(points: usize, interval: usize) -> [f64; POINTS] {
    let mut all = [0.0; POINTS];
    for (i, weight) in all.iter_mut().enumerate().take(points) {
        // Coefficients of prod_(k != i) (s + interval - k) / (i - k) in s = x - interval, lowest first.
        let mut coefficients = [0.0; POINTS];
        coefficients[0] = 1.0;
        for k in (0..points).filter(|&k| k != i) {
            let (root, scale) = (k as f64 - interval as f64, i as f64 - k as f64);
            for power in (0..POINTS).rev() {
                let shifted = if power > 0 { coefficients[power - 1] } else { 0.0 };
                coefficients[power] = (shifted - root * coefficients[power]) / scale;
            }
        }
        *weight = coefficients.iter().enumerate().map(|(power, c)| c / (power + 1) as f64).sum();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest error of the integral of `x^degree` over all its points, 1/5 apart from -2 to 2, over the largest of
    /// the exact values.
    fn error(degree: i32) -> f64 {
        let (h, steps) = (0.2, 20);
        let x = |n: usize| h * n as f64 - 2.0;
        let mut integral = RunningIntegral::new(h, x(0).powi(degree));
        let mut found = vec![0.0];
        for n in 1..=steps {
            integral.push(x(n).powi(degree), |w| found.push(w));
        }
        integral.finish(|w| found.push(w));
        assert_eq!(found.len(), steps + 1, "one integral a point");
        let exact = |n: usize| (x(n).powi(degree + 1) - x(0).powi(degree + 1)) / f64::from(degree + 1);
        let errors = found.iter().enumerate().map(|(n, w)| (w - exact(n)).abs());
        errors.fold(0.0, f64::max) / (0..=steps).map(|n| exact(n).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn polynomials_of_degree_eleven_are_integrated_exactly_from_the_first_step_to_the_last() {
        let errors = [0, 5, 11, 12].map(error);
        // measured at most 1.8e-15, and 2.8e-6
        assert!(errors[..3].iter().all(|e| *e < 5e-15) && errors[3] > 1e-9, "{errors:?}");
    }

    #[test]
    fn a_run_of_a_few_steps_is_integrated_with_what_it_has() {
        // One step is the trapezoidal rule, two are Simpson's.
        let mut one = RunningIntegral::new(0.5, 1.0);
        one.push(3.0, |_| unreachable!());
        one.finish(|w| assert_eq!(w, 1.0));
        let mut two = RunningIntegral::new(1.0, 0.0);
        [1.0, 4.0].into_iter().for_each(|x| two.push(x, |_| unreachable!()));
        let mut found = Vec::new();
        two.finish(|w| found.push(w));
        assert!((found[0] - 1.0 / 3.0).abs() < 1e-15 && (found[1] - 8.0 / 3.0).abs() < 1e-15, "{found:?}");
    }
}
