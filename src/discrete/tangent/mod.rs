//! Steps in the variables `(q, v)` of a discretised tangent bundle, and what becomes of them as `h` goes to 0 (PC
//! section 2).
//!
//! A discretisation of TQ is a family of short curves and two numbers, `(psi, alpha+, alpha-)`. It assigns to each
//! `z = (q, v)` a curve with `psi(0) = q`, `psi'(0) = v`, and its ends
//!
//! ```text
//! q- = psi(h alpha-),     q+ = psi(h alpha+),     alpha+ - alpha- = 1 .
//! ```
//!
//! A discrete Lagrangian on TQ is the action along the curve by quadrature,
//! `L_h(z) = h sum_i b_i L(psi(t_i), psi'(t_i))` at `t_i = h (alpha- + c_i)`; with straight curves and one node at
//! `t = 0` it is `h L(q, v) = L_d^alpha(q-, q+)` for `alpha = -alpha-`. Its momenta at the ends are defined by
//!
//! ```text
//! dL_h(z) = p+ . dq+(z) - p- . dq-(z) ,                                                              (1)
//! ```
//!
//! and a motion is a sequence of curves that meet with one momentum, `q+(z) = q-(z')`, `p+(z) = p-(z')` (2).
//!
//! Both equations are singular at `h = 0`, where the two ends fall together. The *blown-up* equations (PC section 2.4)
//! are not. With `psi = q + t v + t^2 xi` and `psi' = v + t eta` everything in (1) is divided by `h` on paper:
//! `p- = p+ - h r`, and
//!
//! ```text
//! (I + h B) p+ = g ,     r = C-^-T (l_q - h c^T p+) ,                                                 (3)
//! ```
//!
//! where `(l_q, l_v)` are the derivatives of `L_h/h`, `C- = I + t-^2 xi_q-` and `V- = I + t- xi_v-` those of `q-` (in
//! `v` over `t-`), `c = alpha+^2 xi_q+ - alpha-^2 xi_q-`,
//! `B = (alpha+^2 xi_v+ - alpha-^2 xi_v-)^T - h alpha- V-^T C-^-T c^T` and `g = l_v - h alpha- V-^T C-^-T l_q`. With
//! `z' = z + h (W, A)` the step (2), divided by `h`, reads
//!
//! ```text
//! W = alpha+ (v + t+ xi+(z)) - alpha- (v' + t- xi-(z')),     (p+(z') - p+(z))/h = r(z') .             (4)
//! ```
//!
//! The quotient of momenta is formed from the mean second derivatives of `L` along the step and from differences that
//! are not divided by `h`. So nothing cancels for small `h`, and at `h = 0` (4) says `W = v` and the Euler-Lagrange
//! equation for `A`. The position form has `(q2 - 2 q1 + q0)/h^2` instead.

mod curves;

use super::maps::lagrangian_map;
use super::methods::alpha;
use super::problems::Problem;
use super::quadrature::Quadrature;
use super::solve::{SolveError, central_difference, newton, solve_linear};
use super::structure::{join, split};
use super::system::{Gradient, LagrangianSystem};
use super::{Matrix, Vector};

pub use curves::{Bend, Curves, Osculating, Sinusoids, Straight};

/// A discretisation `(psi, alpha+, alpha-)` of the tangent bundle of a system's space, with the quadrature of its
/// action. `alpha+` is `alpha- + 1`. Where `alpha-` depends on `h` it is the value at the step that is taken.
pub struct Discretisation<'a> {
    pub system: &'a dyn LagrangianSystem,
    /// psi
    pub curves: &'a dyn Curves,
    /// alpha-
    pub minus: f64,
    pub quadrature: Quadrature,
}

/// Nodes for the mean of the second derivatives along a step.
const MEAN_NODES: usize = 6;
/// Increment of the differences that give Newton's method its Jacobian; the solution does not depend on it.
const INCREMENT: f64 = 1e-3;

/// A curve at a node of the quadrature.
struct Node {
    /// `t/h`, which does not vanish with `h`
    share: f64,
    t: f64,
    weight: f64,
    bend: Bend,
    position: Vector,
    velocity: Vector,
    gradient: Gradient,
}

/// Equations (3) at a point.
struct Ends {
    nodes: Vec<Node>,
    /// `v + t xi` at `t-` and `t+`: what leads to the ends, over `t`.
    chords: [Vector; 2],
    /// `V-^T C-^-T l_q`
    carried: Vector,
    /// `B`
    bending: Matrix,
    plus: Vector,
    /// `r`
    rate: Vector,
}

