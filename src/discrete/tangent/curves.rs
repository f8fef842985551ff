//! Families of curves that a discretisation of the tangent bundle is made of.

use crate::discrete::solve::{SolveError, central_difference};
use crate::discrete::structure::{join, split};
use crate::discrete::system::SharedSystem;
use crate::discrete::{Matrix, Vector};

/// The bend of a curve at time `t`, with its derivatives in `q` and `v`.
#[derive(Clone, Debug)]
pub struct Bend {
    /// `xi` in `psi(t) = q + t v + t^2 xi`
    pub position: Vector,
    pub position_q: Matrix,
    pub position_v: Matrix,
    /// `eta` in `psi'(t) = v + t eta`
    pub velocity: Vector,
    pub velocity_q: Matrix,
    pub velocity_v: Matrix,
}

/// A curve `psi(t)` for each `(q, v)`, with `psi(0) = q` and `psi'(0) = v`. What it adds to the straight line is asked
/// for divided by `t^2` and by `t`, so that nothing cancels for short times.
pub trait Curves: Send + Sync {
    /// # Errors
    /// [`SolveError`] where the curve cannot be had.
    fn bend(&self, q: &Vector, v: &Vector, t: f64) -> Result<Bend, SolveError>;
}

/// `psi(t) = q + t v`
#[derive(Clone, Copy, Debug)]
pub struct Straight;

impl Curves for Straight {
    fn bend(&self, q: &Vector, _v: &Vector, _t: f64) -> Result<Bend, SolveError> {
        let n = q.len();
        let (none, zero) = (Vector::zeros(n), Matrix::zeros(n, n));
        Ok(Bend {
            position: none.clone(),
            position_q: zero.clone(),
            position_v: zero.clone(),
            velocity: none,
            velocity_q: zero.clone(),
            velocity_v: zero,
        })
    }
}

/// Parabolas that osculate the motion, `psi(t) = q + t v + 1/2 t^2 a(q, v)`. Derivatives of the acceleration are taken
/// by differences (error about 1e-12).
pub struct Osculating(pub SharedSystem);

/// Increment of those differences.
const INCREMENT: f64 = 5e-3;

impl Curves for Osculating {
    fn bend(&self, q: &Vector, v: &Vector, _t: f64) -> Result<Bend, SolveError> {
        let n = q.len();
        let velocity = self.0.acceleration(q, v)?;
        let by = central_difference(&join(q, v), INCREMENT, |z| {
            let (q, v) = split(z);
            self.0.acceleration(&q, &v)
        })?;
        let (velocity_q, velocity_v) = (by.columns(0, n).into_owned(), by.columns(n, n).into_owned());
        Ok(Bend {
            position: &velocity * 0.5,
            position_q: &velocity_q * 0.5,
            position_v: &velocity_v * 0.5,
            velocity,
            velocity_q,
            velocity_v,
        })
    }
}

/// Sinusoids, `psi(t) = q cos(w t) + v sin(w t)/w`: the motion of an oscillator.
#[derive(Clone, Copy, Debug)]
pub struct Sinusoids {
    /// w, rad/s
    pub frequency: f64,
}

impl Curves for Sinusoids {
    fn bend(&self, q: &Vector, v: &Vector, t: f64) -> Result<Bend, SolveError> {
        let (n, w) = (q.len(), self.frequency);
        let (x, square) = (w * t, w * w);
        let (first, second, third) = (sine(x), cosine(x), cubic(x));
        let identity = Matrix::identity(n, n);
        Ok(Bend {
            position: q * (-square * second) + v * (square * t * third),
            position_q: &identity * (-square * second),
            position_v: &identity * (square * t * third),
            velocity: q * (-square * first) - v * (square * t * second),
            velocity_q: &identity * (-square * first),
            velocity_v: identity * (-square * t * second),
        })
    }
}

/// `sin(x)/x`
fn sine(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

/// `(1 - cos x)/x^2`
fn cosine(x: f64) -> f64 {
    0.5 * sine(0.5 * x).powi(2)
}

/// `(sin x - x)/x^3`, by its series where the difference would cancel.
fn cubic(x: f64) -> f64 {
    if x.abs() > 1.0 {
        return (x.sin() - x) / x.powi(3);
    }
    // Terms (-1)^k x^(2k - 2) / (2k + 1)! for k from 1.
    let mut term = -1.0 / 6.0;
    let mut sum = 0.0;
    for k in 1..10 {
        sum += term;
        term *= -x * x / f64::from((2 * k + 2) * (2 * k + 3));
    }
    sum
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::discrete::problems::double_pendulum;

    /// Positions, velocities and derivatives of each family belong together.
    #[test]
    fn bends_have_the_derivatives_that_they_state() {
        let problem = double_pendulum();
        let (q, v) = (&problem.q, &problem.v);
        let families: [Arc<dyn Curves>; 3] =
            [Arc::new(Straight), Arc::new(Osculating(problem.system.clone())), Arc::new(Sinusoids { frequency: 1.7 })];
        for curves in families {
            for t in [-0.3, 1e-3, 0.9] {
                let bend = curves.bend(q, v, t).expect("a curve");
                let n = q.len();
                let by = central_difference(&join(q, v), 5e-3, |z| {
                    let (q, v) = split(z);
                    let bend = curves.bend(&q, &v, t)?;
                    Ok(join(&bend.position, &bend.velocity))
                })
                .expect("curves");
                let blocks = [
                    (0, 0, &bend.position_q),
                    (0, n, &bend.position_v),
                    (n, 0, &bend.velocity_q),
                    (n, n, &bend.velocity_v),
                ];
                for (i, j, block) in blocks {
                    let off = (block - by.view((i, j), (n, n))).amax();
                    assert!(off <= 1e-12, "{off:e}");
                }
                let point = |t: f64| Ok(q + v * t + curves.bend(q, v, t)?.position * (t * t));
                let slope = central_difference(&Vector::from_element(1, t), 5e-3, |t| point(t[0])).expect("curves");
                let off = (slope - (v + bend.velocity * t)).amax();
                assert!(off <= 1e-12, "{off:e}");
            }
        }
    }
}
