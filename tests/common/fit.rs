//! Orders from errors.

/// Slope of log y over log x, least squares.
pub fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (mx, my) = points.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x.ln() / n, b + y.ln() / n));
    let (xy, xx) = points.iter().fold((0.0, 0.0), |(a, b), (x, y)| {
        let (dx, dy) = (x.ln() - mx, y.ln() - my);
        (a + dx * dy, b + dx * dx)
    });
    xy / xx
}
