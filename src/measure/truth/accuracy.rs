//! Position errors of a run against the truth, at times that both have.
//!
//! A *joint error* is the difference of one joint's coordinates: of an angle (rad, the short way round), of a length
//! (m), of the rotation of a ball or floating joint (rad, the angle between the two). A *pose error* is that of a body:
//! the distance between the two centres of mass (m) and the angle between the two attitudes (rad). Neither forgives an
//! error of phase: a pendulum that keeps its energy and swings too slowly is in the wrong place.

use std::f64::consts::TAU;

use nalgebra::{UnitQuaternion, Vector3};

use super::trusted::Truth;
use crate::mechanics::coordinates::{JointCoordinates, joint_coordinates};
use crate::mechanics::{Coordinate, JointKind, State, System};

/// The errors of a run, largest and root mean square over all samples and all joints or bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// rad or m
    pub joint: Spread,
    /// Of the centres of mass, m.
    pub position: Spread,
    /// rad
    pub attitude: Spread,
    /// Times at which the run was compared, and the last of them, s.
    pub samples: usize,
    pub until: f64,
}

/// Largest value with the time it was met, s, and root mean square.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    pub max: f64,
    pub at: f64,
    pub rms: f64,
}

/// Follows a run and compares it with the truth wherever the two have a time in common.
#[derive(Debug)]
pub(crate) struct Follower<'a> {
    system: &'a System,
    truth: &'a Truth,
    /// The next sample of the truth.
    next: usize,
    found: Vec<Sample>,
    /// Joint coordinates of the run and of the truth.
    coordinates: [Vec<JointCoordinates>; 2],
}

/// The errors at one time: for joints, positions and attitudes the largest and the mean of the squares.
#[derive(Clone, Copy, Debug)]
struct Sample {
    time: f64,
    largest: [f64; 3],
    mean_square: [f64; 3],
}

impl<'a> Follower<'a> {
    /// Starts before the first sample.
    pub fn new(system: &'a System, truth: &'a Truth) -> Follower<'a> {
        let coordinates = [system.initial_coordinates.clone(), system.initial_coordinates.clone()];
        Follower { system, truth, next: 0, found: Vec::with_capacity(truth.times.len()), coordinates }
    }

    /// Takes in the state at `time` (s) of a run with steps of `step` (s), which are told apart to a millionth of a
    /// step.
    pub fn add(&mut self, time: f64, step: f64, state: &State) {
        let near = 1e-6 * step;
        while self.truth.times.get(self.next).is_some_and(|t| *t < time - near) {
            self.next += 1;
        }
        if let (Some(t), Some(truth)) = (self.truth.times.get(self.next), self.truth.states.get(self.next))
            && *t <= time + near
        {
            let sample = self.compare(*t, state, truth);
            self.found.push(sample);
            self.next += 1;
        }
    }

    fn compare(&mut self, time: f64, state: &State, truth: &State) -> Sample {
        for (out, state) in self.coordinates.iter_mut().zip([state, truth]) {
            joint_coordinates(self.system, state, out);
        }
        let mut sample = Sample { time, largest: [0.0; 3], mean_square: [0.0; 3] };
        let count = self.system.bodies.len() as f64;
        for (i, body) in self.system.bodies.iter().enumerate() {
            let (a, b) = (&state.bodies[i], &truth.bodies[i]);
            let joint = joint_difference(body.joint.kind, &self.coordinates[0][i], &self.coordinates[1][i]);
            let errors = [joint, (a.position - b.position).norm(), a.attitude.angle_to(&b.attitude)];
            for ((largest, mean), error) in sample.largest.iter_mut().zip(&mut sample.mean_square).zip(errors) {
                *largest = largest.max(error);
                *mean += error * error / count;
            }
        }
        sample
    }

    /// The errors met so far; `None` where the run and the truth had no time in common.
    pub fn finish(self) -> Option<Accuracy> {
        let spread = |i: usize| {
            let largest = self.found.iter().max_by(|a, b| a.largest[i].total_cmp(&b.largest[i]))?;
            let squares: f64 = self.found.iter().map(|s| s.mean_square[i]).sum();
            Some(Spread { max: largest.largest[i], at: largest.time, rms: (squares / self.found.len() as f64).sqrt() })
        };
        Some(Accuracy {
            joint: spread(0)?,
            position: spread(1)?,
            attitude: spread(2)?,
            samples: self.found.len(),
            until: self.found.last()?.time,
        })
    }
}

