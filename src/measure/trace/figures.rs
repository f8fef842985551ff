//! The figures of a run.

use super::series::Series;
use crate::engines::SolverCounters;
use crate::measure::growth::Growth;
use crate::measure::outcome::Outcome;
use crate::measure::truth::accuracy::Accuracy;
use crate::mechanics::{State, System, constraint, energy};

/// What the series of a trace holds, by index.
pub(crate) const ENERGY: usize = 0;

pub(crate) const CORRECTED_ENERGY: usize = 1;

pub(crate) const POSITION: usize = 2;

pub(crate) const VELOCITY: usize = 3;

pub(crate) const QUANTITIES: usize = 4;

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
    /// What the engine's constraint solver took, where it counts.
    pub solver: Option<SolverCounters>,
    /// One entry for each component that the scene conserves.
    pub momentum: Vec<MomentumError>,
    /// Position errors against the truth, where it is known.
    pub accuracy: Option<Accuracy>,
    /// How far the engine's first state is from the scene's.
    pub start: Option<StartDifference>,
    pub series: Series<QUANTITIES>,
}

/// Energy errors over the energy scale of the scene, signed: negative where energy is missing. In damped and driven
/// scenes it is the balance: the work of the dampers is added first and that of the drives taken off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyError {
    /// Largest absolute value over all steps.
    pub max: f64,
    pub last: f64,
}

impl EnergyError {
    pub(super) fn add(&mut self, error: f64) {
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
            solver: None,
            momentum: Vec::new(),
            accuracy: None,
            start: None,
            series: Series::new(0),
        }
    }
}

impl StartDifference {
    /// Between an engine's first state and the initial state of the system, where the engine's energy is that of the
    /// masses and the gravity of `theirs`.
    pub(in crate::measure) fn of(theirs: &System, system: &System, state: &State) -> StartDifference {
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
}
