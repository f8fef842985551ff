//! Discrete Lagrangians that are quadrature sums along a family of trajectories.
//!
//! Nearly every discrete Lagrangian of MW part 2 has one form. A trajectory is spanned by points `x_0 = q0`,
//! internal points `x_1 ... x_m`, and `x_(m+1) = q1`, and the action along it is
//!
//! ```text
//! S(x) = h sum_i w_i L(Q_i, V_i),     Q_i = sum_k A_ik x_k,     V_i = 1/h sum_k B_ik x_k ,
//! ```
//!
//! sometimes with a linear side condition `sum_k c_k x_k = 0` (multiplier `mu`). The discrete Lagrangian is the
//! stationary value of `S` over the internal points. So `D1 L_d = dS/dx_0` and `D2 L_d = dS/dx_(m+1)` there, and second
//! derivatives follow by the Schur complement of the internal block.
//!
//! A force enters by the Lagrange-d'Alembert principle: `dS/dx_k + h sum_i w_i A_ik f(Q_i, V_i)` takes the place of
//! `dS/dx_k` (MW 3.2 and 3.6).
//!
//! Interior nodes can be held on a constraint manifold, with one more multiplier each (MW 3.5.5 and 3.5.6).

use std::sync::Arc;

use super::constraint::Constraint;
use super::force::Force;
use super::lagrangian::{DiscreteLagrangian, Forced, Jet, Legendre};
use super::solve::{SolveError, newton, solve_columns};
use super::system::{Gradient, Hessian, SharedSystem};
use super::{Matrix, Vector};

/// What is evaluated at a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// `L(Q_i, V_i)`
    Lagrangian,
    /// `1/2 V_i^T M V_i`, for separable systems; forces do not act here.
    Kinetic,
    /// `-V(Q_i)`, for separable systems; only a force sees `V_i`.
    Potential,
}

impl Part {
    /// Whether a force acts at the node: it does virtual work with the potential.
    const fn takes_force(self) -> bool {
        match self {
            Part::Lagrangian | Part::Potential => true,
            Part::Kinetic => false,
        }
    }
}

/// A point at which the Lagrangian is evaluated; the rows have one entry for each `x_k`.
#[derive(Clone, Debug)]
pub struct Node {
    pub part: Part,
    /// `w_i`
    pub weight: f64,
    /// `A_i`
    pub position: Vec<f64>,
    /// `B_i`
    pub velocity: Vec<f64>,
}

/// The numbers that make a method: nodes, internal points and side condition.
#[derive(Clone, Debug)]
pub struct Stencil {
    pub nodes: Vec<Node>,
    /// For each internal point the weights of `q0` and `q1` in its first guess.
    pub internal: Vec<[f64; 2]>,
    /// `c`, one entry for each `x_k`.
    pub side_condition: Option<Vec<f64>>,
}

/// A stencil applied to a system.
#[derive(Clone)]
pub struct StencilLagrangian {
    pub system: SharedSystem,
    pub stencil: Stencil,
    /// A constraint on the nodes listed.
    pub constraint: Option<(Arc<dyn Constraint>, Vec<usize>)>,
}

/// Action, its gradient and Hessian over all unknowns, with the force added where there is one.
struct Assembled {
    value: f64,
    gradient: Vector,
    hessian: Matrix,
    /// The part of the gradient that the force adds.
    force: Vector,
}

impl StencilLagrangian {
    /// A stencil without constraints on its nodes.
    pub fn new(system: SharedSystem, stencil: Stencil) -> Self {
        StencilLagrangian { system, stencil, constraint: None }
    }

    /// Number of points `x_k`.
    fn points(&self) -> usize {
        self.stencil.internal.len() + 2
    }

    /// Multipliers: those of the side condition, then those of the constrained nodes.
    fn multipliers(&self) -> usize {
        let side = if self.stencil.side_condition.is_some() { self.system.dim() } else { 0 };
        side + self.constraint.as_ref().map_or(0, |(c, nodes)| c.count() * nodes.len())
    }

    fn unknowns(&self) -> usize {
        self.points() * self.system.dim() + self.multipliers()
    }

    /// Point `k` of the stacked unknowns.
    fn point(&self, x: &Vector, k: usize) -> Vector {
        let n = self.system.dim();
        x.rows(k * n, n).into_owned()
    }

    fn combine(&self, x: &Vector, row: &[f64]) -> Vector {
        let mut sum = Vector::zeros(self.system.dim());
        for (k, &a) in row.iter().enumerate() {
            if a != 0.0 {
                sum.axpy(a, &self.point(x, k), 1.0);
            }
        }
        sum
    }

