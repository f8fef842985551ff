//! What the engines in joint coordinates share.

use super::engine::{StepFailure, Unsupported};
use super::group::{Group, Origin};
use super::values::Values;
use crate::mechanics::{Part, State, System};
use crate::reduced::Model;
use crate::reduced::equations::Articulated;

/// Engines in joint coordinates.
pub(super) static GROUP: Group = Group { name: "joint coordinates", origin: Origin::Own };

/// What the equations in joint coordinates hold beside the tree.
pub(super) const PARTS: &[Part] = &[Part::JointSprings, Part::PointSprings, Part::Drives];

/// Positions and velocities `y = (q, v)` with their equations of motion by articulated bodies.
pub(super) struct JointCoordinates {
    dynamics: Articulated,
    pub y: Vec<f64>,
    step: f64,
    taken: u64,
}

impl JointCoordinates {
    /// # Errors
    /// A joint can move without moving any mass.
    pub(super) fn new(spec: &Values, system: &System, step: f64) -> Result<JointCoordinates, Unsupported> {
        let model = Model::new(system);
        let (mut y, v) = model.initial();
        y.extend(v);
        let mut start = JointCoordinates { dynamics: Articulated::new(model), y, step, taken: 0 };
        let (y, mut rate) = (start.y.clone(), start.y.clone());
        start.rates(0.0, &y, &mut rate).map_err(|_| Unsupported {
            engine: spec.to_string(),
            what: "a joint that can move without moving any mass; give the links behind it mass and inertia".into(),
        })?;
        Ok(start)
    }

    pub(super) fn step_size(&self) -> f64 {
        self.step
    }

    /// Time at the start of the step, s.
    fn time(&self) -> f64 {
        self.taken as f64 * self.step
    }

    /// `dy/dt` at `y`, a time `after` (s) into the step.
    pub(super) fn rates(&mut self, after: f64, y: &[f64], rate: &mut [f64]) -> Result<(), StepFailure> {
        let time = self.time() + after;
        let (q, v) = y.split_at(self.dynamics.model().positions);
        let (q_rate, v_rate) = rate.split_at_mut(q.len());
        self.dynamics.model().rates(q, v, q_rate);
        self.dynamics.accelerations(time, q, v, v_rate).ok_or_else(|| self.diverged())
    }

    /// Accelerations at the present state.
    pub(super) fn accelerations(&mut self, out: &mut [f64]) -> Result<(), StepFailure> {
        let time = self.time();
        let (q, v) = self.y.split_at(self.dynamics.model().positions);
        self.dynamics.accelerations(time, q, v, out).ok_or_else(|| self.diverged())
    }

    /// `v += h a`.
    pub(super) fn kick(&mut self, a: &[f64]) {
        let positions = self.dynamics.model().positions;
        for (v, a) in self.y[positions..].iter_mut().zip(a) {
            *v += self.step * a;
        }
    }

    /// Moves the positions for one step at the present velocities.
    pub(super) fn drift(&mut self) {
        let (q, v) = self.y.split_at_mut(self.dynamics.model().positions);
        self.dynamics.model().advance(q, v, self.step);
    }

    /// Counts a step that ended at `y`: quaternions get their unit length back. A state that is no number ends the run.
    pub(super) fn finish(&mut self) -> Result<(), StepFailure> {
        let positions = self.dynamics.model().positions;
        self.dynamics.model().normalise(&mut self.y[..positions]);
        if !self.y.iter().all(|x| x.is_finite()) {
            return Err(self.diverged());
        }
        self.taken += 1;
        Ok(())
    }

    pub(super) fn diverged(&self) -> StepFailure {
        let (time, step) = (self.time(), self.step);
        let detail =
            format!("t = {time:.6} s: the state stops being a number at a step of {step} s; take a smaller step");
        StepFailure::Diverged { detail }
    }

    pub(super) fn write_state(&self, out: &mut State) {
        let (q, v) = self.y.split_at(self.dynamics.model().positions);
        self.dynamics.model().write_state(q, v, out);
    }

    /// Number of positions and velocities.
    pub(super) fn velocities(&self) -> usize {
        self.dynamics.model().velocities
    }
}
