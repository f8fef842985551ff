//! Straight lines by least squares.

/// Slope of `y` over `x` for `(x, y)` pairs.
pub(crate) fn slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let mean_x = points.iter().map(|p| p.0).sum::<f64>() / count;
    let mean_y = points.iter().map(|p| p.1).sum::<f64>() / count;
    let covariance: f64 = points.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    covariance / points.iter().map(|p| (p.0 - mean_x).powi(2)).sum::<f64>()
}

/// The power of `x > 0` that `y > 0` goes with: the slope of `ln y` over `ln x`.
pub(crate) fn power(points: &[(f64, f64)]) -> f64 {
    slope(&points.iter().map(|(x, y)| (x.ln(), y.ln())).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_has_its_power_and_a_line_its_slope() {
        let x: [f64; 4] = [0.1, 0.3, 1.0, 7.0];
        assert!((power(&x.map(|x| (x, 5.0 * x.powf(-2.5)))) + 2.5).abs() < 1e-14);
        assert!((slope(&x.map(|x| (x, 2.0 - 3.0 * x))) + 3.0).abs() < 1e-14);
    }
}
