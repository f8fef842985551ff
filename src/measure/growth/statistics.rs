//! The statistics of the growth test, for values at equal distances in time.

use super::figures::Exponent;

/// 97.5 % of the normal distribution.
const NORMAL: f64 = 1.96;

/// The interval of Abry and Veitch takes octaves as independent and Gaussian; for Haar wavelets of a random walk it
/// holds the true exponent this much less often than it should. Fixed so that it does so for 95 % of random walks.
const HAAR_INTERVAL: f64 = 1.3;

/// Octaves that are always kept.
const FEWEST_OCTAVES: usize = 4;

/// 95 % of the F distribution with 1 and 13 degrees of freedom: sixteen values, three parameters.
const F_1_13: f64 = 4.67;

/// A straight line by least squares.
pub(super) struct Line {
    /// Change over the run.
    pub change: f64,
    /// Part of the variance that the line explains, 0 to 1.
    pub explained: f64,
    /// What is left without it.
    pub residual: Vec<f64>,
}

impl Line {
    pub(super) fn through(values: &[f64]) -> Line {
        let (n, mean) = (values.len() as f64, mean(values));
        let centre = 0.5 * (n - 1.0);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for (i, value) in values.iter().enumerate() {
            let (dx, dy) = (i as f64 - centre, value - mean);
            xx += dx * dx;
            xy += dx * dy;
            yy += dy * dy;
        }
        let slope = xy / xx;
        let residual = values.iter().enumerate().map(|(i, v)| v - mean - slope * (i as f64 - centre)).collect();
        Line { change: slope * n, explained: if yy > 0.0 { xy * xy / (xx * yy) } else { 0.0 }, residual }
    }

    /// `|slope|` over its standard error, reduced for residuals that remember.
    pub(super) fn t(&self) -> f64 {
        let freedom = self.residual.len() as f64 - 2.0;
        (self.explained / (1.0 - self.explained).max(0.0) * freedom).sqrt() / memory(&self.residual).sqrt()
    }

    /// The largest change over the run that the values do not exclude at 95 %.
    pub(super) fn largest_change(&self) -> f64 {
        let t = self.t();
        let error = if t > 0.0 { self.change.abs() / t } else { 0.0 };
        self.change.abs() + NORMAL * error
    }
}

/// By how much the variance of a mean is larger than for values without memory: `(1 + r) / (1 - r)` with the
/// correlation `r >= 0` of neighbours.
fn memory(residual: &[f64]) -> f64 {
    let square: f64 = residual.iter().map(|x| x * x).sum();
    let neighbours: f64 = residual.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let r = if square > 0.0 { (neighbours / square).max(0.0) } else { 0.0 };
    (1.0 + r) / (1.0 - r)
}

/// `R`: mean square of the running sum over mean square, in squares of the length.
pub(super) fn slowness(values: &[f64]) -> f64 {
    let (n, mean) = (values.len() as f64, mean(values));
    let (mut sum, mut sums, mut squares) = (0.0, 0.0, 0.0);
    for value in values {
        sum += value - mean;
        sums += sum * sum;
        squares += (value - mean) * (value - mean);
    }
    sums / (n * n * squares)
}

/// One octave: logarithms of time scale and of the mean square of its Haar coefficients, and the weight of the latter.
struct Octave {
    scale: f64,
    energy: f64,
    weight: f64,
}

/// Slope of the Haar deviation: 1/2 for a random walk, 1 for a line, -1/2 for white noise. Fine octaves are left out
/// until a straight line passes the chi-square test at 1 %.
pub(super) fn haar_exponent(values: &[f64]) -> Exponent {
    let octaves = octaves(values);
    let mut from = 0;
    loop {
        let used = &octaves[from..];
        let (slope, error, misfit) = weighted_slope(used);
        let freedom = used.len() as f64 - 2.0;
        if used.len() <= FEWEST_OCTAVES || misfit <= chi_square_99(freedom) {
            let (value, half) = (0.5 * slope, 0.5 * HAAR_INTERVAL * NORMAL * error);
            return Exponent { value, low: value - half, high: value + half };
        }
        from += 1;
    }
}

fn octaves(values: &[f64]) -> Vec<Octave> {
    let mut found = Vec::new();
    let mut width = 1;
    while 2 * width <= values.len() {
        let pairs = values.chunks_exact(2 * width);
        let count = pairs.len() as f64;
        let energy = pairs.map(|pair| (mean(&pair[..width]) - mean(&pair[width..])).powi(2)).sum::<f64>() / count;
        // The logarithm of a mean of n squares is biased by psi(n/2) - ln(n/2) and has the variance psi'(n/2).
        let (bias, variance) = (digamma(0.5 * count) - (0.5 * count).ln(), trigamma(0.5 * count));
        // A scale on which nothing happens must not end in ln 0.
        let energy = energy.max(f64::MIN_POSITIVE).ln() - bias;
        found.push(Octave { scale: (width as f64).ln(), energy, weight: 1.0 / variance });
        width *= 2;
    }
    found
}

