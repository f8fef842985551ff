//! The symplecticity defect of a map of states, by differences.

use nalgebra::{DMatrix, DVector};

use super::failure::{Failure, StateMap};
use super::phase::{Phase, scale_at};
use crate::mechanics::{State, System};

/// A figure that was found by differences, and what the differences err by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differenced {
    pub defect: f64,
    /// The change of the derivative between two increments of the differences, carried into the defect with all signs
    /// alike. A defect below it cannot be told from none.
    pub error: f64,
}

/// Increments of the differences, in rad, m, rad/s and m/s. A long one errs by its sixth power, a short one by
/// roundoff, which single precision makes 10^9 times larger; so another pair suits each engine.
pub(crate) const INCREMENTS: [f64; 5] = [6.4e-2, 1.6e-2, 4e-3, 1.6e-3, 6.4e-4];

/// Symplecticity defect of a map at a state, with the coordinates moved back by `lag` s. Of all neighbouring increments
/// the pair is taken that agrees best, and the defect is that of its shorter one.
///
/// # Errors
/// Those of the map, where it fails at more than all but one of the increments.
pub fn symplecticity(system: &System, state: &State, lag: f64, map: &StateMap) -> Result<Differenced, Failure> {
    let step = Step::new(system, state, lag, map)?;
    let mut best: Option<Differenced> = None;
    let mut last: Option<DMatrix<f64>> = None;
    let mut failure = Failure::NotFinite;
    for increment in INCREMENTS {
        let derivative = match step.derivative(increment) {
            Ok(derivative) => derivative,
            Err(stop @ (Failure::Interrupted | Failure::OverBudget { .. })) => return Err(stop),
            Err(other) => {
                failure = other;
                continue;
            }
        };
        if let Some(coarser) = &last {
            let pair = Differenced {
                defect: step.defect(&derivative).amax(),
                error: step.carried(&derivative, &(&derivative - coarser)),
            };
            if best.is_none_or(|best| pair.error < best.error) {
                best = Some(pair);
            }
        }
        last = Some(derivative);
    }
    best.ok_or(failure)
}

/// The defect `A^T Omega A - Omega`, scaled, with differences of one increment.
///
/// # Errors
/// Those of the map, and a derivative that is not a number.
pub fn defect_by(
    system: &System,
    state: &State,
    lag: f64,
    increment: f64,
    map: &StateMap,
) -> Result<DMatrix<f64>, Failure> {
    let step = Step::new(system, state, lag, map)?;
    Ok(step.defect(&step.derivative(increment)?))
}

/// A step from one state, with charts at both ends.
struct Step<'a> {
    map: &'a StateMap<'a>,
    here: Phase<'a>,
    there: Phase<'a>,
    start: DVector<f64>,
    scale: DVector<f64>,
}

impl<'a> Step<'a> {
    fn new(system: &'a System, state: &State, lag: f64, map: &'a StateMap<'a>) -> Result<Step<'a>, Failure> {
        let scale = scale_at(system, state)?;
        let here = Phase::about(system, state, &scale, lag)?;
        let start = here.point(state)?;
        let end = map(&here.system(&start)?)?;
        Ok(Step { map, there: Phase::about(system, &end, &scale, lag)?, here, start, scale })
    }

    /// `A` by differences.
    fn derivative(&self, increment: f64) -> Result<DMatrix<f64>, Failure> {
        let moved = |y: &DVector<f64>| self.there.point(&(self.map)(&self.here.system(y)?)?);
        let derivative = central_difference(&self.start, increment, moved)?;
        if derivative.iter().all(|x| x.is_finite()) { Ok(derivative) } else { Err(Failure::NotFinite) }
    }

    /// `Omega` in `y`: `dtheta_i ^ H_i dy'_i`.
    fn form(&self) -> DMatrix<f64> {
        let d = self.scale.len();
        let mut form = DMatrix::zeros(2 * d, 2 * d);
        for i in 0..d {
            form[(i, d + i)] = self.scale[i];
            form[(d + i, i)] = -self.scale[i];
        }
        form
    }

    fn scaled(&self, form: DMatrix<f64>) -> DMatrix<f64> {
        let (d, scale) = (self.scale.len(), &self.scale);
        form.map_with_location(|i, j, value| value / (scale[i % d] * scale[j % d]).sqrt())
    }

    fn defect(&self, a: &DMatrix<f64>) -> DMatrix<f64> {
        let form = self.form();
        self.scaled(a.tr_mul(&(&form * a)) - form)
    }

    /// The largest entry of `|A|^T |Omega| |dA|` and its transpose: how far a change `dA` of `A` can move the defect.
    fn carried(&self, a: &DMatrix<f64>, change: &DMatrix<f64>) -> f64 {
        2.0 * self.scaled(a.abs().tr_mul(&(self.form().abs() * change.abs()))).amax()
    }
}

/// Derivative of `f` at `x` by the six-point central difference, error `O(step^6)`; column `j` belongs to `x_j`.
fn central_difference<F>(x: &DVector<f64>, step: f64, f: F) -> Result<DMatrix<f64>, Failure>
where
    F: Fn(&DVector<f64>) -> Result<DVector<f64>, Failure>,
{
    const WEIGHTS: [(f64, f64); 3] = [(1.0, 3.0 / 4.0), (2.0, -3.0 / 20.0), (3.0, 1.0 / 60.0)];
    let mut derivative = DMatrix::zeros(x.len(), x.len());
    for j in 0..x.len() {
        let at = |shift: f64| {
            let mut shifted = x.clone();
            shifted[j] += shift;
            f(&shifted)
        };
        for (multiple, weight) in WEIGHTS {
            let difference = at(multiple * step)? - at(-multiple * step)?;
            derivative.column_mut(j).axpy(weight / step, &difference, 1.0);
        }
    }
    Ok(derivative)
}
