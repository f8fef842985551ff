//! Steps in the variables `(q, v)` of a discretised tangent bundle, and what becomes of them as `h` goes to 0 (PC).
//!
//! A discretisation of TQ assigns to each `(q, v)` a short curve `psi(t)` through `q` with velocity `v`, and its ends
//! `psi(h alpha-)` and `psi(h alpha+)` with `alpha+ - alpha- = 1`. Here the curves are straight,
//!
//! ```text
//! q- = q - alpha h v,     q+ = q + (1 - alpha) h v ,                                       (PC section 2)
//! ```
//!
//! and `L_h(q, v) = h L(q, v)` is `L_d^alpha(q-, q+)`. Two neighbouring curves `(q, v)` and `(q, v) + h (W, A)` meet where
//! `W = (1 - alpha) v + alpha (v + h A)`, and the discrete Euler-Lagrange equations there, divided by `h`, are
//!
//! ```text
//! integral from 0 to 1 of (L_vq W + L_vv A)(z + s h (W, A)) ds  =  alpha L_q(z) + (1 - alpha) L_q(z + h (W, A)) .
//! ```
//!
//! This *blown-up* equation is regular at `h = 0`, where it is the Euler-Lagrange equation, and nothing in it cancels for
//! small `h` (PC section 2.4). The position form has `(q2 - 2 q1 + q0)/h^2` instead.

use super::lagrangian::{DiscreteLegendre, Legendre};
use super::maps::lagrangian_map;
use super::methods::alpha;
use super::problems::Problem;
use super::quadrature::Quadrature;
use super::solve::{SolveError, newton};
use super::system::LagrangianSystem;
use super::{Matrix, Vector};

/// Nodes for the mean of the second derivatives along a step.
const MEAN_NODES: usize = 6;

/// Rates `(W, A)` of one step of `L_d^alpha` in `(q, v)`: the step leads to `q + h W`, `v + h A`. `h = 0` gives the
/// Euler-Lagrange vector field.
///
/// # Errors
/// [`SolveError`] where the equation has no solution.
pub fn blown_up_step(
    system: &dyn LagrangianSystem,
    alpha: f64,
    q: &Vector,
    v: &Vector,
    h: f64,
) -> Result<(Vector, Vector), SolveError> {
    let rule = Quadrature::gauss(MEAN_NODES);
    let rate_of_position = |a: &Vector| v + a * (alpha * h);
    let force_here = system.gradient(q, v).q;
    let guess = system.acceleration(q, v)?;
    let rate = newton("blown-up step", guess, |a| {
        let w = rate_of_position(a);
        let mut mean_vv = Matrix::zeros(q.len(), q.len());
        let mut mean_vq = mean_vv.clone();
        for (s, weight) in rule.nodes.iter().zip(&rule.weights) {
            let second = system.hessian(&(q + &w * (s * h)), &(v + a * (s * h)));
            mean_vv += second.vv * *weight;
            mean_vq += second.qv.transpose() * *weight;
        }
        let (q_next, v_next) = (q + &w * h, v + a * h);
        let force_next = system.gradient(&q_next, &v_next).q;
        let residual = &mean_vq * &w + &mean_vv * a - &force_here * alpha - force_next * (1.0 - alpha);
        // The derivative of the means is O(h) and left out: the iteration still contracts by O(h) a round.
        let second = system.hessian(&q_next, &v_next);
        let by_a = &second.qq * (alpha * h * h) + &second.qv * h;
        let jacobian = mean_vv + mean_vq * (alpha * h) - by_a * (1.0 - alpha);
        Ok((residual, jacobian))
    })?;
    Ok((rate_of_position(&rate), rate))
}

/// Accelerations from one step of the midpoint rule, solved in two ways.
#[derive(Clone, Copy, Debug)]
pub struct SmallStep {
    /// s
    pub h: f64,
    /// Error of `A` of the blown-up equation against the acceleration in the middle of the step.
    pub blown_up: f64,
    /// Error of `(q2 - 2 q1 + q0)/h^2` of the position form.
    pub position_form: f64,
}

/// The blown-up principle in figures: one step of the midpoint rule for each `h`.
///
/// # Errors
/// [`SolveError`] where a step has no solution.
pub fn small_steps(problem: &Problem, steps: &[f64]) -> Result<Vec<SmallStep>, SolveError> {
    let system = problem.system.as_ref();
    let (q, v) = (&problem.q, &problem.v);
    let ld = alpha(problem.system.clone(), 0.5);
    steps
        .iter()
        .map(|&h| {
            let (w, a) = blown_up_step(system, 0.5, q, v, h)?;
            let exact = system.acceleration(&(q + &w * (0.5 * h)), &(v + &a * (0.5 * h)))?;
            let (q0, q1) = (q - v * (0.5 * h), q + v * (0.5 * h));
            let q2 = lagrangian_map(&ld, &q0, &q1, h)?;
            let second_difference = (&q2 - &q1 - (&q1 - &q0)) / (h * h);
            Ok(SmallStep { h, blown_up: (a - &exact).norm(), position_form: (second_difference - exact).norm() })
        })
        .collect()
}

/// `F-` of one discrete Lagrangian with `F+` of another. Where both have order r the map has only order r - 1 (PC section
/// 4): the momenta that it matches err differently.
pub struct TwoSided<A, B> {
    pub minus: A,
    pub plus: B,
}

impl<A: DiscreteLegendre, B: DiscreteLegendre> DiscreteLegendre for TwoSided<A, B> {
    fn legendre(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Legendre, SolveError> {
        let (at0, at1) = (self.minus.legendre(q0, q1, h)?, self.plus.legendre(q0, q1, h)?);
        Ok(Legendre { p1: at1.p1, p1_q0: at1.p1_q0, p1_q1: at1.p1_q1, ..at0 })
    }
}