    /// The part of the Lagrangian that a node takes, with its derivatives. What has no parts is taken whole.
    fn evaluate(&self, part: Part, q: &Vector, v: &Vector) -> (f64, Gradient, Hessian) {
        let n = self.system.dim();
        let (zero, none) = (Vector::zeros(n), Matrix::zeros(n, n));
        match (part, self.system.separable()) {
            (Part::Kinetic, Some(parts)) => {
                let p = parts.mass() * v;
                let value = 0.5 * v.dot(&p);
                (value, Gradient { q: zero, v: p }, Hessian { qq: none.clone(), qv: none, vv: parts.mass().clone() })
            }
            (Part::Potential, Some(parts)) => {
                let hessian = Hessian { qq: -parts.potential_hessian(q), qv: none.clone(), vv: none };
                (-parts.potential(q), Gradient { q: -parts.potential_gradient(q), v: zero }, hessian)
            }
            (Part::Lagrangian, _) | (Part::Kinetic | Part::Potential, None) => {
                (self.system.lagrangian(q, v), self.system.gradient(q, v), self.system.hessian(q, v))
            }
        }
    }

    fn assemble(&self, x: &Vector, h: f64, force: Option<&dyn Force>) -> Assembled {
        let (n, points) = (self.system.dim(), self.points());
        let mut all = Assembled {
            value: 0.0,
            gradient: Vector::zeros(self.unknowns()),
            hessian: Matrix::zeros(self.unknowns(), self.unknowns()),
            force: Vector::zeros(self.unknowns()),
        };
        for node in &self.stencil.nodes {
            let (q, v) = (self.combine(x, &node.position), self.combine(x, &node.velocity) / h);
            let hw = h * node.weight;
            let (value, first, second) = self.evaluate(node.part, &q, &v);
            let force = force.filter(|_| node.part.takes_force());
            let applied = force.map(|f| (f.value(&q, &v), f.jacobian(&q, &v)));
            all.value += hw * value;
            for k in 0..points {
                let (a_k, b_k) = (node.position[k], node.velocity[k] / h);
                let mut gradient = all.gradient.rows_mut(k * n, n);
                gradient.axpy(hw * a_k, &first.q, 1.0);
                gradient.axpy(hw * b_k, &first.v, 1.0);
                if let Some((f, _)) = &applied {
                    gradient.axpy(hw * a_k, f, 1.0);
                    all.force.rows_mut(k * n, n).axpy(hw * a_k, f, 1.0);
                }
                for l in 0..points {
                    let (a_l, b_l) = (node.position[l], node.velocity[l] / h);
                    let mut block = &second.qq * (hw * a_k * a_l) + &second.vv * (hw * b_k * b_l);
                    block += &second.qv * (hw * a_k * b_l) + second.qv.transpose() * (hw * b_k * a_l);
                    if let Some((_, (f_q, f_v))) = &applied {
                        block += f_q * (hw * a_k * a_l) + f_v * (hw * a_k * b_l);
                    }
                    let mut target = all.hessian.view_mut((k * n, l * n), (n, n));
                    target += block;
                }
            }
        }
        self.add_side_condition(x, &mut all);
        self.add_constraint(x, &mut all);
        all
    }

    /// Adds `mu . sum_k c_k x_k`.
    fn add_side_condition(&self, x: &Vector, all: &mut Assembled) {
        let Some(row) = &self.stencil.side_condition else { return };
        let (n, at) = (self.system.dim(), self.points() * self.system.dim());
        let mu = x.rows(at, n).into_owned();
        let residual = self.combine(x, row);
        all.value += mu.dot(&residual);
        all.gradient.rows_mut(at, n).copy_from(&residual);
        for (k, &c) in row.iter().enumerate() {
            all.gradient.rows_mut(k * n, n).axpy(c, &mu, 1.0);
            for i in 0..n {
                all.hessian[(k * n + i, at + i)] += c;
                all.hessian[(at + i, k * n + i)] += c;
            }
        }
    }

    /// Adds `Lambda_i . phi(Q_i)` for each constrained node.
    fn add_constraint(&self, x: &Vector, all: &mut Assembled) {
        let Some((constraint, nodes)) = &self.constraint else { return };
        let (n, m) = (self.system.dim(), constraint.count());
        let first = self.unknowns() - m * nodes.len();
        for (slot, &i) in nodes.iter().enumerate() {
            let at = first + slot * m;
            let row = &self.stencil.nodes[i].position;
            let q = self.combine(x, row);
            let lambda = x.rows(at, m).into_owned();
            let (phi, jacobian) = (constraint.residual(&q), constraint.jacobian(&q));
            let curvature = constraint.hessian(&q, &lambda);
            let push = jacobian.transpose() * &lambda;
            all.value += lambda.dot(&phi);
            all.gradient.rows_mut(at, m).copy_from(&phi);
            for (k, &a_k) in row.iter().enumerate() {
                all.gradient.rows_mut(k * n, n).axpy(a_k, &push, 1.0);
                let mut below = all.hessian.view_mut((at, k * n), (m, n));
                below += &jacobian * a_k;
                let mut beside = all.hessian.view_mut((k * n, at), (n, m));
                beside += jacobian.transpose() * a_k;
                for (l, &a_l) in row.iter().enumerate() {
                    let mut block = all.hessian.view_mut((k * n, l * n), (n, n));
                    block += &curvature * (a_k * a_l);
                }
            }
        }
    }

