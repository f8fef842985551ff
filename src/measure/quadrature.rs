//! The running integral of a function that is known at equal steps, to high order from the first step on.

/// Points that a rule takes in: it integrates polynomials of degree 7 exactly, and the integral has order 8.
pub(super) const POINTS: usize = 8;

/// `W_n`, the integral from 0 to `n h`, from the values at `0, h, 2h, ...`.
///
/// Each step `[t_(n-1), t_n]` is integrated with the polynomial through the last [`POINTS`] values (the Adams-Moulton rule
/// of order 8). The first steps wait until there are so many values and use the polynomial through these, so that no rule
/// of low order spoils the start.
#[derive(Clone, Debug)]
pub(super) struct RunningIntegral {
    /// Step size.
    h: f64,
    /// The last values, oldest first.
    values: Vec<f64>,
    /// Weights of the last step with [`POINTS`] values.
    last: [f64; POINTS],
    total: f64,
}

impl RunningIntegral {
    /// Starts with the value at 0.
    pub(super) fn new(h: f64, start: f64) -> RunningIntegral {
        let mut values = Vec::with_capacity(POINTS + 1);
        values.push(start);
        RunningIntegral { h, values, last: weights(POINTS, POINTS - 2), total: 0.0 }
    }

    /// Takes in the next value and calls `known` with each integral that is known from now on, in order.
    pub(super) fn push(&mut self, value: f64, known: impl FnMut(f64)) {
        let started = self.values.len() == POINTS;
        self.values.push(value);
        if started {
            self.values.remove(0);
            self.extend(&self.last.clone(), known);
        } else if self.values.len() == POINTS {
            self.settle(known);
        }
    }

    /// Ends the integral: calls `known` with what a run that is shorter than [`POINTS`] values still waits for.
    pub(super) fn finish(&mut self, known: impl FnMut(f64)) {
        if self.values.len() < POINTS {
            self.settle(known);
        }
    }

    /// The first steps, all with the values that there are.
    fn settle(&mut self, mut known: impl FnMut(f64)) {
        for interval in 0..self.values.len() - 1 {
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

    /// The largest error of the integral of `cos` over all its points on [0, 3].
    fn error(steps: u32) -> f64 {
        let h = 3.0 / f64::from(steps);
        let mut integral = RunningIntegral::new(h, 1.0);
        let mut found = vec![0.0];
        for n in 1..=steps {
            integral.push((f64::from(n) * h).cos(), |w| found.push(w));
        }
        integral.finish(|w| found.push(w));
        assert_eq!(found.len(), steps as usize + 1, "one integral a point");
        found.iter().enumerate().map(|(n, w)| (w - (n as f64 * h).sin()).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn the_integral_has_order_eight_from_the_first_step_on() {
        let order = (error(24) / error(48)).log2();
        // measured 7.7
        assert!((order - 8.0).abs() < 0.5, "{order}");
        assert!(error(48) > 1e-14 && error(48) < 1e-10, "{:e}", error(48));
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
