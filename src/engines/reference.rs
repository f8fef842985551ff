//! The way to the truth: dense equations of motion in joint coordinates, integrated at a tolerance near roundoff.
//!
//! Mass matrix by composite rigid bodies and bias by recursive Newton-Euler ([`Dynamics`]), integrated by the
//! Dormand-Prince pair of order 8 (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section
//! II.10; `Integrator`). Neither shares code with the variational core. Loops and mimic joints
//! are held by the least force that does, and positions and velocities are taken back to the constraint manifold after
//! each accepted step. [`trajectory`] integrates twice, at two tolerances, and gives the distance of the two as its
//! error estimate.
//!
//! The integration allocates in its steps, and the cost grows with the cube of the degrees of freedom: this engine is
//! for accuracy and is no rival in speed. `dop853` is.

use super::dormand_prince::integrator::{Integrator, TooSmall};
use super::engine::{Engine, StepFailure, Unsupported};
use super::entry::{Entry, is_converged, usual_cost};
use super::joint_coordinates::GROUP;
use super::values::Values;
use crate::mechanics::{Part, State, System};
use crate::reduced::Model;
use crate::reduced::equations::Dynamics;

/// Relative and absolute tolerance of the reference, and the looser one that it is compared with.
pub const TOLERANCE: f64 = 1e-14;
pub const LOOSER_TOLERANCE: f64 = 1e-12;

/// How far a loop may stay open after a projection, m or rad: beyond it has rows that it did not have at the start.
const CLOSED: f64 = 1e-9;

/// What `report.json` says about how the reference was computed.
pub const METHOD: &str = "joint coordinates, mass matrix and recursive Newton-Euler, Dormand-Prince order 8(5,3) at \
                          tolerance 1e-14; error estimated against tolerance 1e-12";

pub(super) const ENTRY: Entry = Entry {
    name: "reference",
    summary: "joint coordinates by mass matrix and recursive Newton-Euler, Dormand-Prince order 8 at a tolerance of \
              1e-14",
    keys: &[],
    parts: &[Part::Loops, Part::Mimics, Part::JointSprings, Part::PointSprings, Part::Drives],
    group: &GROUP,
    contestants: &[],
    tuned: None,
    sweep: &[],
    tolerance: None,
    nominal_cost: usual_cost,
    hold: None,
    converged: is_converged,
    crates: &[],
    build,
};

fn build(spec: &Values, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    let integration = Integration::new(system, TOLERANCE)
        .map_err(|failure| Unsupported { engine: spec.to_string(), what: failure.to_string() })?;
    Ok(Box::new(ReferenceEngine { integration, step, taken: 0 }))
}

struct ReferenceEngine {
    integration: Integration,
    step: f64,
    taken: u64,
}

impl Engine for ReferenceEngine {
    fn step(&mut self) -> Result<(), StepFailure> {
        self.integration.advance_to((self.taken + 1) as f64 * self.step)?;
        self.taken += 1;
        Ok(())
    }

    fn write_state(&self, out: &mut State) {
        self.integration.write_state(out);
    }

    fn chooses_its_steps(&self) -> bool {
        true
    }
}

/// The reference at requested times.
#[derive(Clone, Debug)]
pub struct Trajectory {
    /// s, as requested
    pub times: Vec<f64>,
    /// The states at these times.
    pub states: Vec<State>,
    /// The states of the looser tolerance.
    pub looser: Vec<State>,
    /// Distance of the two at each time: the largest displacement of a centre of mass (m) or rotation (rad). It
    /// estimates the error of the looser run, and so bounds that of `states` from above as long as both are far from
    /// chaos.
    pub error_estimate: Vec<f64>,
    /// How it was computed, in words.
    pub method: String,
}

impl Trajectory {
    /// The last requested time up to which the error estimate stays within `bound`; `None` where the first exceeds it.
    pub fn trusted_until(&self, bound: f64) -> Option<f64> {
        let trusted = self.error_estimate.iter().take_while(|&&error| error <= bound).count();
        trusted.checked_sub(1).map(|last| self.times[last])
    }
}

/// Computes the reference at `times` (s, not negative, increasing).
///
/// # Errors
/// The motion cannot be followed: a joint can move without moving any mass, or the step size underflows.
pub fn trajectory(system: &System, times: &[f64]) -> Result<Trajectory, StepFailure> {
    trajectory_while(system, times, &mut |_, _| true)
}

/// The same as long as `go_on` says so of the states of the two tolerances at the last time, which is kept.
///
/// # Errors
/// The motion cannot be followed: a joint can move without moving any mass, or the step size underflows.
pub fn trajectory_while(
    system: &System,
    times: &[f64],
    go_on: &mut dyn FnMut(&State, &State) -> bool,
) -> Result<Trajectory, StepFailure> {
    let (trajectory, failure) = follow(system, times, u64::MAX, go_on)?;
    failure.map_or(Ok(trajectory), Err)
}

/// The same as far as `most_steps` accepted or rejected steps of either tolerance lead, and not beyond a failure.
///
/// # Errors
/// The motion cannot be followed from the start.
pub fn trajectory_within(
    system: &System,
    times: &[f64],
    most_steps: u64,
    go_on: &mut dyn FnMut(&State, &State) -> bool,
) -> Result<Trajectory, StepFailure> {
    Ok(follow(system, times, most_steps, go_on)?.0)
}

