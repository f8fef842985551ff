//! The trajectory that runs are judged by, its estimated error, and how long it can be trusted.
//!
//! The trajectory is that of an engine which shares no dynamics with the others; its error is estimated from its
//! disagreement with other trajectories of the same system. A chaotic system doubles every error again and again, so
//! each trajectory is worth something for a while only: until the estimate passes [`TRUSTED`].

use crate::measure::Horizon;
use crate::mechanics::{State, System};

/// The relative error up to which the truth is trusted: of lengths over the reach of the system, and rad.
pub const TRUSTED: f64 = 1e-8;

/// About so many samples make up a run.
const SAMPLES: f64 = 200.0;

/// The true states at some times, as far as they can be trusted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// How the states and the estimate of their error were found.
    pub method: String,
    /// Rising, s; the start of the run is not among them.
    pub times: Vec<f64>,
    /// One for each time.
    pub states: Vec<State>,
    /// The estimated relative error of each state.
    pub estimates: Vec<f64>,
    /// s; the end of the run, or the last time at which the estimate is below [`TRUSTED`].
    pub trusted_until: f64,
}

/// States at the first of some given times, at all of them unless the trajectory could not be continued; `None` at a time
/// that it was not evaluated at.
pub type Trajectory = Vec<Option<State>>;

impl Truth {
    /// Judges `states` by their disagreement with each of `others`, which all have the same `times`, and keeps what can be
    /// trusted.
    pub fn new(system: &System, method: String, times: &[f64], states: Vec<State>, others: &[Trajectory]) -> Truth {
        let reach = reach(system);
        let mut estimates = Vec::with_capacity(times.len());
        for (k, state) in states.iter().enumerate().take(times.len()) {
            let estimate = others
                .iter()
                .map(|other| match other.get(k) {
                    Some(Some(other)) => disagreement(state, other, reach),
                    Some(None) => 0.0,
                    None => f64::INFINITY,
                })
                .fold(0.0, larger);
            if !(estimate <= TRUSTED) {
                break;
            }
            estimates.push(estimate);
        }
        let kept = estimates.len();
        Truth {
            method,
            times: times[..kept].to_vec(),
            states: states.into_iter().take(kept).collect(),
            estimates,
            trusted_until: if kept == 0 { 0.0 } else { times[kept - 1] },
        }
    }

    /// The largest estimated error.
    pub fn error_estimate(&self) -> f64 {
        self.estimates.iter().copied().fold(0.0, f64::max)
    }

    /// The truth at multiples of `interval` (s) up to `end` (s).
    pub fn at_multiples(&self, interval: f64, end: f64) -> Truth {
        let near = 1e-6 * interval;
        let wanted = |t: f64| t <= end + near && (t - interval * (t / interval).round()).abs() <= near;
        let chosen: Vec<usize> = (0..self.times.len()).filter(|&k| wanted(self.times[k])).collect();
        Truth {
            method: self.method.clone(),
            times: chosen.iter().map(|&k| self.times[k]).collect(),
            states: chosen.iter().map(|&k| self.states[k].clone()).collect(),
            estimates: chosen.iter().map(|&k| self.estimates[k]).collect(),
            trusted_until: self.trusted_until,
        }
    }
}

/// The larger of two, and infinity where one is not a number.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// The largest difference of a body's place over `reach` (m), or of its attitude, rad.
pub fn disagreement(a: &State, b: &State, reach: f64) -> f64 {
    a.bodies
        .iter()
        .zip(&b.bodies)
        .flat_map(|(a, b)| [(a.position - b.position).norm() / reach, a.attitude.angle_to(&b.attitude)])
        .fold(0.0, larger)
}