/// The largest difference between two sets of coordinates of one joint, rad or m.
fn joint_difference(kind: JointKind, a: &JointCoordinates, b: &JointCoordinates) -> f64 {
    let length = |k: usize| (a.position[k] - b.position[k]).abs();
    let angle = |k: usize| {
        let difference = a.position[k] - b.position[k];
        (difference - TAU * (difference / TAU).round()).abs()
    };
    let turn = |k: usize| {
        let rotation = |p: &[f64; 6]| UnitQuaternion::from_scaled_axis(Vector3::new(p[k], p[k + 1], p[k + 2]));
        rotation(&a.position).angle_to(&rotation(&b.position))
    };
    let difference = |&(k, coordinate): &(usize, Coordinate)| match coordinate {
        Coordinate::Length => length(k),
        Coordinate::Angle => angle(k),
        Coordinate::RotationVector => turn(k),
    };
    kind.coordinates().iter().map(difference).reduce(f64::max).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::synthetic::flywheel;

    /// A flywheel at 1 rad/s, sampled every 0.1 s.
    fn turning() -> (System, Truth) {
        let system = flywheel(2.0, 0.0, 1.0);
        let times: Vec<f64> = (1..=100).map(|k| 0.1 * f64::from(k)).collect();
        let states = times.iter().map(|t| at_angle(&system, *t)).collect();
        (system, Truth { times, states, ..Truth::default() })
    }

    fn at_angle(system: &System, angle: f64) -> State {
        let mut state = system.initial.clone();
        state.bodies[0].attitude = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        state
    }

    fn accuracy(angle: impl Fn(f64) -> f64, step: f64) -> Accuracy {
        let (system, truth) = turning();
        let mut follower = Follower::new(&system, &truth);
        for n in 1..=(10.0 / step).round() as u32 {
            let time = f64::from(n) * step;
            follower.add(time, step, &at_angle(&system, angle(time)));
        }
        follower.finish().expect("times in common")
    }

    /// Its speed is right and its energy too, and at 10 s it has lost 0.02 rad.
    #[test]
    fn a_delay_is_an_error_of_position() {
        let found = accuracy(|t| t - 2e-3 * t, 0.01);
        assert!((found.joint.max - 0.02).abs() < 1e-14 && found.joint.at == 10.0, "{found:?}");
        // The mean of k^2 over k = 1..100 is 3383.5.
        assert!((found.joint.rms - 2e-4 * 3383.5f64.sqrt()).abs() < 1e-14, "{found:?}");
        assert_eq!((found.samples, found.until, found.position.max), (100, 10.0, 0.0));
        assert!((found.attitude.max - 0.02).abs() < 1e-14);
    }

    #[test]
    fn a_run_is_compared_at_common_times_only() {
        // Multiples of 0.03 s and of 0.1 s meet every 0.3 s; the run ends at 9.99 s.
        assert_eq!(accuracy(|t| t, 0.03).samples, 33);
        assert_eq!(accuracy(|t| t, 0.2).samples, 50);
        assert!(accuracy(|t| t, 0.2).joint.max < 1e-14);
        let (system, truth) = turning();
        assert_eq!(Follower::new(&system, &truth).finish(), None);
    }

    #[test]
    fn differences_take_the_short_way_round() {
        let of = |values: &[f64]| {
            let mut c = JointCoordinates::default();
            c.position[..values.len()].copy_from_slice(values);
            c
        };
        let difference = |kind, a: &[f64], b: &[f64]| joint_difference(kind, &of(a), &of(b));
        assert!((difference(JointKind::Revolute, &[3.1], &[-3.1]) - (TAU - 6.2)).abs() < 1e-14);
        assert_eq!(difference(JointKind::Prismatic, &[3.5], &[-3.5]), 7.0);
        assert_eq!(difference(JointKind::Planar, &[0.0, 2.0, 0.5], &[1.0, 0.0, 0.5]), 2.0);
        // Rotation vectors of half a turn about x and about -x are the same rotation.
        let half = std::f64::consts::PI;
        assert!(difference(JointKind::Spherical, &[half], &[-half]) < 1e-14);
        assert!((difference(JointKind::Floating, &[0.0, 0.0, 0.1, 0.3], &[0.0; 6]) - 0.3).abs() < 1e-15);
    }
}
