//! The two figures of Marsden and West (2001), and the long-time behaviour of all methods, as plain data.

use super::Matrix;
use super::Vector;
use super::flow::Motion;
use super::force::{Force, LinearDrag};
use super::lagrangian::{DiscreteLegendre, WithForce};
use super::maps::hamiltonian_map_from;
use super::methods::{METHODS, Method, Newmark, alpha};
use super::problems::{Problem, radial_particle};
use super::solve::SolveError;
use super::structure::symplecticity_defect;
use super::system::LagrangianSystem;

/// Energy of one method over time.
#[derive(Clone, Debug)]
pub struct EnergySeries {
    pub name: &'static str,
    /// Step, s; `None` for the benchmark.
    pub step: Option<f64>,
    /// s
    pub time: Vec<f64>,
    /// J
    pub energy: Vec<f64>,
}

/// The curves of a figure, the benchmark first.
#[derive(Clone, Debug)]
pub struct EnergyFigure {
    pub title: &'static str,
    pub series: Vec<EnergySeries>,
}

/// Step of both figures, s.
const STEP: f64 = 0.25;
/// Length of both figures, s.
const DURATION: f64 = 1600.0;
/// Every so many steps a point is kept.
const KEEP: usize = 16;
/// Drag of figure 2: `f = -1e-3 v`, kg/s.
const DRAG: f64 = 1e-3;

/// MW figure 1: a particle in the plane, `L = 1/2 |v|^2 - |q|^2 (|q|^2 - 1)^2`. The variational Newmark method
/// (`beta = 0`) against RK4 at the same step. The start and the step are ours.
///
/// # Errors
/// [`SolveError`] where a step is not found.
pub fn conservative_particle() -> Result<EnergyFigure, SolveError> {
    let problem = radial_particle();
    let system = problem.system.as_ref();
    let newmark = Newmark::new(problem.system.clone(), 0.0)
        .ok_or(SolveError::Undefined { what: "Newmark needs a constant mass matrix" })?;
    let exact = system.energy(&problem.q, &problem.v);
    Ok(EnergyFigure {
        title: "MW figure 1: energy of a particle in a radial potential",
        series: vec![
            EnergySeries { name: "exact", step: None, time: vec![0.0, DURATION], energy: vec![exact, exact] },
            variational("Newmark (variational)", &newmark, &problem)?,
            runge_kutta(&problem, None)?,
        ],
    })
}

/// MW figure 2, example 3.2.3: the same particle under the drag `f = -1e-3 v`. The forced midpoint rule against RK4 at
/// the same step and a benchmark motion.
///
/// # Errors
/// [`SolveError`] where a step is not found.
pub fn dissipative_particle() -> Result<EnergyFigure, SolveError> {
    let problem = radial_particle();
    let drag = LinearDrag { coefficient: Matrix::identity(2, 2) * DRAG };
    let midpoint = alpha(problem.system.clone(), 0.5);
    let forced = WithForce { lagrangian: &midpoint, force: &drag };
    Ok(EnergyFigure {
        title: "MW figure 2: energy of the particle under weak drag",
        series: vec![
            benchmark(&problem, &drag)?,
            variational("midpoint", &forced, &problem)?,
            runge_kutta(&problem, Some(&drag))?,
        ],
    })
}

fn steps() -> usize {
    (DURATION / STEP).round() as usize
}

fn empty(name: &'static str, step: Option<f64>) -> EnergySeries {
    EnergySeries { name, step, time: Vec::new(), energy: Vec::new() }
}

impl EnergySeries {
    fn keep(&mut self, k: usize, energy: f64) {
        if k.is_multiple_of(KEEP) {
            self.time.push(k as f64 * STEP);
            self.energy.push(energy);
        }
    }
}

fn benchmark(problem: &Problem, force: &dyn Force) -> Result<EnergySeries, SolveError> {
    let motion = Motion { force: Some(force), ..Motion::of(problem.system.as_ref()) };
    let mut series = empty("benchmark", None);
    let mut at = motion.flow(&problem.q, &problem.v, 0.0, STEP)?;
    for k in 0..=steps() {
        series.keep(k, problem.system.energy(&at.q, &at.v));
        at = motion.flow(&at.q, &at.v, STEP, STEP)?;
    }
    Ok(series)
}

fn variational(name: &'static str, ld: &impl DiscreteLegendre, problem: &Problem) -> Result<EnergySeries, SolveError> {
    let mut series = empty(name, Some(STEP));
    let (mut q, mut p) = (problem.q.clone(), problem.system.momentum(&problem.q, &problem.v));
    for k in 0..=steps() {
        series.keep(k, problem.system.hamiltonian(&q, &p)?);
        let guess = &q + problem.system.velocity(&q, &p)? * STEP;
        (q, p) = hamiltonian_map_from(ld, &q, &p, guess, STEP)?;
    }
    Ok(series)
}

