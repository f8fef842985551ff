//! What a few steps of an engine preserve of the structure of the motion, seen from outside.
//!
//! The exact motion of a system without dampers is a map of joint coordinates `theta` and conjugate momenta `p` that is
//! symplectic, time-reversible, and keeps the momentum of every symmetry (Marsden and West 2001, sections 1.3 and 2.1; on a
//! constraint manifold 3.4). [`examine`] takes [`STEPS`] steps of ANY engine as such a map `Phi` and says how far it is from
//! that:
//!
//! - *symplecticity*: the largest entry of `A^T Omega A - Omega`, where `A` is the derivative of `Phi` by differences and
//!   `Omega = dtheta ^ dp`; what the differences themselves err by is estimated and stands beside it,
//! - *reversibility*: the largest entry of `R Phi R Phi z - z`, where `R` turns all velocities round,
//! - *momentum map*: the largest change of a component that the system conserves, over its scale, among all states that the
//!   differences visit,
//! - *memory*: the largest entry of `Phi_2 z - Phi Phi z`, where `Phi_2` is twice as many steps of one engine: what steps take
//!   from those before them and not from coordinates and momenta (impulses kept to start the next solve, joint errors).
//!
//! Engines are made new at every point, from the coordinates and velocities that belong to it. An engine with memory does not
//! start as it goes on: rapier's impulse joints, made new without joint errors, take some steps to their own small ones, and
//! that start is no symplectic map. Several steps as one map count it once. Where the memory is not small against the defect
//! of the form, part of the defect is that of the start.
//!
//! Where an engine's positions belong to another time than its velocities
//! ([`Engine::position_lag_s`](crate::engines::Engine::position_lag_s)) symplecticity and reversibility are taken twice: of the
//! states as they are, and of the same map in coordinates moved back to the time of the velocities, `theta - lag thetadot`.
//!
//! In systems with loops or mimic joints the coordinates are those of independent joints. A point is written as
//! `y = (theta, H^-1 p)` with the diagonal `H` of the mass matrix at the start, so that all entries
//! are rad, m, rad/s or m/s; an entry `(i, j)` of the form's defect is divided by `sqrt(H_i H_j)`.

mod independent;
mod phase_chart;
mod symplecticity;

use std::cell::Cell;
use std::sync::atomic::Ordering;
use std::time::Instant;

use nalgebra::{DMatrix, DVector};

use super::outcome::Limits;
use crate::engines::{self, Spec};
use crate::mechanics::momentum::{self, Conserved};
use crate::mechanics::{State, System};

use independent::Independent;
pub use phase_chart::{PhaseChart, body_momenta, twists};
pub use symplecticity::{Differenced, REACHES, defect_by, symplecticity};

/// Steps that are examined as one map.
pub const STEPS: usize = 8;
/// Time into the motion at which they are examined, s: a scene that starts at rest moves by then.
pub const EXAMINED_AT: f64 = 0.5;
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

/// Why a figure could not be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    #[error("{0}")]
    Step(String),
    #[error("with dampers the exact motion is neither symplectic nor reversible")]
    Dampers,
    #[error("with drives that change in time the exact motion is not reversible")]
    Drives,
    #[error("the loops cannot be closed as far from the state as the differences reach")]
    Open,
    #[error("a step led to a state that is not a number")]
    NotFinite,
    #[error("the mass matrix of the joint coordinates is not positive")]
    Singular,
    #[error(
        "the structure of the steps took longer than its budget of {budget_s} s on the wall clock; allow more with --budget"
    )]
    OverBudget { budget_s: f64 },
    #[error("interrupted")]
    Interrupted,
}

/// A map of states: takes the initial state of a system to the state that follows.
pub type StateMap<'a> = dyn Fn(&System) -> Result<State, Failure> + 'a;

/// Points of phase space as vectors `y`, about a state. `theta` and `p` are those of independent joints.
pub(super) struct Phase<'a> {
    chart: PhaseChart<'a>,
    /// Where joints depend on one another.
    independent: Option<Independent>,
    /// Diagonal of the mass matrix at the start, kg or kg m^2.
    scale: DVector<f64>,
    /// s
    lag: f64,
}

