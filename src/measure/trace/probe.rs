//! One traced run: energy, joint residuals and momentum from the state after every step.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::series::Series;
use super::turn_per_step::Turn;
use super::work::Work;
use crate::engines::{Engine, StepFailure};
use crate::measure::Horizon;
use crate::measure::growth::{Growth, Stretch, growth};
use crate::measure::truth::accuracy::{Accuracy, Follower};
use crate::measure::truth::trusted::Truth;
use crate::mechanics::coordinates::CoordinateTracker;
use crate::mechanics::momentum::{self, Conserved};
use crate::mechanics::{State, System, constraint, energy};

/// A relative energy error from which on a run counts as diverged.
pub const DIVERGED: f64 = 1e6;

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    Completed,
    /// The state stopped being a number, or its energy passed [`DIVERGED`] energy scales.
    Diverged {
        detail: String,
    },
    /// A step could not be solved.
    NotConverged {
        detail: String,
    },
    /// The engine has no means for something in the scene.
    Unsupported {
        detail: String,
    },
    /// The run took longer than it may, on the wall clock.
    OverBudget {
        detail: String,
    },
}

/// What stops a run before its end, and who is told how far it is.
#[derive(Clone, Copy, Debug)]
pub struct Limits<'a> {
    /// Wall-clock time that a run may take.
    pub budget: Duration,
    /// Set from outside to end the run without a result.
    pub interrupted: &'a AtomicBool,
    /// Counts the steps taken, for a progress bar.
    pub taken: &'a AtomicU64,
}

/// The figures of a run; what could not be had is `None` or empty.
#[derive(Clone, Debug)]
pub struct Trace {
    pub outcome: Outcome,
    /// Steps taken, and the time after them, s.
    pub steps: u64,
    pub ended_at: f64,
    /// Energy as the engine's states give it.
    pub energy: Option<EnergyError>,
    /// Energy with the positions moved back to the time of the velocities, those of the first state too: only where the
    /// engine has a lag and the scene has gravity.
    pub time_level_corrected: Option<EnergyError>,
    pub growth: Option<Growth>,
    pub residual: Option<constraint::Residual>,
    /// Largest turn of a body in a step, rad.
    pub turn_per_step: Option<f64>,
    /// Why the figures may mislead although the run went through.
    pub warning: Option<String>,
    /// One entry for each component that the scene conserves.
    pub momentum: Vec<MomentumError>,
    /// Position errors against the truth, where it is known.
    pub accuracy: Option<Accuracy>,
    /// How far the engine's first state is from the scene's.
    pub start: Option<StartDifference>,
    pub series: Series<QUANTITIES>,
}

/// Energy errors over the energy scale of the scene, signed: negative where energy is missing. In damped and driven scenes
/// it is the balance: the work of the dampers is added first and that of the drives taken off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyError {
    /// Largest absolute value over all steps.
    pub max: f64,
    pub last: f64,
}

impl EnergyError {
    fn add(&mut self, error: f64) {
        self.max = self.max.max(error.abs());
        self.last = error;
    }
}

/// The error of one conserved component, over its scale.
#[derive(Clone, Debug, PartialEq)]
pub struct MomentumError {
    pub name: String,
    pub scale: f64,
    pub max: f64,
}

/// Largest differences between an engine's state before the first step and the scene's initial state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartDifference {
    /// m
    pub position: f64,
    /// rad
    pub attitude: f64,
    /// m/s
    pub velocity: f64,
    /// rad/s
    pub angular_velocity: f64,
    /// Over the energy scale.
    pub energy: f64,
}

/// What the series of a trace holds, by index.
pub const ENERGY: usize = 0;
pub const CORRECTED_ENERGY: usize = 1;
pub const POSITION: usize = 2;
pub const VELOCITY: usize = 3;
pub const QUANTITIES: usize = 4;

