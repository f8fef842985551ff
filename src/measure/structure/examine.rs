//! Examines the steps of an engine, which is made new at every point.

use std::cell::Cell;
use std::sync::atomic::Ordering;
use std::time::Instant;

use super::failure::Failure;
use super::phase::{Phase, scale_at};
use super::reversibility::reversibility;
use super::symplecticity::{Differenced, symplecticity};
use crate::engines::{self, Spec};
use crate::measure::outcome::Limits;
use crate::mechanics::momentum::{self, Conserved};
use crate::mechanics::{State, System};

/// Steps that are examined as one map.
pub const STEPS: usize = 8;
/// Time into the motion at which they are examined, s: a scene that starts at rest moves by then.
pub(crate) const EXAMINED_AT: f64 = 0.5;
/// Step of the motion that leads there, s.
const LEADING_STEP: f64 = 1e-3;

/// What the steps do to the form and to time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Defects {
    /// `None` in systems with dampers, and where a step failed.
    pub symplecticity: Option<Differenced>,
    /// `None` in systems with dampers or changing drives, and where a step failed.
    pub reversibility: Option<f64>,
}

/// The figures of one engine at one step size; what could not be had is `None`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Structure {
    /// Time of the state that the steps start from, s.
    pub at: f64,
    /// Of the states as the engine returns them.
    pub as_returned: Defects,
    /// With positions moved back to the time of the velocities, for engines with a lag.
    pub time_level_corrected: Option<Defects>,
    /// Over the scale of the component. `None` where the system conserves no component.
    pub momentum_map: Option<f64>,
    pub memory: Option<f64>,
    /// Why something is missing.
    pub detail: Option<String>,
}

/// The state `EXAMINED_AT` into the motion (at most `longest` s), with its time; the initial state where the motion
/// cannot be had.
pub fn examined_state(system: &System, longest: f64) -> (State, f64) {
    let steps = (EXAMINED_AT.min(longest) / LEADING_STEP).round();
    let lead = || -> Option<State> {
        let mut engine = engines::build(&Spec::parse("rattle").ok()?, system, LEADING_STEP).ok()?;
        (0..steps as u64).try_for_each(|_| engine.step().ok())?;
        let mut state = system.initial.clone();
        engine.write_state(&mut state);
        state.is_finite().then_some(state)
    };
    lead().map_or_else(|| (system.initial.clone(), 0.0), |state| (state, steps * LEADING_STEP))
}

/// The structure of [`STEPS`] steps of an engine from a state, which is `at` s into the motion. `None` where the engine
/// does not support the system or the examination was interrupted.
pub fn examine(
    system: &System,
    spec: &Spec,
    step: f64,
    (state, at): (&State, f64),
    limits: &Limits,
) -> Option<Structure> {
    let lag = engines::build(spec, system, step).ok()?.position_lag_s();
    let steps = Steps::new(system, spec, step, limits);
    let map = |from: &System| steps.taken(from, STEPS);
    let mut found = Structure { at, ..Structure::default() };
    let mut reasons: Vec<String> = Vec::new();
    let mut keep = |failure: Failure| {
        let reason = failure.to_string();
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    };
    found.memory = steps.memory(state).map_err(&mut keep).ok();
    let mut defects = |lag: f64| Defects {
        symplecticity: undamped(system).and_then(|()| symplecticity(system, state, lag, &map)).map_err(&mut keep).ok(),
        reversibility: reversible(system)
            .and_then(|()| reversibility(system, state, lag, &map))
            .map_err(&mut keep)
            .ok(),
    };
    found.as_returned = defects(0.0);
    found.time_level_corrected = (lag != 0.0).then(|| defects(lag));
    found.momentum_map = steps.momentum_error();
    found.detail = (!reasons.is_empty()).then(|| reasons.join("; "));
    (!limits.interrupted.load(Ordering::Relaxed)).then_some(found)
}

/// Whether the exact motion is reversible.
fn reversible(system: &System) -> Result<(), Failure> {
    undamped(system)?;
    let driven = system.parts.drives.iter().any(|d| d.amplitude != 0.0);
    if driven { Err(Failure::Drives) } else { Ok(()) }
}

fn undamped(system: &System) -> Result<(), Failure> {
    let joints = system.bodies.iter().map(|b| b.joint.damping);
    let springs = system.parts.joint_springs.iter().map(|s| s.damping);
    let points = system.parts.point_springs.iter().map(|s| s.damping);
    let damped = joints.chain(springs).chain(points).any(|damping| damping != 0.0);
    if damped { Err(Failure::Dampers) } else { Ok(()) }
}

/// Steps of new engines from any state.
struct Steps<'a> {
    system: &'a System,
    spec: &'a Spec,
    step: f64,
    limits: &'a Limits<'a>,
    begin: Instant,
    conserved: Vec<Conserved>,
    /// Largest change of a conserved component so far, over its scale.
    worst_momentum: Cell<Option<f64>>,
}

impl<'a> Steps<'a> {
    fn new(system: &'a System, spec: &'a Spec, step: f64, limits: &'a Limits<'a>) -> Steps<'a> {
        let conserved = momentum::conserved(system);
        Steps { system, spec, step, limits, begin: Instant::now(), conserved, worst_momentum: Cell::new(None) }
    }

    /// The state after `count` steps of a new engine.
    fn taken(&self, from: &System, count: usize) -> Result<State, Failure> {
        if self.limits.interrupted.load(Ordering::Relaxed) {
            return Err(Failure::Interrupted);
        }
        if self.begin.elapsed() > self.limits.budget {
            return Err(Failure::OverBudget { budget_s: self.limits.budget.as_secs_f64() });
        }
        let failed = |what: String| Failure::Step(what);
        let mut engine = engines::build(self.spec, from, self.step).map_err(|e| failed(e.to_string()))?;
        (0..count).try_for_each(|_| engine.step()).map_err(|e| failed(e.to_string()))?;
        let mut state = from.initial.clone();
        engine.write_state(&mut state);
        if !state.is_finite() {
            return Err(Failure::NotFinite);
        }
        self.watch_momentum(&from.initial, &state);
        Ok(state)
    }

    fn watch_momentum(&self, before: &State, after: &State) {
        for component in &self.conserved {
            let change = component.value(self.system, after) - component.value(self.system, before);
            let error = (change / component.scale).abs();
            let worst = self.worst_momentum.get().unwrap_or(0.0);
            self.worst_momentum.set(Some(if error > worst { error } else { worst }));
        }
    }

    fn momentum_error(&self) -> Option<f64> {
        self.worst_momentum.get()
    }

    /// The largest entry of `Phi_2 z - Phi Phi z`.
    fn memory(&self, state: &State) -> Result<f64, Failure> {
        let scale = scale_at(self.system, state)?;
        let here = Phase::about(self.system, state, &scale, 0.0)?;
        let start = here.system(&here.point(state)?)?;
        let first = self.taken(&start, STEPS)?;
        let middle = Phase::about(self.system, &first, &scale, 0.0)?;
        let anew = self.taken(&middle.system(&middle.point(&first)?)?, STEPS)?;
        let in_one = self.taken(&start, 2 * STEPS)?;
        let there = Phase::about(self.system, &anew, &scale, 0.0)?;
        Ok((there.point(&in_one)? - there.point(&anew)?).amax())
    }
}