impl<'a> Phase<'a> {
    fn about(system: &'a System, state: &State, scale: &DVector<f64>, lag: f64) -> Result<Phase<'a>, Failure> {
        let chart = PhaseChart::about(system, state);
        Ok(Phase { independent: Independent::about(&chart, state)?, chart, scale: scale.clone(), lag })
    }

    /// `y` of a state.
    fn point(&self, state: &State) -> Result<DVector<f64>, Failure> {
        let all = self.chart.coordinates(state);
        let mut p = self.restricted(&all, self.chart.momenta(&all, state))?;
        let mut theta = self.independent.as_ref().map_or(all.clone(), |independent| independent.free(&all));
        if self.lag != 0.0 {
            let mass = self.mass_matrix(&all)?;
            let rate = mass.cholesky().ok_or(Failure::Singular)?.solve(&p);
            theta.axpy(-self.lag, &rate, 1.0);
            p = self.mass_matrix(&self.all(theta.clone())?)? * rate;
        }
        p.component_div_assign(&self.scale);
        Ok(stack(&theta, &p))
    }

    /// The system that starts at `y`.
    fn system(&self, y: &DVector<f64>) -> Result<System, Failure> {
        let d = self.scale.len();
        let (mut theta, p) = (y.rows(0, d).into_owned(), y.rows(d, d).component_mul(&self.scale));
        let mass = self.mass_matrix(&self.all(theta.clone())?)?;
        let rate = mass.cholesky().ok_or(Failure::Singular)?.solve(&p);
        theta.axpy(self.lag, &rate, 1.0);
        let all = self.all(theta)?;
        let rates = match &self.independent {
            Some(independent) => independent.rates(&self.chart, &all)? * rate,
            None => rate,
        };
        Ok(self.chart.system_at(&all, &rates))
    }

    /// The coordinates of all joints at those of the independent ones.
    fn all(&self, theta: DVector<f64>) -> Result<DVector<f64>, Failure> {
        match &self.independent {
            Some(independent) => independent.close(&self.chart, &theta),
            None => Ok(theta),
        }
    }

    /// The momenta of the independent joints, `B^T p`, from those of all at the coordinates of all.
    fn restricted(&self, all: &DVector<f64>, p: DVector<f64>) -> Result<DVector<f64>, Failure> {
        match &self.independent {
            Some(independent) => Ok(independent.rates(&self.chart, all)?.tr_mul(&p)),
            None => Ok(p),
        }
    }

    /// The mass matrix of the independent joints, `B^T M B`, at the coordinates of all.
    fn mass_matrix(&self, all: &DVector<f64>) -> Result<DMatrix<f64>, Failure> {
        let mass = self.chart.mass_matrix(all);
        match &self.independent {
            Some(independent) => {
                let b = independent.rates(&self.chart, all)?;
                Ok(b.tr_mul(&(mass * &b)))
            }
            None => Ok(mass),
        }
    }
}

fn stack(a: &DVector<f64>, b: &DVector<f64>) -> DVector<f64> {
    DVector::from_iterator(a.len() + b.len(), a.iter().chain(b.iter()).copied())
}

/// `R y`: the same coordinates, the momenta turned round.
fn turned(y: &DVector<f64>) -> DVector<f64> {
    let d = y.len() / 2;
    let mut out = y.clone();
    out.rows_mut(d, d).neg_mut();
    out
}

/// Diagonal of the mass matrix at a state.
fn scale_at(system: &System, state: &State) -> Result<DVector<f64>, Failure> {
    let phase = Phase::about(system, state, &DVector::zeros(0), 0.0)?;
    Ok(phase.mass_matrix(&phase.chart.coordinates(state))?.diagonal())
}

/// The largest entry of `R Phi R Phi z - z` at a state.
///
/// # Errors
/// Those of the map.
pub fn reversibility(system: &System, state: &State, lag: f64, map: &StateMap) -> Result<f64, Failure> {
    let scale = scale_at(system, state)?;
    let here = Phase::about(system, state, &scale, lag)?;
    let start = here.point(state)?;
    let end = map(&here.system(&start)?)?;
    let there = Phase::about(system, &end, &scale, lag)?;
    let back = map(&there.system(&turned(&there.point(&end)?))?)?;
    Ok((turned(&here.point(&back)?) - start).amax())
}

/// The state [`EXAMINED_AT`] into the motion (at most `longest` s), with its time; the initial state where the motion cannot
/// be had.
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

/// The structure of [`STEPS`] steps of an engine from a state, which is `at` s into the motion. `None` where the engine does not
/// support the system or the examination was interrupted.
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
