//! The classical Runge-Kutta method of order 4 in joint coordinates, articulated-body accelerations.
//!
//! Accurate on short smooth runs; not symplectic: its energy drifts in proportion to time. Quaternions are normalised
//! after each step.

use super::engine::{Engine, StepFailure, Unsupported};
use super::entry::{Entry, is_converged};
use super::joint_coordinates::{GROUP, JointCoordinates, PARTS};
use super::line_up::{Colour, Contestant, Look, Marker, Role};
use super::swept::{QUICK_SHORT_STEPS, STEPS, Swept};
use super::values::Values;
use crate::mechanics::{State, System};

pub(super) const ENTRY: Entry = Entry {
    name: "rk4",
    summary: "the classical Runge-Kutta method on joint coordinates: order 4, explicit, energy drifts",
    keys: &[],
    parts: PARTS,
    group: &GROUP,
    contestants: &[Contestant {
        spec: "rk4",
        roles: &[Role::Cost, Role::Explicit, Role::Control],
        look: Some(Look { colour: Colour::Stone, marker: Marker::Triangle }),
    }],
    tuned: None,
    sweep: &[Swept::both("rk4", STEPS, QUICK_SHORT_STEPS)],
    tolerance: None,
    nominal_cost: |_, bodies| 0.2 + bodies,
    hold: None,
    converged: is_converged,
    crates: &[],
    build,
};

fn build(spec: &Values, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    let state = JointCoordinates::new(spec, system, step)?;
    let room = || vec![0.0; state.y.len()];
    Ok(Box::new(RungeKutta { rate: room(), sum: room(), at: room(), state }))
}

struct RungeKutta {
    state: JointCoordinates,
    rate: Vec<f64>,
    /// `k1 + 2 k2 + 2 k3 + k4`
    sum: Vec<f64>,
    at: Vec<f64>,
}

impl Engine for RungeKutta {
    fn step(&mut self) -> Result<(), StepFailure> {
        let h = self.state.step_size();
        self.at.copy_from_slice(&self.state.y);
        self.sum.fill(0.0);
        for (after, weight, reach) in [(0.0, 1.0, 0.5 * h), (0.5 * h, 2.0, 0.5 * h), (0.5 * h, 2.0, h), (h, 1.0, 0.0)] {
            self.state.rates(after, &self.at, &mut self.rate)?;
            for k in 0..self.at.len() {
                self.sum[k] += weight * self.rate[k];
                self.at[k] = self.state.y[k] + reach * self.rate[k];
            }
        }
        for (y, sum) in self.state.y.iter_mut().zip(&self.sum) {
            *y += h / 6.0 * sum;
        }
        self.state.finish()
    }

    fn write_state(&self, out: &mut State) {
        self.state.write_state(out);
    }
}
