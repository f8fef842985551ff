//! The trajectory that runs are judged by, its estimated error, and how long it can be trusted.
//!
//! The trajectory is that of an engine which shares no dynamics with the others; its error is estimated from its
//! disagreement with other trajectories of the same system. A chaotic system doubles every error again and again, so
//! each trajectory is worth something for a while only: until the estimate passes `TRUSTED`.

use crate::measure::scales;
use crate::mechanics::{State, System};
use crate::numeric::larger;

/// The relative error up to which the truth is trusted: of lengths over the reach of the system, and rad.
pub(crate) const TRUSTED: f64 = 1e-8;

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
    /// s; the end of the run, or the last time at which the estimate is below `TRUSTED`.
    pub trusted_until: f64,
}

/// States at the first of some given times, at all of them unless the trajectory could not be continued; `None` at a
/// time that it was not evaluated at.
pub(crate) type Trajectory = Vec<Option<State>>;

impl Truth {
    /// Judges `states` by their disagreement with each of `others`, which all have the same `times`, and keeps what can
    /// be trusted.
    pub fn new(system: &System, method: String, times: &[f64], states: Vec<State>, others: &[Trajectory]) -> Truth {
        let reach = scales::reach(system);
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
    pub(crate) fn at_multiples(&self, interval: f64, end: f64) -> Truth {
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

/// The largest difference of a centre of mass over a length (m), or of an attitude, rad; NaN where one is.
pub fn disagreement(a: &State, b: &State, length: f64) -> f64 {
    a.bodies
        .iter()
        .zip(&b.bodies)
        .flat_map(|(a, b)| [(a.position - b.position).norm() / length, a.attitude.angle_to(&b.attitude)])
        .fold(0.0, larger)
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
    fn a_subset_has_the_multiples_of_an_interval() {
        let system = flywheel(2.0, 0.0, 1.0);
        let times: Vec<f64> = (1..=10).map(|k| 0.1 * f64::from(k)).collect();
        let states = times.iter().map(|t| turned(&system, *t)).collect();
        let truth = Truth { times, states, estimates: vec![1e-12; 10], trusted_until: 1.0, ..Truth::default() };
        let some = truth.at_multiples(0.2, 0.8);
        assert_eq!((some.times.len(), some.states[0] == truth.states[1]), (4, true));
    }
}
