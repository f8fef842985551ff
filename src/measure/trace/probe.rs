//! Energy, joint residuals and momentum of a run, from the state after every step.

use std::collections::VecDeque;

use super::figures::{CORRECTED_ENERGY, EnergyError, MomentumError, QUANTITIES, StartDifference, Trace};
use super::series::Series;
use super::turn_per_step::TurnPerStep;
use super::work::Work;
use crate::engines::Engine;
use crate::measure::Horizon;
use crate::measure::growth::{Stretch, growth};
use crate::measure::outcome::{DIVERGED, Outcome};
use crate::measure::truth::accuracy::Follower;
use crate::mechanics::coordinates::CoordinateTracker;
use crate::mechanics::momentum::{self, Conserved};
use crate::mechanics::{State, System, constraint, energy};

/// A state's energies, J, and joint residuals.
struct Sample {
    time: f64,
    energy: f64,
    corrected: f64,
    residual: constraint::Residual,
}

/// The figures of a run while it goes on.
pub(super) struct Probe<'a> {
    system: &'a System,
    horizon: Horizon,
    state: State,
    pub(super) taken: u64,
    lag: f64,
    /// Energy of the scene's initial state, J: as it is, and with its positions moved back like those of every state.
    start_energy: f64,
    corrected_start: f64,
    /// Joint coordinates with angles unwrapped, where springs, dampers or drives need them.
    joints: CoordinateTracker,
    tracked: bool,
    work: Option<Work>,
    /// States whose work is not known yet.
    waiting: VecDeque<Sample>,
    /// Works that have become known with the last state, J.
    known: Vec<f64>,
    energy: EnergyError,
    corrected: EnergyError,
    residual: constraint::Residual,
    turn: TurnPerStep,
    conserved: Vec<(Conserved, f64)>,
    momentum: Vec<f64>,
    pub(super) follower: Option<Follower<'a>>,
    start: StartDifference,
    series: Series<QUANTITIES>,
}

