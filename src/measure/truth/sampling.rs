//! The times at which the truth is to be known.

use crate::measure::Horizon;

/// About so many samples make up a run.
const SAMPLES: f64 = 200.0;

/// A round interval, s, which about `SAMPLES` of make up a duration.
pub(crate) fn sampling_interval(duration: f64) -> f64 {
    round_below(duration / SAMPLES)
}

/// The largest of 1, 2, 5 times a power of ten that is not above `x`.
pub(crate) fn round_below(x: f64) -> f64 {
    let power = 10f64.powf((x.log10() + 1e-9).floor());
    let mantissa = [5.0, 2.0, 1.0].into_iter().find(|m| m * power <= x * (1.0 + 1e-9)).unwrap_or(1.0);
    format!("{:e}", mantissa * power).parse().unwrap_or(mantissa * power)
}

/// The times to know the truth at, rising: multiples of the sampling interval up to the longest horizon, and for each
/// horizon the times nearest to these that it has.
pub(crate) fn sampling_times(horizons: &[Horizon]) -> Vec<f64> {
    let end = horizons.iter().map(|h| h.end).fold(0.0, f64::max);
    if !(end > 0.0) {
        return Vec::new();
    }
    let interval = sampling_interval(end);
    let count = (end / interval * (1.0 + 1e-9)).floor() as u64;
    let grid: Vec<f64> = (1..=count).map(|k| k as f64 * interval).collect();
    let mut times = grid.clone();
    for horizon in horizons {
        for t in &grid {
            let n = ((t / horizon.step).round() as u64).clamp(1, horizon.steps);
            times.push(horizon.time(n));
        }
    }
    times.sort_by(f64::total_cmp);
    times.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * interval);
    times
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_round_and_every_horizon_has_its_own() {
        assert_eq!([sampling_interval(10.0), sampling_interval(5.0), sampling_interval(2.0)], [0.05, 0.02, 0.01]);
        assert_eq!([round_below(1.0), round_below(0.0499), round_below(2.5), round_below(9.9)], [1.0, 0.02, 2.0, 5.0]);
        let exact = |step| Horizon::exact(step, 10.0).expect("whole");
        assert_eq!(sampling_times(&[exact(0.01), exact(0.0005), exact(0.5)]).len(), 200);
        let odd = Horizon::nearest(0.003, 10.0).expect("a run");
        // Every third one of the 200 is a multiple of 0.15 s, which both have.
        let times = sampling_times(&[exact(0.01), odd]);
        assert!(times.windows(2).all(|w| w[0] < w[1]) && times.len() == 334, "{}", times.len());
        assert!(times.contains(&9.999) && times.last() == Some(&10.0));
    }
}
