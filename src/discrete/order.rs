//! Measured orders: how far `L_d`, its Legendre transforms and its map are from the exact ones (MW 2.3, PC 4).

use super::Vector;
use super::flow::{Motion, MotionPoint};
use super::lagrangian::DiscreteLagrangian;
use super::maps::hamiltonian_map_from;
use super::methods::{METHODS, Method};
use super::problems::{Problem, coupled_wells, double_pendulum};
use super::solve::SolveError;
use crate::numeric::fit::power;

/// Orders of the four things that belong to a discrete Lagrangian. Order r means an error of `O(h^(r+1))` in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orders {
    /// of `L_d` against `L_d^E`, at the ends of an exact motion
    pub lagrangian: f64,
    /// of `F- L_d` against the exact momentum at the start
    pub legendre_minus: f64,
    /// of `F+ L_d` against the exact momentum at the end
    pub legendre_plus: f64,
    /// of the discrete Hamiltonian map against the flow
    pub map: f64,
}

/// Errors of one step.
#[derive(Clone, Copy, Debug)]
pub struct OrderSample {
    /// Step, s.
    pub h: f64,
    pub lagrangian: f64,
    pub legendre_minus: f64,
    pub legendre_plus: f64,
    pub map: f64,
}

/// One method on one problem.
#[derive(Clone, Debug)]
pub struct OrderRow {
    pub method: &'static str,
    pub equation: &'static str,
    pub problem: &'static str,
    pub theory: Orders,
    pub measured: Orders,
    pub samples: Vec<OrderSample>,
}

/// Longest step tried, s; the others follow in ratios of the cube root of 1/2.
const LONGEST_STEP: f64 = 0.5;
const STEPS: usize = 17;
/// Steps that an error is averaged over, half of them backwards, and the time between them, s.
const STARTS: usize = 20;
const BETWEEN_STARTS: f64 = 0.6;
/// Longest substep of the reference flow, s.
const REFERENCE_STEP: f64 = 0.1;
/// Points that a slope is fitted to: the smallest steps whose error stands clear of roundoff.
const FITTED: usize = 4;
/// An error counts where it is this many units of roundoff.
const CLEAR_OF_ROUNDOFF: f64 = 30.0;

/// What theory says. `L_d` and the map have the order of the method. The Legendre transforms divide by `h` and can be
/// one order worse (PC section 4; MW theorem 2.3.1 claims no loss), and are for every method of the list but one:
/// chords with an accurate quadrature and a constant mass err there only by the force between chord and motion,
/// `O(h^3)`.
pub fn theory(method: &Method, problem: &Problem) -> Orders {
    let r = method.order as f64;
    let accurate_chord = method.name == "Galerkin 1, Gauss 2" && problem.system.separable().is_some();
    let legendre = if accurate_chord { r } else { r - 1.0 };
    Orders { lagrangian: r, legendre_minus: legendre, legendre_plus: legendre, map: r }
}

/// The two nonlinear, non-separable problems of the table: a constant mass matrix, and one that depends on the
/// position.
pub fn problems() -> [Problem; 2] {
    [coupled_wells(), double_pendulum()]
}

/// The table of all methods on both [`problems`].
///
/// # Errors
/// [`SolveError`] where the reference motion fails.
pub fn order_table() -> Result<Vec<OrderRow>, SolveError> {
    let mut rows = Vec::new();
    for problem in problems() {
        for method in METHODS {
            rows.extend(order_row(method, &problem)?);
        }
    }
    Ok(rows)
}

/// One row of the table; `None` where the method is not defined for the problem.
///
/// # Errors
/// [`SolveError`] where the reference motion fails.
pub(crate) fn order_row(method: &Method, problem: &Problem) -> Result<Option<OrderRow>, SolveError> {
    let Some(ld) = (method.build)(problem.system.clone()) else { return Ok(None) };
    let samples = order_samples(ld.as_ref(), problem)?;
    Ok(Some(OrderRow {
        method: method.name,
        equation: method.equation,
        problem: problem.name,
        theory: theory(method, problem),
        measured: Orders {
            lagrangian: fitted_order(samples.iter().map(|s| (s.h, s.lagrangian, f64::EPSILON))),
            legendre_minus: fitted_order(samples.iter().map(|s| (s.h, s.legendre_minus, f64::EPSILON / s.h))),
            legendre_plus: fitted_order(samples.iter().map(|s| (s.h, s.legendre_plus, f64::EPSILON / s.h))),
            map: fitted_order(samples.iter().map(|s| (s.h, s.map, f64::EPSILON / s.h))),
        },
        samples,
    }))
}