impl<'a> Discretisation<'a> {
    /// Straight curves with the Lagrangian taken at `(q, v)`: `L_h = h L(q, v)`, the discrete Lagrangian `L_d^alpha`.
    pub fn straight(system: &'a dyn LagrangianSystem, alpha: f64) -> Discretisation<'a> {
        let quadrature = Quadrature { nodes: vec![alpha], weights: vec![1.0], order: 1 };
        Discretisation { system, curves: &Straight, minus: -alpha, quadrature }
    }

    /// The ends `(q-, q+)` of the curve.
    ///
    /// # Errors
    /// Those of the curves.
    pub fn ends(&self, q: &Vector, v: &Vector, h: f64) -> Result<(Vector, Vector), SolveError> {
        let end = |alpha: f64| -> Result<Vector, SolveError> {
            let t = h * alpha;
            Ok(q + (v + self.curves.bend(q, v, t)?.position * t) * t)
        };
        Ok((end(self.minus)?, end(self.minus + 1.0)?))
    }

    /// The momenta `(p-, p+)` at the ends.
    ///
    /// # Errors
    /// Those of the curves, and ends that do not move independently.
    pub fn momenta(&self, q: &Vector, v: &Vector, h: f64) -> Result<(Vector, Vector), SolveError> {
        let at = self.at(q, v, h)?;
        Ok((&at.plus - at.rate * h, at.plus))
    }

    /// Rates `(W, A)` of one step: it leads to `q + h W`, `v + h A`. `h = 0` gives the Euler-Lagrange vector field.
    ///
    /// # Errors
    /// [`SolveError`] where (4) has no solution.
    pub fn step(&self, q: &Vector, v: &Vector, h: f64) -> Result<(Vector, Vector), SolveError> {
        let here = self.at(q, v, h)?;
        let plus = self.minus + 1.0;
        let residual = |rates: &Vector| {
            let (w, a) = split(rates);
            let there = self.at(&(q + &w * h), &(v + &a * h), h)?;
            let meeting = &w - &here.chords[1] * plus + &there.chords[0] * self.minus;
            Ok(join(&meeting, &(self.momentum_quotient(&here, &there, (&w, &a), h)? - there.rate)))
        };
        let guess = join(v, &self.system.acceleration(q, v)?);
        let rates = newton("blown-up step", guess, |rates| {
            Ok((residual(rates)?, central_difference(rates, INCREMENT, residual)?))
        })?;
        Ok(split(&rates))
    }

    /// The curve that begins at `q-` with the momentum `p-`.
    ///
    /// # Errors
    /// [`SolveError`] where there is none.
    pub(crate) fn beginning_at(&self, q: &Vector, p: &Vector, h: f64) -> Result<(Vector, Vector), SolveError> {
        let residual = |z: &Vector| {
            let at = split(z);
            let (minus, _) = self.ends(&at.0, &at.1, h)?;
            Ok(join(&(minus - q), &(self.momenta(&at.0, &at.1, h)?.0 - p)))
        };
        let guess = join(q, &self.system.velocity(q, p)?);
        let z =
            newton("curve of a momentum", guess, |z| Ok((residual(z)?, central_difference(z, INCREMENT, residual)?)))?;
        Ok(split(&z))
    }

    /// The discrete Hamiltonian map `(q-, p-) -> (q+, p+)` along one curve.
    ///
    /// # Errors
    /// [`SolveError`] where no curve begins so.
    pub fn hamiltonian_map(&self, q: &Vector, p: &Vector, h: f64) -> Result<(Vector, Vector), SolveError> {
        let (q, v) = self.beginning_at(q, p, h)?;
        Ok((self.ends(&q, &v, h)?.1, self.momenta(&q, &v, h)?.1))
    }

    fn nodes(&self, q: &Vector, v: &Vector, h: f64) -> Result<Vec<Node>, SolveError> {
        let node = |(c, &weight): (&f64, &f64)| {
            let share = self.minus + c;
            let t = h * share;
            let bend = self.curves.bend(q, v, t)?;
            let (position, velocity) = (q + (v + &bend.position * t) * t, v + &bend.velocity * t);
            let gradient = self.system.gradient(&position, &velocity);
            Ok(Node { share, t, weight, bend, position, velocity, gradient })
        };
        self.quadrature.nodes.iter().zip(&self.quadrature.weights).map(node).collect()
    }

    /// Equations (3).
    fn at(&self, q: &Vector, v: &Vector, h: f64) -> Result<Ends, SolveError> {
        let n = q.len();
        let (minus, plus) = (self.minus, self.minus + 1.0);
        let nodes = self.nodes(q, v, h)?;
        let (mut l_q, mut l_v) = (Vector::zeros(n), Vector::zeros(n));
        for node in &nodes {
            let (t, g, b) = (node.t, &node.gradient, &node.bend);
            l_q += (&g.q + (b.position_q.tr_mul(&g.q) * t + b.velocity_q.tr_mul(&g.v)) * t) * node.weight;
            l_v += (&g.v + (&g.q + b.position_v.tr_mul(&g.q) * t + b.velocity_v.tr_mul(&g.v)) * t) * node.weight;
        }
        let (t0, t1) = (h * minus, h * plus);
        let (first, last) = (self.curves.bend(q, v, t0)?, self.curves.bend(q, v, t1)?);
        let identity = Matrix::identity(n, n);
        let end_by_q = (&identity + &first.position_q * (t0 * t0)).transpose();
        let end_by_v = (&identity + &first.position_v * t0).transpose();
        let both = (&last.position_q * (plus * plus) - &first.position_q * (minus * minus)).transpose();
        let through = |x: &Vector| -> Result<Vector, SolveError> {
            Ok(&end_by_v * solve_linear("ends of a curve", &end_by_q, x)?)
        };
        let carried = through(&l_q)?;
        let mut bending = (&last.position_v * (plus * plus) - &first.position_v * (minus * minus)).transpose();
        for (mut column, both) in bending.column_iter_mut().zip(both.column_iter()) {
            column.axpy(-h * minus, &through(&both.into_owned())?, 1.0);
        }
        let momentum = solve_linear("ends of a curve", &(&identity + &bending * h), &(l_v - &carried * (h * minus)))?;
        let rate = solve_linear("ends of a curve", &end_by_q, &(l_q - both * &momentum * h))?;
        let chords = [v + first.position * t0, v + last.position * t1];
        Ok(Ends { nodes, chords, carried, bending, plus: momentum, rate })
    }

    /// `(p+(z') - p+(z))/h` from (3): `(I + h B') dp+ = dg - dB p+`, each difference over `h`.
    fn momentum_quotient(
        &self,
        here: &Ends,
        there: &Ends,
        (w, a): (&Vector, &Vector),
        h: f64,
    ) -> Result<Vector, SolveError> {
        let n = w.len();
        let mut change = (&here.carried - &there.carried) * self.minus;
        for (old, new) in here.nodes.iter().zip(&there.nodes) {
            let (x, y, share) = (&old.bend, &new.bend, old.share);
            let chord = w + (a * h + (&y.position - &x.position) * old.t) * share;
            let turn = a + (&y.velocity - &x.velocity) * share;
            let quotient = self.mean_second_derivatives(old, new, &chord, &turn);
            // l_v holds (I + t eta_v)^T L_v + t (I + t xi_v)^T L_q
            let mut part = &quotient + y.velocity_v.tr_mul(&quotient) * old.t;
            part += (&y.velocity_v - &x.velocity_v).tr_mul(&old.gradient.v) * share;
            part += (&new.gradient.q - &old.gradient.q) * share;
            let bent = y.position_v.tr_mul(&new.gradient.q) - x.position_v.tr_mul(&old.gradient.q);
            part += bent * (old.t * share);
            change.axpy(old.weight, &part, 1.0);
        }
        change -= (&there.bending - &here.bending) * &here.plus;
        solve_linear("ends of a curve", &(Matrix::identity(n, n) + &there.bending * h), &change)
    }

    /// The change of `L_v` from one node to another over `h`, where position and velocity change by `h chord` and
    /// `h turn`.
    fn mean_second_derivatives(&self, from: &Node, to: &Node, chord: &Vector, turn: &Vector) -> Vector {
        let rule = Quadrature::gauss(MEAN_NODES);
        let mut sum = Vector::zeros(chord.len());
        for (s, weight) in rule.nodes.iter().zip(&rule.weights) {
            let between = |x: &Vector, y: &Vector| x + (y - x) * *s;
            let second =
                self.system.hessian(&between(&from.position, &to.position), &between(&from.velocity, &to.velocity));
            sum += (second.qv.tr_mul(chord) + second.vv * turn) * *weight;
        }
        sum
    }
}

/// Accelerations from one step, solved in three ways.
#[derive(Clone, Copy, Debug)]
pub struct SmallStep {
    /// s
    pub h: f64,
    /// Error of `A` of the blown-up midpoint rule against the acceleration in the middle of the step.
    pub blown_up: f64,
    /// The same for osculating parabolas about their middle with two Gauss points.
    pub curved: f64,
    /// Error of `(q2 - 2 q1 + q0)/h^2` of the position form of the midpoint rule.
    pub position_form: f64,
}

/// The blown-up principle in figures: one step for each `h`.
///
/// # Errors
/// [`SolveError`] where a step has no solution.
pub fn small_steps(problem: &Problem, steps: &[f64]) -> Result<Vec<SmallStep>, SolveError> {
    let system = problem.system.as_ref();
    let (q, v) = (&problem.q, &problem.v);
    let straight = Discretisation::straight(system, 0.5);
    let parabolas = Osculating(problem.system.clone());
    let curved = Discretisation { system, curves: &parabolas, minus: -0.5, quadrature: Quadrature::gauss(2) };
    let middle = |h: f64, w: &Vector, a: &Vector| system.acceleration(&(q + w * (0.5 * h)), &(v + a * (0.5 * h)));
    let ld = alpha(problem.system.clone(), 0.5);
    steps
        .iter()
        .map(|&h| {
            let error = |of: &Discretisation| -> Result<(f64, Vector), SolveError> {
                let (w, a) = of.step(q, v, h)?;
                let exact = middle(h, &w, &a)?;
                Ok(((a - &exact).norm(), exact))
            };
            let (blown_up, exact) = error(&straight)?;
            let (q0, q1) = (q - v * (0.5 * h), q + v * (0.5 * h));
            let q2 = lagrangian_map(&ld, &q0, &q1, h)?;
            let second_difference = (&q2 - &q1 - (&q1 - &q0)) / (h * h);
            let position_form = (second_difference - exact).norm();
            Ok(SmallStep { h, blown_up, curved: error(&curved)?.0, position_form })
        })
        .collect()
}
