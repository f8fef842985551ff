//! The Dormand-Prince pair of order 8(5,3) at a tolerance, in joint coordinates with articulated-body accelerations.
//!
//! Method, error estimate and step control are those of DOP853 (Hairer, Norsett and Wanner, Solving Ordinary
//! Differential Equations I, 2nd ed. 1993, section II.10), without its dense output. 12
//! evaluations a step, no allocation. The integration lands on every step of the run: to let the tolerance set the
//! cost, take a step that is longer than its own. Not symplectic: its energy drifts in proportion to time, the more the
//! looser the tolerance.

use super::dormand_prince::tableau::{A, B, C, LESS_FIFTH, STAGES, THIRD};
use super::engine::{Engine, StepFailure, Unsupported};
use super::entry::{Entry, is_converged, usual_cost};
use super::joint_coordinates::{GROUP, JointCoordinates, PARTS};
use super::key::{Key, Number};
use super::line_up::{Colour, Contestant, Look, Marker, Role};
use super::swept::{READ, Swept};
use super::values::Values;
use crate::mechanics::{State, System};

static TOLERANCE: Number = Number {
    name: "tolerance",
    min: 1e-15,
    max: 1e-1,
    default: 1e-9,
    whole: false,
    summary: "relative and absolute tolerance of the local error",
};

pub(super) const ENTRY: Entry = Entry {
    name: "dop853",
    summary: "Dormand-Prince order 8 on joint coordinates, adaptive within the step: accurate, energy drifts",
    keys: &[Key::Number(&TOLERANCE)],
    parts: PARTS,
    group: &GROUP,
    contestants: &[Contestant {
        spec: "dop853",
        roles: &[Role::Compare, Role::Cost],
        look: Some(Look { colour: Colour::Black, marker: Marker::Square }),
    }],
    tuned: None,
    sweep: &[
        Swept::full("dop853:tolerance=1e-3", READ),
        Swept::full("dop853:tolerance=1e-4", READ),
        Swept::full("dop853:tolerance=1e-5", READ),
        Swept::both("dop853:tolerance=1e-6", READ, READ),
        Swept::full("dop853:tolerance=1e-7", READ),
        Swept::both("dop853:tolerance=1e-8", READ, READ),
        Swept::both("dop853:tolerance=5e-9", READ, READ),
        Swept::both("dop853:tolerance=2e-9", READ, READ),
        Swept::both("dop853", READ, READ),
        Swept::full("dop853:tolerance=3e-10", READ),
        Swept::both("dop853:tolerance=1e-10", READ, READ),
        Swept::full("dop853:tolerance=3e-11", READ),
        Swept::full("dop853:tolerance=1e-11", READ),
        Swept::both("dop853:tolerance=1e-12", READ, READ),
        Swept::full("dop853:tolerance=1e-13", READ),
    ],
    tolerance: Some(&TOLERANCE),
    nominal_cost: usual_cost,
    hold: None,
    converged: is_converged,
    crates: &[],
    build,
};

fn build(spec: &Values, system: &System, step: f64) -> Result<Box<dyn Engine>, Unsupported> {
    let state = JointCoordinates::new(spec, system, step)?;
    let room = || vec![0.0; state.y.len()];
    let mut engine = Dop853 {
        tolerance: spec.number(&TOLERANCE),
        natural: step,
        rates: std::array::from_fn(|_| room()),
        at: room(),
        next: room(),
        state,
    };
    engine
        .state
        .rates(0.0, &engine.state.y.clone(), &mut engine.rates[0])
        .map_err(|failure| Unsupported { engine: spec.to_string(), what: failure.to_string() })?;
    engine.natural = engine.first_step();
    Ok(Box::new(engine))
}

struct Dop853 {
    state: JointCoordinates,
    tolerance: f64,
    /// The step that the control would take next, s.
    natural: f64,
    /// `k_i`; the first is `dy/dt` at the present state.
    rates: [Vec<f64>; STAGES],
    at: Vec<f64>,
    next: Vec<f64>,
}

impl Engine for Dop853 {
    fn step(&mut self) -> Result<(), StepFailure> {
        let step = self.state.step_size();
        let (mut reached, mut rejected) = (0.0, false);
        while reached < step {
            let rest = step - reached;
            // A step that would leave a short rest is halved.
            let h = if self.natural >= rest { rest } else { self.natural.min(0.5 * rest) };
            if !(h > 1e-14 * step) {
                return Err(self.state.diverged());
            }
            let error = self.attempt(reached, h)?;
            let growth = (0.9 * error.powf(-0.125)).clamp(1.0 / 3.0, 6.0);
            if error <= 1.0 {
                reached = if h == rest { step } else { reached + h };
                self.accept(reached)?;
                let wanted = h * if rejected { growth.min(1.0) } else { growth };
                self.natural = if h < self.natural { self.natural.max(wanted) } else { wanted };
                rejected = false;
            } else {
                self.natural = h * if error.is_nan() { 1.0 / 3.0 } else { growth };
                rejected = true;
            }
        }
        self.state.finish()
    }

    fn write_state(&self, out: &mut State) {
        self.state.write_state(out);
    }

    fn chooses_its_steps(&self) -> bool {
        true
    }
}

impl Dop853 {
    /// All stages of a step from `reached`; leaves the end in `next` and returns the error in units of the tolerance.
    fn attempt(&mut self, reached: f64, h: f64) -> Result<f64, StepFailure> {
        for i in 1..STAGES {
            self.at.copy_from_slice(&self.state.y);
            let (known, rest) = self.rates.split_at_mut(i);
            for (rate, a) in known.iter().zip(&A[i]).filter(|(_, a)| **a != 0.0) {
                self.at.iter_mut().zip(rate).for_each(|(y, k)| *y += h * a * k);
            }
            self.state.rates(reached + C[i] * h, &self.at, &mut rest[0])?;
        }
        let (mut fifth, mut third) = (0.0, 0.0);
        for k in 0..self.next.len() {
            let along = |w: &[f64; STAGES]| w.iter().zip(&self.rates).map(|(w, rate)| w * rate[k]).sum::<f64>();
            let slope = along(&B);
            self.next[k] = self.state.y[k] + h * slope;
            let scale = self.tolerance * (1.0 + self.state.y[k].abs().max(self.next[k].abs()));
            fifth += (along(&LESS_FIFTH) / scale).powi(2);
            third += ((slope - along(&THIRD)) / scale).powi(2);
        }
        let mixed = fifth + 0.01 * third;
        let size = if mixed > 0.0 { (mixed * self.next.len() as f64).sqrt() } else { 1.0 };
        Ok(h * fifth / size)
    }

    fn accept(&mut self, reached: f64) -> Result<(), StepFailure> {
        self.state.y.copy_from_slice(&self.next);
        self.state.rates(reached, &self.next, &mut self.rates[0])
    }

    /// A hundredth of the time in which the state changes by its own size, at most the step of the run.
    fn first_step(&self) -> f64 {
        let norm = |values: &[f64]| {
            let sum = |(x, y): (&f64, &f64)| (x / (1.0 + y.abs())).powi(2);
            values.iter().zip(&self.state.y).map(sum).sum::<f64>().sqrt()
        };
        let (size, rate) = (norm(&self.state.y), norm(&self.rates[0]));
        let guess = if rate > 0.0 { 0.01 * size.max(1e-2) / rate } else { self.state.step_size() };
        guess.min(self.state.step_size())
    }
}
