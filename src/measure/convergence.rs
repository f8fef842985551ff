//! How the error of an engine falls with its step size: the fitted order, and the floor where it stops falling.

use super::run::Run;
use crate::engines::Spec;
use crate::numeric::fit::power;

/// Errors above this are not small: what they do with the step says nothing about the order.
const SMALL: f64 = 0.3;

/// Points near the floor do not count: only those this many times above it.
const ABOVE_FLOOR: f64 = 10.0;

/// Errors below this have roundoff in them, and do not count.
const EXACT: f64 = 1e-13;

/// An error below this many times that of the reference counts as long as the errors fall as steeply as before: the
/// estimate of the reference's error is a careful one, and where two independent methods agree better, both are better.
const ABOVE_REFERENCE: f64 = 3.0;

/// As steeply as before: by at least this part of the power of the pair before.
const AS_STEEP: f64 = 0.8;

/// The order is fitted to this many of the finest steps that count.
const FITTED: usize = 4;

/// A floor below this is roundoff.
pub const ROUNDOFF: f64 = 1e-10;

/// So is one of up to this many times the error of the reference.
const FROM_REFERENCE: f64 = 10.0;

/// Where the last halvings of the step gain less than this power of it, the error has stopped falling.
const STALLED: f64 = 0.3;

/// What the errors at several step sizes say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Convergence {
    /// Slope of the logarithm of the error over that of the step; `None` with fewer than three errors that count.
    pub order: Option<f64>,
    /// The smallest error, where it has stopped falling.
    pub floor: Option<f64>,
    pub verdict: Verdict,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The error falls with the step, as far as steps were taken.
    Converges,
    /// It falls until roundoff ends it.
    ToRoundoff,
    /// It stops falling far above roundoff.
    DoesNotConverge,
    /// It is not small at any step that was taken.
    NotSmall,
}

impl Verdict {
    /// For tables.
    pub fn words(self) -> &'static str {
        match self {
            Verdict::Converges => "converges",
            Verdict::ToRoundoff => "to roundoff",
            Verdict::DoesNotConverge => "does not converge",
            Verdict::NotSmall => "not small yet",
        }
    }
}

/// The convergence of every engine setting that was run at several step sizes, with the setting. One that chooses its
/// own steps has none.
pub(crate) fn of_settings(runs: &[Run], reference_error: f64) -> Vec<(&Spec, Convergence)> {
    runs.chunk_by(|a, b| a.engine.to_string() == b.engine.to_string())
        .filter(|runs| runs[0].engine.entry().tolerance.is_none())
        .filter_map(|runs| {
            let points: Vec<(f64, f64)> =
                runs.iter().filter_map(|r| Some((r.horizon.step, r.joint_error()?))).collect();
            Some((&runs[0].engine, judge(&points, reference_error)?))
        })
        .collect()
}

/// Judges `(step, error)` pairs; the errors are known to `reference_error`. `None` with fewer than three pairs.
pub(crate) fn judge(points: &[(f64, f64)], reference_error: f64) -> Option<Convergence> {
    let mut points: Vec<(f64, f64)> =
        points.iter().copied().filter(|(h, e)| *h > 0.0 && e.is_finite() && *e > 0.0).collect();
    points.sort_by(|a, b| b.0.total_cmp(&a.0));
    if points.len() < 3 {
        return None;
    }
    let small: Vec<(f64, f64)> = points.iter().copied().filter(|(_, e)| *e <= SMALL).collect();
    if small.len() < 2 {
        return Some(Convergence { order: None, floor: None, verdict: Verdict::NotSmall });
    }
    let lowest = small.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
    let roundoff = ROUNDOFF.max(FROM_REFERENCE * reference_error);
    let floor = stalled(&small, roundoff).then_some(lowest);
    let smallest = EXACT.max(floor.map_or(0.0, |floor| ABOVE_FLOOR * floor));
    let mut falling: Vec<(f64, f64)> = small.iter().copied().take_while(|p| p.1 > smallest).collect();
    let unsure = |p: &[(f64, f64)]| p[2].1 < ABOVE_REFERENCE * reference_error;
    let flatter = |p: &[(f64, f64)]| power(&p[1..]) < AS_STEEP * power(&p[..2]);
    if let Some(i) = falling.windows(3).position(|p| unsure(p) && flatter(p)) {
        falling.truncate(i + 2);
    }
    let fitted = &falling[falling.len().saturating_sub(FITTED)..];
    let verdict = match floor {
        None => Verdict::Converges,
        Some(floor) if floor <= roundoff => Verdict::ToRoundoff,
        Some(_) => Verdict::DoesNotConverge,
    };
    Some(Convergence { order: (fitted.len() >= 3).then(|| power(fitted)), floor, verdict })
}