/// Errors of one step over a range of step sizes: root mean squares over steps spread along the motion and its
/// reversal, each centred on its time, so that chance cancellations at one point do not pass for order. Step sizes at
/// which some step cannot be solved are left out.
///
/// # Errors
/// [`SolveError`] where the reference motion fails.
pub fn order_samples(ld: &dyn DiscreteLagrangian, problem: &Problem) -> Result<Vec<OrderSample>, SolveError> {
    let motion = Motion::of(problem.system.as_ref());
    let mut middles = points_along(&motion, &problem.q, &problem.v, STARTS / 2, BETWEEN_STARTS)?;
    let back: Vec<MotionPoint> = middles.iter().map(|m| MotionPoint { v: -&m.v, ..m.clone() }).collect();
    middles.extend(back);
    let errors = mean_errors(&motion, &middles, |start, end, h| one_step_errors(ld, &motion, start, end, h))?;
    let sample = |(h, [lagrangian, legendre_minus, legendre_plus, map]): (f64, [f64; 4])| OrderSample {
        h,
        lagrangian,
        legendre_minus,
        legendre_plus,
        map,
    };
    Ok(errors.into_iter().map(sample).collect())
}

/// So many points of a motion, `apart` s from one to the next.
fn points_along(
    motion: &Motion<'_>,
    q: &Vector,
    v: &Vector,
    count: usize,
    apart: f64,
) -> Result<Vec<MotionPoint>, SolveError> {
    let mut points = vec![motion.flow(q, v, 0.0, REFERENCE_STEP)?];
    for i in 1..count {
        points.push(motion.flow(&points[i - 1].q, &points[i - 1].v, apart, REFERENCE_STEP)?);
    }
    Ok(points)
}

/// Root mean squares of the errors of steps about the points given, for every step size at which none is `None`.
/// `squares` takes start, end and length of a step of the reference motion to squared errors.
fn mean_errors<const N: usize>(
    motion: &Motion<'_>,
    middles: &[MotionPoint],
    mut squares: impl FnMut(&MotionPoint, &MotionPoint, f64) -> Option<[f64; N]>,
) -> Result<Vec<(f64, [f64; N])>, SolveError> {
    let mut found = Vec::new();
    'steps: for k in 0..STEPS {
        let h = LONGEST_STEP * 0.5f64.powf(k as f64 / 3.0);
        let mut sums = [0.0; N];
        for middle in middles {
            let start = motion.flow(&middle.q, &middle.v, -0.5 * h, REFERENCE_STEP)?;
            let end = motion.flow(&start.q, &start.v, h, REFERENCE_STEP)?;
            let Some(errors) = squares(&start, &end, h) else { continue 'steps };
            sums.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error);
        }
        found.push((h, sums.map(|sum| (sum / middles.len() as f64).sqrt())));
    }
    Ok(found)
}

/// Squared errors of `L_d`, `F-`, `F+` and the map in one step; `None` where the step cannot be solved.
fn one_step_errors(
    ld: &dyn DiscreteLagrangian,
    motion: &Motion<'_>,
    start: &MotionPoint,
    end: &MotionPoint,
    h: f64,
) -> Option<[f64; 4]> {
    let (p0, p1) = (motion.system.momentum(&start.q, &start.v), motion.system.momentum(&end.q, &end.v));
    let guess = &start.q + &start.v * h;
    let jet = ld.jet(&start.q, &end.q, h).ok()?;
    let (q, p) = hamiltonian_map_from(ld, &start.q, &p0, guess, h).ok()?;
    Some([
        // The action is collected since the start of the step.
        (jet.value - end.action).powi(2),
        (-jet.d1 - p0).norm_squared(),
        (jet.d2 - &p1).norm_squared(),
        (q - &end.q).norm_squared() + (p - p1).norm_squared(),
    ])
}

/// Order from triples of step, error and the roundoff of the error: the slope of the logarithms, less one, over the
/// smallest steps that stand clear of roundoff. NaN where fewer than four do.
pub fn fitted_order(errors: impl Iterator<Item = (f64, f64, f64)>) -> f64 {
    let clear: Vec<(f64, f64)> = errors
        .take_while(|(_, error, roundoff)| *error > CLEAR_OF_ROUNDOFF * roundoff)
        .map(|(h, error, _)| (h, error))
        .collect();
    if clear.len() < FITTED {
        return f64::NAN;
    }
    power(&clear[clear.len() - FITTED..]) - 1.0
}

/// Order of any map of T*R^n against the motion that it approximates, with or without forces and constraints: the slope
/// of the errors of one step, centred on points along the motion, less one.
///
/// # Errors
/// [`SolveError`] where the reference motion fails.
pub fn map_order<F>(motion: &Motion<'_>, q: &Vector, v: &Vector, mut map: F) -> Result<f64, SolveError>
where
    F: FnMut(&Vector, &Vector, f64) -> Result<(Vector, Vector), SolveError>,
{
    let middles = points_along(motion, q, v, STARTS, 0.5 * BETWEEN_STARTS)?;
    let errors = mean_errors(motion, &middles, |start, end, h| {
        let Ok((q1, p1)) = map(&start.q, &motion.system.momentum(&start.q, &start.v), h) else { return None };
        let p_error = p1 - motion.system.momentum(&end.q, &end.v);
        Some([(q1 - &end.q).norm_squared() + p_error.norm_squared()])
    })?;
    Ok(fitted_order(errors.into_iter().map(|(h, [error])| (h, error, f64::EPSILON / h))))
}
