//! Extremes that no NaN escapes.

/// The larger of two numbers; NaN where one is.
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}