impl Trace {
    /// The trace of a run that could not begin.
    pub fn unsupported(detail: String) -> Trace {
        Trace {
            outcome: Outcome::Unsupported { detail },
            steps: 0,
            ended_at: 0.0,
            energy: None,
            time_level_corrected: None,
            growth: None,
            residual: None,
            turn_per_step: None,
            warning: None,
            momentum: Vec::new(),
            accuracy: None,
            start: None,
            series: Series::new(0),
        }
    }
}

/// Steps an engine over the horizon, starting from the system's initial state, and measures every state. `None` where it
/// was interrupted.
pub fn trace(system: &System, engine: &mut dyn Engine, horizon: Horizon, limits: &Limits) -> Option<Trace> {
    trace_against(None, system, engine, horizon, limits)
}

/// The same, with the positions compared with the truth.
pub fn trace_against<'a>(
    truth: Option<&'a Truth>,
    system: &'a System,
    engine: &mut dyn Engine,
    horizon: Horizon,
    limits: &Limits,
) -> Option<Trace> {
    let mut probe = Probe::new(system, engine, horizon);
    probe.follower = truth.map(|truth| Follower::new(system, truth));
    let begin = Instant::now();
    let outcome = loop {
        if probe.taken == horizon.steps {
            break Outcome::Completed;
        }
        if limits.interrupted.load(Ordering::Relaxed) {
            return None;
        }
        if begin.elapsed() > limits.budget {
            break Outcome::OverBudget {
                detail: format!(
                    "reached {} of {} steps in {} s on the wall clock; allow more with --budget",
                    probe.taken,
                    horizon.steps,
                    limits.budget.as_secs_f64()
                ),
            };
        }
        match engine.step() {
            Ok(()) => {}
            Err(StepFailure::NotConverged { detail }) => break Outcome::NotConverged { detail },
            Err(StepFailure::Diverged { detail }) => break Outcome::Diverged { detail },
        }
        if let Err(detail) = probe.measure(engine) {
            break Outcome::Diverged { detail };
        }
        limits.taken.fetch_add(1, Ordering::Relaxed);
    };
    limits.taken.fetch_add(horizon.steps - probe.taken, Ordering::Relaxed);
    Some(probe.finish(engine, outcome))
}

/// A state's energies, J, and joint residuals.
struct Sample {
    time: f64,
    energy: f64,
    corrected: f64,
    residual: constraint::Residual,
}

/// The figures of a run while it goes on.
struct Probe<'a> {
    system: &'a System,
    horizon: Horizon,
    state: State,
    taken: u64,
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
    turn: Turn,
    conserved: Vec<(Conserved, f64)>,
    momentum: Vec<f64>,
    follower: Option<Follower<'a>>,
    start: StartDifference,
    series: Series<QUANTITIES>,
}

