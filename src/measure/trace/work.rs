//! Work of the forces that have no potential, so that the energy balance of a damped or driven scene can be judged.

use super::running_integral::RunningIntegral;
use crate::mechanics::coordinates::CoordinateTracker;
use crate::mechanics::{State, System};

/// The work that dampers have taken out of a run less the work that drives have put in, J: the integral of
///
/// ```text
/// sum c |thetadot|^2   over the dampers in joints, those beside springs among them
///  + sum c (d distance/dt)^2   over the dampers between points
///  - sum u(t) thetadot   over the drives
/// ```
///
/// from the states at the ends of equal steps, by a rule of order 12 ([`RunningIntegral`]). It is as good as its steps
/// resolve the power: a damper that stops a motion within a step is beyond it.
#[derive(Debug)]
pub(super) struct Work {
    /// Index of each damped body with its damping.
    dampers: Vec<(usize, f64)>,
    integral: RunningIntegral,
    /// By the trapezoidal rule, without delay: the newest power, W, and the work up to it.
    rough: (f64, f64),
    /// s
    step: f64,
    steps: u64,
}

impl Work {
    /// Starts at the system's initial state. `None` where nothing is damped or driven.
    pub(super) fn new(system: &System, joints: &CoordinateTracker, step: f64) -> Option<Work> {
        let own = system.bodies.iter().enumerate().map(|(i, body)| (i, body.joint.damping));
        let beside = system.parts.joint_springs.iter().map(|spring| (spring.body, spring.damping));
        let dampers: Vec<(usize, f64)> = own.chain(beside).filter(|(_, c)| *c != 0.0).collect();
        let between = system.parts.point_springs.iter().any(|spring| spring.damping != 0.0);
        if dampers.is_empty() && !between && system.parts.drives.is_empty() {
            return None;
        }
        let integral = RunningIntegral::new(step, 0.0);
        let mut work = Work { dampers, integral, rough: (0.0, 0.0), step, steps: 0 };
        let start = work.power(system, &system.initial, joints);
        work.integral = RunningIntegral::new(step, start);
        work.rough.0 = start;
        Some(work)
    }

    /// Power that leaves the system, W.
    fn power(&self, system: &System, state: &State, joints: &CoordinateTracker) -> f64 {
        let rate = |body: usize| &joints.joints[body].velocity;
        let time = self.steps as f64 * self.step;
        let in_joints = self.dampers.iter().map(|&(i, c)| c * rate(i).iter().map(|v| v * v).sum::<f64>());
        let damped_springs = system.parts.point_springs.iter().filter(|spring| spring.damping != 0.0);
        let between = damped_springs.map(|spring| spring.damping * spring.distance(state).1.powi(2));
        let driven = system.parts.drives.iter().map(|drive| drive.at(time) * rate(drive.body)[0]);
        in_joints.sum::<f64>() + between.sum::<f64>() - driven.sum::<f64>()
    }

    /// Takes in the next state, with its joint coordinates.
    pub(super) fn add(&mut self, system: &System, state: &State, joints: &CoordinateTracker) {
        self.steps += 1;
        let power = self.power(system, state, joints);
        self.rough = (power, self.rough.1 + 0.5 * self.step * (self.rough.0 + power));
    }

    /// Integrates up to the newest state. Calls `known` with each work since the start that is known from now on, in
    /// the order of the states: a state waits for the few that follow.
    pub(super) fn integrate(&mut self, known: impl FnMut(f64)) {
        self.integral.push(self.rough.0, known);
    }

    /// The work up to the newest state by the trapezoidal rule.
    pub(super) fn rough(&self) -> f64 {
        self.rough.1
    }

    /// Calls `known` for the states that still wait at the end of a run.
    pub(super) fn finish(&mut self, known: impl FnMut(f64)) {
        self.integral.finish(known);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::synthetic;
    use crate::mechanics::Drive;

    /// The error of the work in a run of a flywheel whose speed is `omega(t)`, over its largest kinetic energy, when
    /// the exact work is that which the kinetic energy lacks.
    fn error(system: &System, h: f64, omega: &dyn Fn(f64) -> f64) -> f64 {
        let inertia = system.bodies[0].inertia.z;
        let mut joints = CoordinateTracker::new(system);
        let mut work = Work::new(system, &joints, h).expect("damped or driven");
        let mut state = system.initial.clone();
        let (mut found, steps) = (Vec::new(), (4.0 / h).round() as u64);
        for n in 1..=steps {
            state.bodies[0].angular_velocity.z = omega(n as f64 * h);
            joints.update(system, &state, h);
            work.add(system, &state, &joints);
            work.integrate(|w| found.push(w));
        }
        work.finish(|w| found.push(w));
        assert_eq!(found.len() as u64, steps);
        let kinetic = |t: f64| 0.5 * inertia * omega(t).powi(2);
        let largest = (0..=steps).map(|n| kinetic(n as f64 * h)).fold(0.0, f64::max);
        let errors = found.iter().zip(1..).map(|(w, n)| (w - kinetic(0.0) + kinetic(f64::from(n) * h)).abs());
        errors.fold(0.0, f64::max) / largest
    }

    /// A flywheel with damping `c`: `omega = omega0 exp(-c t / J)`.
    #[test]
    fn the_work_of_a_damped_flywheel_is_its_lost_energy() {
        let (inertia, damping, speed) = (2.0, 0.5, 3.0);
        let system = synthetic::flywheel(inertia, damping, speed);
        let omega = |t: f64| speed * (-damping * t / inertia).exp();
        let found = error(&system, 0.2, &omega);
        // measured 2.0e-15
        assert!(found < 5e-15, "{found:e}");
    }

    /// A flywheel under `u = u0 + A sin(w t + p)`: `omega = omega0 + (u0 t - A/w (cos(w t + p) - cos p)) / J`.
    #[test]
    fn the_work_of_a_driven_flywheel_is_its_gained_energy() {
        let (inertia, speed, w, phase) = (2.0, 0.5, 3.0, 0.4);
        let mut system = synthetic::flywheel(inertia, 0.0, speed);
        let drive = Drive { body: 0, effort: 0.7, amplitude: 5.0, angular_frequency: w, phase };
        let omega =
            |t: f64| speed + (drive.effort * t - drive.amplitude / w * ((w * t + phase).cos() - phase.cos())) / inertia;
        system.parts.drives = vec![drive.clone()];
        let (coarse, fine) = (error(&system, 0.05, &omega), error(&system, 0.025, &omega));
        // measured 2.1e-11 and 4.3e-15
        assert!(coarse < 6e-11 && fine < coarse / 100.0, "{coarse:e} {fine:e}");
        // Negative control: a drive of 1 % less is seen.
        system.parts.drives[0].amplitude *= 0.99;
        assert!(error(&system, 0.025, &omega) > 1e-3);
    }
}