impl<'a> Probe<'a> {
    pub(super) fn new(system: &'a System, engine: &dyn Engine, horizon: Horizon) -> Probe<'a> {
        let mut state = system.initial.clone();
        let joints = CoordinateTracker::new(system);
        let start_energy = energy::energy_at_coordinates(system, &state, &joints.joints).total();
        let parts = &system.parts;
        let springs = !parts.joint_springs.is_empty() || !parts.point_springs.is_empty();
        // Without gravity and springs the positions have no energy.
        let lag = if springs || system.gravity != nalgebra::Vector3::zeros() { engine.position_lag_s() } else { 0.0 };
        let corrected_start = energy::energy_at_velocity_time(system, &state, &joints.joints, lag).total();
        let work = Work::new(system, &joints, horizon.step);
        let conserved: Vec<(Conserved, f64)> = momentum::conserved(system)
            .into_iter()
            .map(|component| {
                let value = component.value(system, &state);
                (component, value)
            })
            .collect();
        engine.write_state(&mut state);
        Probe {
            start: StartDifference::of(system, system, &state),
            momentum: vec![0.0; conserved.len()],
            conserved,
            tracked: work.is_some() || !parts.joint_springs.is_empty(),
            joints,
            work,
            waiting: VecDeque::new(),
            known: Vec::new(),
            follower: None,
            lag,
            energy: EnergyError::default(),
            corrected: EnergyError::default(),
            residual: constraint::Residual { position: 0.0, velocity: 0.0 },
            turn: TurnPerStep::new(system, engine, horizon.step),
            series: Series::new(horizon.steps),
            taken: 0,
            system,
            horizon,
            state,
            start_energy,
            corrected_start,
        }
    }

    /// Takes in the state after the next step.
    ///
    /// # Errors
    /// What shows that the run has diverged; the figures stay those of the steps before.
    pub(super) fn measure(&mut self, engine: &dyn Engine) -> Result<(), String> {
        let (system, time) = (self.system, self.horizon.time(self.taken + 1));
        engine.write_state(&mut self.state);
        if !self.state.is_finite() {
            return Err(format!("t = {time:.6} s: the state is not a number"));
        }
        if self.tracked {
            self.joints.update(system, &self.state, self.horizon.step);
        }
        let joints = &self.joints.joints;
        let energy = energy::energy_at_coordinates(system, &self.state, joints).total();
        let corrected = match self.lag {
            0.0 => energy,
            lag => energy::energy_at_velocity_time(system, &self.state, joints, lag).total(),
        };
        let residual = constraint::residual(system, &self.state);
        if let Some(work) = &mut self.work {
            work.add(system, &self.state, &self.joints);
        }
        let rough = self.work.as_ref().map_or(0.0, Work::rough);
        let error = (energy + rough - self.start_energy) / system.energy_scale;
        if !(error.abs() <= DIVERGED && corrected.is_finite() && residual.position.is_finite()) {
            return Err(format!("t = {time:.6} s: the energy is wrong by {:.1e} of the energy scale", error.abs()));
        }
        self.taken += 1;
        self.turn.add(&self.state);
        self.residual.position = self.residual.position.max(residual.position);
        self.residual.velocity = self.residual.velocity.max(residual.velocity);
        for ((component, start), largest) in self.conserved.iter().zip(&mut self.momentum) {
            let error = (component.value(system, &self.state) - start) / component.scale;
            *largest = largest.max(error.abs());
        }
        if let Some(follower) = &mut self.follower {
            follower.add(time, self.horizon.step, &self.state);
        }
        self.waiting.push_back(Sample { time, energy, corrected, residual });
        match &mut self.work {
            Some(work) => {
                self.known.clear();
                work.integrate(|w| self.known.push(w));
                (0..self.known.len()).for_each(|k| self.judge(self.known[k]));
            }
            None => self.judge(0.0),
        }
        Ok(())
    }

    /// Judges the energy of the state that has waited longest for its work, J.
    fn judge(&mut self, work: f64) {
        let Some(sample) = self.waiting.pop_front() else { return };
        let relative = |energy: f64, start: f64| (energy + work - start) / self.system.energy_scale;
        let error = relative(sample.energy, self.start_energy);
        let corrected = relative(sample.corrected, self.corrected_start);
        self.energy.add(error);
        self.corrected.add(corrected);
        self.series.push(sample.time, [error, corrected, sample.residual.position, sample.residual.velocity]);
    }

    pub(super) fn finish(mut self, engine: &dyn Engine, outcome: Outcome) -> Trace {
        self.known.clear();
        if let Some(work) = &mut self.work {
            work.finish(|w| self.known.push(w));
        }
        (0..self.known.len()).for_each(|k| self.judge(self.known[k]));
        let measured = self.taken > 0;
        let stretches: Vec<Stretch> = self
            .series
            .blocks
            .iter()
            .map(|b| Stretch { to: b.to, count: b.count, error: b.values[CORRECTED_ENERGY] })
            .collect();
        let momentum = self.conserved.into_iter().zip(&self.momentum);
        Trace {
            growth: growth(&stretches, matches!(outcome, Outcome::Diverged { .. })),
            outcome,
            steps: self.taken,
            ended_at: self.horizon.time(self.taken),
            energy: measured.then_some(self.energy),
            time_level_corrected: (measured && self.lag != 0.0).then_some(self.corrected),
            residual: measured.then_some(self.residual),
            turn_per_step: measured.then_some(self.turn.largest()),
            warning: self.turn.warning(self.system),
            solver: engine.solver(),
            momentum: momentum
                .filter(|_| measured)
                .map(|((component, _), &max)| MomentumError { name: component.name, scale: component.scale, max })
                .collect(),
            accuracy: self.follower.and_then(Follower::finish),
            start: Some(self.start),
            series: self.series,
        }
    }
}