/// Slope, its standard error, and the weighted sum of squares that it leaves.
fn weighted_slope(octaves: &[Octave]) -> (f64, f64, f64) {
    let sum = |f: &dyn Fn(&Octave) -> f64| octaves.iter().map(|o| o.weight * f(o)).sum::<f64>();
    let total = sum(&|_| 1.0);
    let (x, y) = (sum(&|o| o.scale) / total, sum(&|o| o.energy) / total);
    let xx = sum(&|o| (o.scale - x).powi(2));
    let slope = sum(&|o| (o.scale - x) * (o.energy - y)) / xx;
    let misfit = sum(&|o| (o.energy - y - slope * (o.scale - x)).powi(2));
    (slope, xx.recip().sqrt(), misfit)
}

/// Fits `a + c t^p` to means over equal parts of the run.
pub(super) fn power_law(values: &[f64]) -> Exponent {
    let grid: Vec<f64> = (5..=500).map(|k| f64::from(k) * 0.01).collect();
    let fits: Vec<(f64, Vec<f64>)> = grid.iter().map(|p| power_fit(values, *p)).collect();
    let best = (0..grid.len()).min_by(|&a, &b| fits[a].0.total_cmp(&fits[b].0)).unwrap_or(0);
    let (smallest, residual) = (fits[best].0, &fits[best].1);
    let freedom = values.len() as f64 - 3.0;
    let limit = smallest * (1.0 + F_1_13 / freedom * memory(residual)) + f64::MIN_POSITIVE;
    let allowed = || (0..grid.len()).filter(|&k| fits[k].0 <= limit);
    let (low, high) = (allowed().min().unwrap_or(best), allowed().max().unwrap_or(best));
    Exponent { value: grid[best], low: grid[low], high: grid[high] }
}

/// Sum of squares and residuals of the best `a + c t^p`.
fn power_fit(values: &[f64], p: f64) -> (f64, Vec<f64>) {
    let n = values.len() as f64;
    // The mean of t^p over each part, but for a factor.
    let x: Vec<f64> =
        (0..values.len()).map(|i| ((i as f64 + 1.0) / n).powf(p + 1.0) - (i as f64 / n).powf(p + 1.0)).collect();
    let (mx, my) = (mean(&x), mean(values));
    let xx: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
    let xy: f64 = x.iter().zip(values).map(|(x, y)| (x - mx) * (y - my)).sum();
    let residual: Vec<f64> = x.iter().zip(values).map(|(x, y)| y - my - xy / xx * (x - mx)).collect();
    (residual.iter().map(|r| r * r).sum(), residual)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// 99 % of the chi-square distribution (Wilson and Hilferty 1931).
fn chi_square_99(freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    freedom * (1.0 - spread + 2.326 * spread.sqrt()).powi(3)
}

/// By recurrence to an argument above 6 and the asymptotic series (Abramowitz and Stegun 6.3.18).
fn digamma(mut x: f64) -> f64 {
    let mut sum = 0.0;
    while x < 6.0 {
        sum -= 1.0 / x;
        x += 1.0;
    }
    sum + x.ln() - 0.5 / x - 1.0 / (12.0 * x * x) + 1.0 / (120.0 * x.powi(4))
}

/// As [`digamma`] (6.4.12).
fn trigamma(mut x: f64) -> f64 {
    let mut sum = 0.0;
    while x < 6.0 {
        sum += 1.0 / (x * x);
        x += 1.0;
    }
    sum + 1.0 / x + 0.5 / (x * x) + 1.0 / (6.0 * x.powi(3)) - 1.0 / (30.0 * x.powi(5))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_explains_a_line() {
        let line = Line::through(&[1.0, 3.0, 5.0, 7.0]);
        assert_eq!((line.change, line.explained), (8.0, 1.0));
        assert!(line.residual.iter().all(|r| r.abs() < 1e-15));
    }

    #[test]
    fn slowness_of_a_line_and_of_swings() {
        let line: Vec<f64> = (0..1000).map(f64::from).collect();
        assert!((slowness(&line) - 0.1).abs() < 1e-3, "{}", slowness(&line));
        for swings in [1.0, 3.0, 10.0] {
            let swing: Vec<f64> =
                (0..4000).map(|i| (std::f64::consts::TAU * swings * f64::from(i) / 4000.0).cos()).collect();
            let expected = 1.0 / (std::f64::consts::TAU * swings).powi(2);
            assert!((slowness(&swing) / expected - 1.0).abs() < 0.05, "{swings}: {}", slowness(&swing));
        }
    }

    #[test]
    fn digamma_and_trigamma_have_their_known_values() {
        let euler = 0.577_215_664_901_532_9;
        // psi(1/2) = -gamma - 2 ln 2, psi'(1/2) = pi^2 / 2, psi(1) = -gamma
        assert!((digamma(0.5) + euler + 2.0 * 2f64.ln()).abs() < 1e-7);
        assert!((digamma(1.0) + euler).abs() < 1e-7);
        assert!((trigamma(0.5) - std::f64::consts::PI.powi(2) / 2.0).abs() < 1e-6);
    }

    #[test]
    fn powers_are_found() {
        for p in [0.5, 1.0, 2.0] {
            let integral = |i: i32| (f64::from(i) / 16.0).powf(p + 1.0) / (p + 1.0);
            let values: Vec<f64> = (0..16).map(|i| 3.0 + 16.0 * (integral(i + 1) - integral(i))).collect();
            let found = power_law(&values);
            assert!((found.value - p).abs() < 1e-9 && found.low <= p && found.high >= p, "{p}: {found:?}");
        }
    }
}