/// What was found, and why it ends before its time.
fn follow(
    system: &System,
    times: &[f64],
    most_steps: u64,
    go_on: &mut dyn FnMut(&State, &State) -> bool,
) -> Result<(Trajectory, Option<StepFailure>), StepFailure> {
    let mut pair = [Integration::new(system, TOLERANCE)?, Integration::new(system, LOOSER_TOLERANCE)?];
    pair.iter_mut().for_each(|integration| integration.left = most_steps);
    let mut found: [Vec<State>; 2] = Default::default();
    let (mut error_estimate, mut failure) = (Vec::new(), None);
    'times: for time in times {
        let mut states = [system.initial.clone(), system.initial.clone()];
        for (integration, state) in pair.iter_mut().zip(&mut states) {
            if let Err(stopped) = integration.advance_to(*time) {
                failure = Some(stopped);
                break 'times;
            }
            integration.write_state(state);
        }
        error_estimate.push(distance(&states[0], &states[1]));
        let more = go_on(&states[0], &states[1]);
        for (list, state) in found.iter_mut().zip(states) {
            list.push(state);
        }
        if !more {
            break;
        }
    }
    let times = times[..error_estimate.len()].to_vec();
    let [states, looser] = found;
    Ok((Trajectory { times, states, looser, error_estimate, method: METHOD.to_string() }, failure))
}

/// The largest displacement of a centre of mass (m) or rotation of a body (rad) between two states. NaN where either
/// is.
pub fn distance(a: &State, b: &State) -> f64 {
    a.bodies.iter().zip(&b.bodies).fold(0.0, |largest: f64, (a, b)| {
        let (shift, turn) = ((a.position - b.position).norm(), a.attitude.angle_to(&b.attitude));
        if shift.is_nan() || turn.is_nan() || largest.is_nan() { f64::NAN } else { largest.max(shift).max(turn) }
    })
}

/// `d/dt (q, v) = (qdot, a)`; not a number where the mass matrix is singular.
fn rates(dynamics: &mut Dynamics, time: f64, y: &[f64], rate: &mut [f64]) {
    let (q, v) = y.split_at(dynamics.model().positions);
    let (q_rate, v_rate) = rate.split_at_mut(q.len());
    dynamics.model().rates(q, v, q_rate);
    if dynamics.accelerations(time, q, v, v_rate).is_none() {
        v_rate.fill(f64::NAN);
    }
}

/// An adaptive integration that lands on every time asked for.
struct Integration {
    dynamics: Dynamics,
    integrator: Integrator,
    tolerance: f64,
    /// Whether there are loops or mimic joints.
    projects: bool,
    /// Steps that may still be tried.
    left: u64,
}

impl Integration {
    fn new(system: &System, tolerance: f64) -> Result<Integration, StepFailure> {
        let model = Model::new(system);
        let (mut y, v) = model.initial();
        y.extend(v);
        let mut dynamics = Dynamics::new(model);
        let mut rate = y.clone();
        rates(&mut dynamics, 0.0, &y, &mut rate);
        if !rate.iter().all(|x| x.is_finite()) {
            let detail =
                "t = 0 s: the mass matrix is singular, where a joint can move without moving any mass, or the rows of \
                          the loops lose rank"
                    .to_string();
            return Err(StepFailure::Diverged { detail });
        }
        let tree = system.parts.loops.is_empty() && system.parts.couplings.is_empty();
        let integrator = Integrator::new(tolerance, 0.0, y, None, &mut |t, y, rate| rates(&mut dynamics, t, y, rate))
            .map_err(|TooSmall| failure(0.0))?;
        Ok(Integration { dynamics, integrator, tolerance, projects: !tree, left: u64::MAX })
    }

    fn advance_to(&mut self, time: f64) -> Result<(), StepFailure> {
        loop {
            let before = self.integrator.time;
            let rest = time - before;
            if rest <= 4.0 * f64::EPSILON * time {
                return Ok(());
            }
            // A step that would leave a short rest is halved, and the rest of a time asked for does not shorten the
            // next.
            let natural = self.integrator.step;
            let shortened = natural > 0.5 * rest;
            if shortened {
                self.integrator.step = if natural >= rest { rest } else { 0.5 * rest };
            }
            self.left = self.left.checked_sub(1).ok_or_else(|| failure(before))?;
            self.integrator
                .step(&mut |t, y, rate| rates(&mut self.dynamics, t, y, rate))
                .map_err(|TooSmall| failure(before))?;
            if self.integrator.time > before {
                if self.projects {
                    self.project()?;
                }
                if shortened {
                    self.integrator.step = natural.max(self.integrator.step);
                }
            }
        }
    }

    /// Closes the loops and starts the method anew from there.
    fn project(&mut self) -> Result<(), StepFailure> {
        let Integration { dynamics, integrator, tolerance, .. } = self;
        let (time, step, mut y) = (integrator.time, integrator.step, integrator.y.clone());
        let (q, v) = y.split_at_mut(dynamics.model().positions);
        let (name, open) = dynamics.project(q, v).ok_or_else(|| failure(time))?;
        if !(open <= CLOSED) {
            let detail = format!(
                "t = {time:.6} s: {name} stays open by {open:.1e} m or rad: its constraints here are not those of the \
                 start"
            );
            return Err(StepFailure::Diverged { detail });
        }
        *integrator = Integrator::new(*tolerance, time, y, Some(step), &mut |t, y, rate| rates(dynamics, t, y, rate))
            .map_err(|TooSmall| failure(time))?;
        Ok(())
    }

    fn write_state(&self, out: &mut State) {
        let model = self.dynamics.model();
        let (q, v) = self.integrator.y.split_at(model.positions);
        model.write_state(q, v, out);
    }
}

fn failure(time: f64) -> StepFailure {
    let detail = format!(
        "t = {time:.6} s: the adaptive step size has become too small to go on, or a loop is where its path may fork"
    );
    StepFailure::Diverged { detail }
}