/// Whether the errors at the finest steps fall by less than the power [`STALLED`] of the step: over the last pair and,
/// above roundoff, over the last three together, so that one lucky error is not taken for a floor.
fn stalled(points: &[(f64, f64)], roundoff: f64) -> bool {
    let last = points.len() - 1;
    let before = |k: usize| points[last.saturating_sub(k)];
    let end = points[last];
    let gains = |from: (f64, f64)| (end.1 / from.1).ln() > STALLED * (end.0 / from.0).ln();
    let risen = points[..last].iter().any(|p| p.1 < end.1);
    gains(before(1)) && (end.1 <= roundoff || last < 2 || risen || gains(before(2)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEPS: [f64; 8] = [0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 5e-4];

    fn judged(error: impl Fn(f64) -> f64) -> Convergence {
        let points: Vec<(f64, f64)> = STEPS.iter().map(|h| (*h, error(*h))).collect();
        judge(&points, 0.0).expect("enough points")
    }

    #[test]
    fn a_power_of_the_step_has_its_order() {
        for order in [1, 2, 4] {
            let found = judged(|h| 0.7 * h.powi(order));
            assert!((found.order.expect("fitted") - f64::from(order)).abs() < 1e-9, "{found:?}");
            assert_eq!((found.verdict, found.floor), (Verdict::Converges, None));
        }
    }

    #[test]
    fn a_floor_far_above_roundoff_is_no_convergence() {
        let found = judged(|h| h + 5e-3);
        assert_eq!(found.verdict, Verdict::DoesNotConverge);
        assert!((found.floor.expect("a floor") - 5.5e-3).abs() < 1e-12, "{found:?}");
        // Single precision: the error rises again.
        let rising = judged(|h| h + 1e-6 / h);
        assert_eq!(rising.verdict, Verdict::DoesNotConverge);
        assert!((rising.floor.expect("a floor") - 2e-3).abs() < 1e-12);
    }

    #[test]
    fn roundoff_is_told_from_a_floor() {
        let found = judged(|h| 1e4 * h.powi(8) + 1e-13 / h.sqrt());
        assert_eq!(found.verdict, Verdict::ToRoundoff);
        assert!((found.order.expect("fitted") - 8.0).abs() < 0.5, "{found:?}");
        // Two errors at roundoff are enough.
        let found = judged(|h| h.powi(6).max(1e-14));
        assert_eq!((found.verdict, found.floor), (Verdict::ToRoundoff, Some(1e-14)));
        assert!((found.order.expect("fitted") - 6.0).abs() < 1e-9, "{found:?}");
        let limit = judge(&STEPS.map(|h| (h, h.powi(4) + 1e-9)), 2e-10).expect("points");
        assert_eq!(limit.verdict, Verdict::ToRoundoff);
    }

    #[test]
    fn errors_that_reach_roundoff_at_the_finest_step_do_not_bend_the_order() {
        // Order 8 on a double pendulum: the last error is roundoff, but fell.
        let points = [
            (1.0 / 30.0, 5.6e-10),
            (0.025, 5.5e-11),
            (0.02, 9.2e-12),
            (1.0 / 70.0, 6e-13),
            (0.01, 3.2e-14),
            (0.005, 5e-15),
        ];
        let found = judge(&points, 4e-14).expect("enough points");
        assert!((found.order.expect("fitted") - 8.0).abs() < 0.15, "{found:?}");
        assert_eq!(found.verdict, Verdict::Converges);
        // Nor do those that the reference hides. Those that fall on count although its estimate is larger.
        let hidden: Vec<(f64, f64)> = points.iter().map(|(h, e)| (*h, e + 1e-12)).collect();
        let found = judge(&hidden, 2e-12).expect("enough points");
        assert!((found.order.expect("fitted") - 8.0).abs() < 0.15, "{found:?}");
        let found = judge(&points, 1e-10).expect("enough points");
        assert!((found.order.expect("fitted") - 8.0).abs() < 0.15, "{found:?}");
    }

    #[test]
    fn what_is_not_small_is_not_judged() {
        assert_eq!(judged(|_| 2.0).verdict, Verdict::NotSmall);
        assert_eq!(judge(&[(0.1, 0.1), (0.05, 0.05)], 0.0), None);
        // Large errors at coarse steps do not spoil the order.
        let found = judged(|h| if h > 0.01 { 2.0 } else { 100.0 * h * h });
        assert!((found.order.expect("fitted") - 2.0).abs() < 1e-9);
    }
}