/// The classical Runge-Kutta method of order 4 in `(q, v)`.
fn runge_kutta(problem: &Problem, force: Option<&dyn Force>) -> Result<EnergySeries, SolveError> {
    let motion = Motion { force, ..Motion::of(problem.system.as_ref()) };
    let mut series = empty("RK4", Some(STEP));
    let (mut q, mut v) = (problem.q.clone(), problem.v.clone());
    for k in 0..=steps() {
        series.keep(k, problem.system.energy(&q, &v));
        (q, v) = runge_kutta_step(&motion, &q, &v, STEP)?;
    }
    Ok(series)
}

fn runge_kutta_step(motion: &Motion<'_>, q: &Vector, v: &Vector, h: f64) -> Result<(Vector, Vector), SolveError> {
    let a1 = motion.acceleration(q, v)?;
    let v2 = v + &a1 * (0.5 * h);
    let a2 = motion.acceleration(&(q + v * (0.5 * h)), &v2)?;
    let v3 = v + &a2 * (0.5 * h);
    let a3 = motion.acceleration(&(q + &v2 * (0.5 * h)), &v3)?;
    let v4 = v + &a3 * h;
    let a4 = motion.acceleration(&(q + &v3 * h), &v4)?;
    let mean = |a: &Vector, b: &Vector, c: &Vector, d: &Vector| (a + b * 2.0 + c * 2.0 + d) * (h / 6.0);
    Ok((q + mean(v, &v2, &v3, &v4), v + mean(&a1, &a2, &a3, &a4)))
}

/// What one method conserves over a long run.
#[derive(Clone, Debug)]
pub struct LongTimeRow {
    pub method: &'static str,
    /// s
    pub step: f64,
    pub steps: usize,
    /// Largest `|H - H0|`, J
    pub energy_error: f64,
    /// Slope of the energy error against time, least squares, J/s
    pub energy_slope: f64,
    /// Largest `|J - J0|` of the angular momentum, kg m^2/s
    pub momentum_error: f64,
    /// Largest entry of `A^T J A - J` for the map's derivative `A` by differences, at the last point
    pub symplecticity_defect: f64,
}

/// Step and number of steps of the long-time table.
const LONG_STEP: f64 = 0.1;
const LONG_STEPS: usize = 2000;

/// Energy, angular momentum and symplectic form of all methods, and of RK4, on the radial particle.
///
/// # Errors
/// [`SolveError`] where a step is not found.
pub fn long_time_table() -> Result<Vec<LongTimeRow>, SolveError> {
    let mut rows = Vec::new();
    for method in METHODS {
        rows.extend(long_time_row(method)?);
    }
    rows.push(runge_kutta_row()?);
    Ok(rows)
}

/// One row of the table; `None` where the method is not defined for the particle.
///
/// # Errors
/// [`SolveError`] where a step is not found.
pub(crate) fn long_time_row(method: &Method) -> Result<Option<LongTimeRow>, SolveError> {
    let problem = radial_particle();
    let Some(ld) = (method.build)(problem.system.clone()) else { return Ok(None) };
    long_run(method.name, &problem, |q, p| {
        let guess = q + problem.system.velocity(q, p)? * LONG_STEP;
        hamiltonian_map_from(ld.as_ref(), q, p, guess, LONG_STEP)
    })
    .map(Some)
}

/// The row of RK4, which is not symplectic.
///
/// # Errors
/// [`SolveError`] where an acceleration is not found.
pub(crate) fn runge_kutta_row() -> Result<LongTimeRow, SolveError> {
    let problem = radial_particle();
    let motion = Motion::of(problem.system.as_ref());
    // The mass is 1: momentum and velocity are the same numbers.
    long_run("RK4", &problem, |q, p| runge_kutta_step(&motion, q, p, LONG_STEP))
}

fn long_run<F>(method: &'static str, problem: &Problem, mut map: F) -> Result<LongTimeRow, SolveError>
where
    F: FnMut(&Vector, &Vector) -> Result<(Vector, Vector), SolveError>,
{
    let system: &dyn LagrangianSystem = problem.system.as_ref();
    let moment = |q: &Vector, p: &Vector| q[0] * p[1] - q[1] * p[0];
    let (mut q, mut p) = (problem.q.clone(), system.momentum(&problem.q, &problem.v));
    let (energy0, moment0) = (system.hamiltonian(&q, &p)?, moment(&q, &p));
    let (mut energy_error, mut momentum_error) = (0.0f64, 0.0f64);
    let mean_time = 0.5 * LONG_STEP * (LONG_STEPS + 1) as f64;
    let (mut covariance, mut variance) = (0.0, 0.0);
    for k in 1..=LONG_STEPS {
        (q, p) = map(&q, &p)?;
        let error = system.hamiltonian(&q, &p)? - energy0;
        energy_error = energy_error.max(error.abs());
        momentum_error = momentum_error.max((moment(&q, &p) - moment0).abs());
        let t = k as f64 * LONG_STEP - mean_time;
        covariance += t * error;
        variance += t * t;
    }
    Ok(LongTimeRow {
        method,
        step: LONG_STEP,
        steps: LONG_STEPS,
        energy_error,
        energy_slope: covariance / variance,
        momentum_error,
        symplecticity_defect: symplecticity_defect(&q, &p, 5e-3, map)?,
    })
}