    /// First guess: internal points between `q0` and `q1`, the side condition's multiplier from the chord's momentum.
    fn guess(&self, q0: &Vector, q1: &Vector, h: f64) -> Vector {
        let n = self.system.dim();
        let mut x = Vector::zeros(self.unknowns());
        x.rows_mut(0, n).copy_from(q0);
        for (k, &[a, b]) in self.stencil.internal.iter().enumerate() {
            x.rows_mut((k + 1) * n, n).copy_from(&(q0 * a + q1 * b));
        }
        x.rows_mut((self.points() - 1) * n, n).copy_from(q1);
        if self.stencil.side_condition.is_some() {
            let chord = self.system.momentum(&((q0 + q1) * 0.5), &((q1 - q0) / h));
            x.rows_mut(self.points() * n, n).copy_from(&chord);
        }
        x
    }

    /// Index ranges of all unknowns but the two ends.
    fn inner_indices(&self) -> Vec<usize> {
        let n = self.system.dim();
        let last = (self.points() - 1) * n;
        (n..last).chain(last + n..self.unknowns()).collect()
    }

    /// Makes the action stationary over the internal unknowns and returns it there.
    fn stationary(&self, q0: &Vector, q1: &Vector, h: f64, force: Option<&dyn Force>) -> Result<Assembled, SolveError> {
        let inner = self.inner_indices();
        let mut x = self.guess(q0, q1, h);
        if !inner.is_empty() {
            let guess = x.select_rows(&inner);
            let solution = newton("internal points", guess, |z| {
                scatter(&mut x, &inner, z);
                let all = self.assemble(&x, h, force);
                Ok((all.gradient.select_rows(&inner), all.hessian.select_rows(&inner).select_columns(&inner)))
            })?;
            scatter(&mut x, &inner, &solution);
        }
        Ok(self.assemble(&x, h, force))
    }

    /// Derivative of the internal unknowns with respect to the ends, `-H_zz^-1 H_ze`.
    fn response(&self, all: &Assembled, ends: &[usize]) -> Result<Matrix, SolveError> {
        let inner = self.inner_indices();
        let rows = all.hessian.select_rows(&inner);
        Ok(-solve_columns("internal points", &rows.select_columns(&inner), &rows.select_columns(ends))?)
    }

    fn ends(&self) -> Vec<usize> {
        let n = self.system.dim();
        let last = (self.points() - 1) * n;
        (0..n).chain(last..last + n).collect()
    }
}

fn scatter(x: &mut Vector, indices: &[usize], values: &Vector) {
    for (&i, &value) in indices.iter().zip(values.iter()) {
        x[i] = value;
    }
}

impl DiscreteLagrangian for StencilLagrangian {
    fn dim(&self) -> usize {
        self.system.dim()
    }

    fn jet(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Jet, SolveError> {
        let (n, ends) = (self.system.dim(), self.ends());
        let all = self.stationary(q0, q1, h, None)?;
        let total = self.total_second_derivative(&all, &ends)?;
        let last = ends[n];
        Ok(Jet {
            value: all.value,
            d1: all.gradient.rows(0, n).into_owned(),
            d2: all.gradient.rows(last, n).into_owned(),
            d11: total.view((0, 0), (n, n)).into_owned(),
            d12: total.view((0, n), (n, n)).into_owned(),
            d22: total.view((n, n), (n, n)).into_owned(),
        })
    }

    fn forced(&self, force: &dyn Force, q0: &Vector, q1: &Vector, h: f64) -> Result<Forced, SolveError> {
        let (n, ends) = (self.system.dim(), self.ends());
        let all = self.stationary(q0, q1, h, Some(force))?;
        let total = self.total_second_derivative(&all, &ends)?;
        let last = ends[n];
        // The force does work on the internal points too, when the ends move.
        let response = self.response(&all, &ends)?;
        let discrete =
            all.force.select_rows(&ends) + response.transpose() * all.force.select_rows(&self.inner_indices());
        Ok(Forced {
            legendre: Legendre {
                p0: -all.gradient.rows(0, n),
                p1: all.gradient.rows(last, n).into_owned(),
                p0_q0: -total.view((0, 0), (n, n)),
                p0_q1: -total.view((0, n), (n, n)),
                p1_q0: total.view((n, 0), (n, n)).into_owned(),
                p1_q1: total.view((n, n), (n, n)).into_owned(),
            },
            minus: discrete.rows(0, n).into_owned(),
            plus: discrete.rows(n, n).into_owned(),
        })
    }
}

impl StencilLagrangian {
    /// `H_ee - H_ez H_zz^-1 H_ze`
    fn total_second_derivative(&self, all: &Assembled, ends: &[usize]) -> Result<Matrix, SolveError> {
        let rows = all.hessian.select_rows(ends);
        let direct = rows.select_columns(ends);
        let through = rows.select_columns(&self.inner_indices()) * self.response(all, ends)?;
        Ok(direct + through)
    }
}
