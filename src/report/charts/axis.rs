//! Axes with ticks at round numbers: linear, or logarithmic with powers of ten written as 10⁻⁶.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use crate::report::words::number::{plain, power_of_ten};

/// One axis of a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Axis {
    Linear {
        from: f64,
        to: f64,
    },
    /// Whole decades, `10^from` to `10^to`.
    Log {
        from: i32,
        to: i32,
    },
    /// `10^from` to `10^to`, which need not be whole decades.
    Part {
        from: f64,
        to: f64,
    },
}

/// Values keep this far from the ends of a logarithmic axis, as a fraction of its length: half a marker.
const EDGE: f64 = 0.03;

impl Axis {
    /// The whole decades, at least one, that hold all values; what is not positive does not count. Nothing below
    /// `floor` or above `ceiling` (exponents) is shown. `None` where no value counts.
    pub fn decades(values: impl Iterator<Item = f64>, floor: i32, ceiling: i32) -> Option<Axis> {
        // A marker on the very edge would be cut.
        let (low, high) = extent(values)?;
        let edge = EDGE * (high - low).max(1.0);
        let from = ((low - edge).floor() as i32).clamp(floor, ceiling - 1);
        let to = ((high + edge).ceil() as i32).clamp(from + 1, ceiling.max(from + 1));
        Some(Axis::Log { from, to })
    }

    /// A logarithmic axis that ends half a marker beyond the values. `None` where none is positive.
    pub fn around(values: impl Iterator<Item = f64>) -> Option<Axis> {
        let (low, high) = extent(values)?;
        let edge = EDGE * (high - low).max(1.0);
        Some(Axis::Part { from: low - edge, to: high + edge })
    }

    /// The nearest value that the axis has.
    pub(crate) fn clamped(self, value: f64) -> f64 {
        let Range { start, end } = self.range();
        value.clamp(start, end)
    }

    /// The fraction of the way along the axis, 0 to 1.
    fn fraction(self, value: f64) -> f64 {
        match self {
            Axis::Linear { from, to } => (value - from) / (to - from),
            Axis::Log { from, to } => (value.log10() - f64::from(from)) / f64::from(to - from),
            Axis::Part { from, to } => (value.log10() - from) / (to - from),
        }
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        limit.0 + (self.fraction(*value) * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let bold = hint.bold_points().max(2);
        match *self {
            Axis::Linear { from, to } => {
                let stride = round_stride((to - from) / bold as f64);
                let (first, last) = ((from / stride).ceil() as i64, (to / stride + 1e-9).floor() as i64);
                (first..=last).map(|k| k as f64 * stride).collect()
            }
            Axis::Part { from, to } => {
                let within = |x: &f64| x.log10() >= from && x.log10() <= to;
                let decades = from.floor() as i32..=to.floor() as i32;
                let factors: &[f64] = if hint.weight().allow_light_points() {
                    &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]
                } else if to - from <= 3.0 {
                    &[1.0, 2.0, 5.0]
                } else {
                    &[1.0]
                };
                decades.flat_map(|k| factors.iter().map(move |m| m * 10f64.powi(k))).filter(within).collect()
            }
            Axis::Log { from, to } => {
                let stride = [1, 2, 3, 5, 10].into_iter().find(|s| (to - from) / s < bold as i32).unwrap_or(20);
                let decades = from..=to;
                if !hint.weight().allow_light_points() {
                    return decades.filter(|k| k % stride == 0).map(|k| 10f64.powi(k)).collect();
                }
                match to - from {
                    0..=5 => (from..to).flat_map(|k| (1..10).map(move |m| f64::from(m) * 10f64.powi(k))).collect(),
                    _ => decades.map(|k| 10f64.powi(k)).collect(),
                }
            }
        }
    }

    fn range(&self) -> Range<f64> {
        match *self {
            Axis::Linear { from, to } => from..to,
            Axis::Log { from, to } => 10f64.powi(from)..10f64.powi(to),
            Axis::Part { from, to } => 10f64.powf(from)..10f64.powf(to),
        }
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        match self {
            Axis::Linear { .. } => plain(*value, 4),
            Axis::Part { .. } => plain(*value, 2),
            Axis::Log { .. } => power_of_ten(value.log10().round() as i32),
        }
    }
}

/// The logarithms of the smallest and the largest value; what is not positive does not count.
fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let counted = values.filter(|x| *x > 0.0 && x.is_finite()).map(f64::log10);
    let (low, high) = counted.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    (low <= high).then_some((low, high))
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `x`.
fn round_stride(x: f64) -> f64 {
    let power = 10f64.powf(x.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= x * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use plotters::coord::ranged1d::BoldPoints;

    use super::*;

    #[test]
    fn decades_hold_the_values_and_their_ticks_are_powers_of_ten() {
        let axis = Axis::decades([3e-7, 0.0, 2e-3].into_iter(), -17, 2).expect("values");
        assert_eq!(axis, Axis::Log { from: -7, to: -2 });
        let ticks: Vec<String> = axis.key_points(BoldPoints(10)).iter().map(|x| axis.format_ext(x)).collect();
        assert_eq!(ticks, ["10⁻⁷", "10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²"]);
        assert_eq!(Axis::decades([3e-3].into_iter(), -17, 2), Some(Axis::Log { from: -3, to: -2 }));
        // The marker of 7e-3 would reach beyond 1e-2 on an axis of 14 decades, and does not on one of two.
        assert_eq!(Axis::decades([2e-16, 7e-3].into_iter(), -18, 2), Some(Axis::Log { from: -17, to: -1 }));
        assert_eq!(Axis::decades([2e-4, 7e-3].into_iter(), -18, 2), Some(Axis::Log { from: -4, to: -2 }));
        assert_eq!(Axis::decades([1e9, 1e-30].into_iter(), -17, 2), Some(Axis::Log { from: -17, to: 2 }));
        assert_eq!(Axis::decades([0.0, f64::NAN].into_iter(), -17, 2), None);
    }

    #[test]
    fn an_axis_around_values_leaves_room_for_their_markers() {
        let axis = Axis::around([1.0, 100.0, 0.0].into_iter()).expect("values");
        assert_eq!(axis.key_points(BoldPoints(6)), [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
        let range = axis.range();
        assert!(range.start < 0.9 && range.start > 0.8 && range.end > 110.0 && range.end < 120.0, "{range:?}");
    }

    #[test]
    fn linear_ticks_are_round() {
        let ticks = Axis::Linear { from: 0.0, to: 10.0 }.key_points(BoldPoints(6));
        assert_eq!(ticks, [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
    }
}