/// A length that belongs to the system, m: the longest path along the tree from the ground's joint to a centre of mass or,
/// where all of them are zero, the largest radius of gyration.
pub fn reach(system: &System) -> f64 {
    let mut to_joint: Vec<f64> = Vec::with_capacity(system.bodies.len());
    let mut longest = 0.0f64;
    for body in &system.bodies {
        let joint = &body.joint;
        let path = joint.parent.map_or(0.0, |p| {
            let parent_origin = system.bodies[p].joint.in_child.translation.vector;
            to_joint[p] + (joint.in_parent.translation.vector - parent_origin).norm()
        });
        to_joint.push(path);
        longest = longest.max(path + joint.in_child.translation.vector.norm());
    }
    if longest > 0.0 {
        return longest;
    }
    system.bodies.iter().map(|b| (b.inertia.max() / b.mass).sqrt()).fold(0.0, f64::max)
}

/// A round interval, s, which about `SAMPLES` of make up a duration.
pub fn sampling_interval(duration: f64) -> f64 {
    round_below(duration / SAMPLES)
}

/// The largest of 1, 2, 5 times a power of ten that is not above `x`.
pub fn round_below(x: f64) -> f64 {
    let power = 10f64.powf((x.log10() + 1e-9).floor());
    let mantissa = [5.0, 2.0, 1.0].into_iter().find(|m| m * power <= x * (1.0 + 1e-9)).unwrap_or(1.0);
    format!("{:e}", mantissa * power).parse().unwrap_or(mantissa * power)
}

/// The times to know the truth at, rising: multiples of the sampling interval up to the longest horizon, and for each
/// horizon the times nearest to these that it has.
pub fn sampling_times(horizons: &[Horizon]) -> Vec<f64> {
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
    use nalgebra::{UnitQuaternion, Vector3};

    use super::*;
    use crate::measure::synthetic::flywheel;

    fn turned(system: &System, angle: f64) -> State {
        let mut state = system.initial.clone();
        state.bodies[0].attitude = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        state
    }

    #[test]
    fn the_truth_ends_where_its_estimate_passes_the_limit() {
        let system = flywheel(2.0, 0.0, 1.0);
        let times: Vec<f64> = (1..=10).map(f64::from).collect();
        let states = |error: &dyn Fn(f64) -> f64| -> Trajectory {
            times.iter().map(|t| Some(turned(&system, t + error(*t)))).collect()
        };
        let main: Vec<State> = states(&|_| 0.0).into_iter().flatten().collect();
        // The error grows tenfold a second and is 1e-8 at 6.5 s.
        let grown = states(&|t| 1e-8 * 10f64.powf(t - 6.5));
        let close = states(&|_| 1e-12);
        let truth = Truth::new(&system, "test".into(), &times, main.clone(), &[close.clone(), grown]);
        assert_eq!((truth.trusted_until, truth.times.len(), truth.states.len()), (6.0, 6, 6));
        assert!((truth.error_estimate() / 10f64.powf(-8.5) - 1.0).abs() < 1e-6, "{:e}", truth.error_estimate());
        let whole = Truth::new(&system, "test".into(), &times, main.clone(), std::slice::from_ref(&close));
        assert!(whole.trusted_until == 10.0 && (whole.error_estimate() - 1e-12).abs() < 1e-15);
        // What the check did not reach is not trusted, and what is not a number neither.
        let truth = Truth::new(&system, "test".into(), &times, main.clone(), &[close[..3].to_vec()]);
        assert_eq!(truth.trusted_until, 3.0);
        let mut lost = close;
        lost[2] = None;
        lost[4].as_mut().expect("a state").bodies[0].position.x = f64::NAN;
        assert_eq!(Truth::new(&system, "test".into(), &times, main, &[lost]).trusted_until, 4.0);
    }

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

    #[test]
    fn a_subset_has_the_multiples_of_an_interval() {
        let system = flywheel(2.0, 0.0, 1.0);
        let times: Vec<f64> = (1..=10).map(|k| 0.1 * f64::from(k)).collect();
        let states = times.iter().map(|t| turned(&system, *t)).collect();
        let truth = Truth { times, states, estimates: vec![1e-12; 10], trusted_until: 1.0, ..Truth::default() };
        let some = truth.at_multiples(0.2, 0.8);
        assert_eq!((some.times.len(), some.states[0] == truth.states[1]), (4, true));
    }
}