impl<'a> Probe<'a> {
    fn new(system: &'a System, engine: &dyn Engine, horizon: Horizon) -> Probe<'a> {
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
            start: start_difference(system, &state),
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
            turn: Turn::new(system, engine, horizon.step),
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
    fn measure(&mut self, engine: &dyn Engine) -> Result<(), String> {
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

    fn finish(mut self, engine: &dyn Engine, outcome: Outcome) -> Trace {
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
            warning: self.turn.warning(self.system, engine),
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

fn start_difference(system: &System, state: &State) -> StartDifference {
    start_difference_as(system, system, state)
}

/// The same where the engine's energy is that of the masses and gravity of `theirs`.
pub(in crate::measure) fn start_difference_as(theirs: &System, system: &System, state: &State) -> StartDifference {
    let mut all = StartDifference::default();
    for (a, b) in state.bodies.iter().zip(&system.initial.bodies) {
        all.position = all.position.max((a.position - b.position).norm());
        all.attitude = all.attitude.max(a.attitude.angle_to(&b.attitude));
        all.velocity = all.velocity.max((a.velocity - b.velocity).norm());
        all.angular_velocity = all.angular_velocity.max((a.angular_velocity - b.angular_velocity).norm());
    }
    let (theirs, ours) = (energy::energy(theirs, state).total(), energy::energy(system, &system.initial).total());
    all.energy = ((theirs - ours) / system.energy_scale).abs();
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::growth::Verdict;
    use crate::measure::synthetic::{Scripted, flywheel};

    fn run<F: Fn(u64) -> f64>(engine: &mut Scripted<F>, steps: u64, budget: Duration) -> Trace {
        let system = flywheel(2.0, 0.0, 1.0);
        let horizon = Horizon::exact(1e-3, steps as f64 * 1e-3).expect("whole");
        let limits = Limits { budget, interrupted: &AtomicBool::new(false), taken: &AtomicU64::new(0) };
        trace(&system, engine, horizon, &limits).expect("not interrupted")
    }

    const LONG: Duration = Duration::from_secs(100);

    #[test]
    fn one_wrong_step_among_thousands_is_the_largest_error() {
        // The energy scale is J omega^2 / 2 at omega = 1, so the error is omega^2 - 1.
        let found = run(&mut Scripted::new(|n| if n == 3217 { 1.5 } else { 1.0 }), 5000, LONG);
        let error = found.energy.expect("measured");
        assert_eq!(found.outcome, Outcome::Completed);
        assert!((error.max - 1.25).abs() < 1e-15 && error.last == 0.0, "{error:?}");
        assert!(found.series.blocks.iter().any(|b| b.values[ENERGY].max == error.max));
        assert!((found.momentum[0].max - 0.5).abs() < 1e-15, "{:?}", found.momentum);
        assert_eq!(found.growth.expect("judged").verdict, Verdict::Bounded);
    }

    #[test]
    fn an_exploding_run_ends_as_diverged_where_it_does() {
        let found = run(&mut Scripted::new(|n| 1.01f64.powi(n as i32)), 5000, LONG);
        // 1.01^(2 n) passes 1e6 + 1 at n = 695.
        assert_eq!(found.steps, 694);
        assert!(matches!(&found.outcome, Outcome::Diverged { detail } if detail.starts_with("t = 0.695000 s: ")));
        assert_eq!(found.growth.expect("judged").verdict, Verdict::BlowUp);
        let found = run(&mut Scripted::new(|n| if n > 10 { f64::NAN } else { 1.0 }), 100, LONG);
        assert_eq!(found.outcome, Outcome::Diverged { detail: "t = 0.011000 s: the state is not a number".into() });
        assert_eq!((found.steps, found.energy), (10, Some(EnergyError { max: 0.0, last: 0.0 })));
    }

    #[test]
    fn a_failed_step_keeps_the_figures_before_it() {
        let mut engine = Scripted::new(|_| 1.0);
        let failure = StepFailure::NotConverged { detail: "joint 'axle'".into() };
        engine.fails_at = Some((21, failure));
        let found = run(&mut engine, 100, LONG);
        assert_eq!(found.outcome, Outcome::NotConverged { detail: "joint 'axle'".into() });
        assert_eq!((found.steps, found.ended_at), (20, 0.02));
    }

    #[test]
    fn a_run_over_its_budget_says_how_far_it_came() {
        let found = run(&mut Scripted::new(|_| 1.0), 100, Duration::ZERO);
        let detail = "reached 0 of 100 steps in 0 s on the wall clock; allow more with --budget";
        assert_eq!(found.outcome, Outcome::OverBudget { detail: detail.into() });
        assert_eq!((found.energy, found.growth), (None, None));
    }

    #[test]
    fn the_start_of_a_wrong_model_is_seen() {
        let found = run(&mut Scripted::new(|_| 1.0 + 1e-6), 10, LONG);
        let start = found.start.expect("measured");
        assert!((start.angular_velocity - 1e-6).abs() < 1e-15 && (start.energy - 2e-6).abs() < 1e-11, "{start:?}");
    }
}
