//! The exact motion, to roundoff: the reference that everything else is measured against.
//!
//! Extrapolation of the modified midpoint rule (Gragg, Bulirsch and Stoer; HLW II.4) with a fixed high order. It shares
//! no code with the discrete Lagrangians.

use super::constraint::Constraint;
use super::force::Force;
use super::solve::{SolveError, solve_linear};
use super::system::LagrangianSystem;
use super::{Matrix, Vector};

/// Columns of the extrapolation table: order 2 x 9 in the substep.
const COLUMNS: usize = 9;

/// A point of a motion, with the action collected since its start.
#[derive(Clone, Debug)]
pub struct MotionPoint {
    pub q: Vector,
    pub v: Vector,
    /// integral of `L` dt, J s
    pub action: f64,
}

/// A Lagrangian system with the force and the constraint that act on it.
#[derive(Clone, Copy)]
pub struct Motion<'a> {
    pub system: &'a dyn LagrangianSystem,
    pub force: Option<&'a dyn Force>,
    pub constraint: Option<&'a dyn Constraint>,
}

impl<'a> Motion<'a> {
    /// Free motion.
    pub fn of(system: &'a dyn LagrangianSystem) -> Self {
        Motion { system, force: None, constraint: None }
    }

    /// Acceleration: `L_vv a = L_q - L_vq v + f + G^T lambda` with `G a = -phi''(v, v)` (MW 1.2, 3.1, 3.3).
    ///
    /// # Errors
    /// [`SolveError`] where the mass matrix is singular or constraints depend on each other.
    pub fn acceleration(&self, q: &Vector, v: &Vector) -> Result<Vector, SolveError> {
        let n = q.len();
        let hessian = self.system.hessian(q, v);
        let mut right = self.system.gradient(q, v).q - hessian.qv.transpose() * v;
        if let Some(force) = self.force {
            right += force.value(q, v);
        }
        let Some(constraint) = self.constraint else { return solve_linear("motion", &hessian.vv, &right) };
        let m = constraint.count();
        let jacobian = constraint.jacobian(q);
        let mut matrix = Matrix::zeros(n + m, n + m);
        matrix.view_mut((0, 0), (n, n)).copy_from(&hessian.vv);
        matrix.view_mut((0, n), (n, m)).copy_from(&-jacobian.transpose());
        matrix.view_mut((n, 0), (m, n)).copy_from(&jacobian);
        let mut stacked = right.resize_vertically(n + m, 0.0);
        for k in 0..m {
            let unit = Vector::from_fn(m, |i, _| if i == k { 1.0 } else { 0.0 });
            stacked[n + k] = -v.dot(&(constraint.hessian(q, &unit) * v));
        }
        Ok(solve_linear("motion", &matrix, &stacked)?.rows(0, n).into_owned())
    }

    /// `(v, a, L)` at `y = (q, v, S)`.
    fn rate(&self, y: &Vector) -> Result<Vector, SolveError> {
        let n = (y.len() - 1) / 2;
        let (q, v) = (y.rows(0, n).into_owned(), y.rows(n, n).into_owned());
        let mut rate = Vector::zeros(y.len());
        rate.rows_mut(0, n).copy_from(&v);
        rate.rows_mut(n, n).copy_from(&self.acceleration(&q, &v)?);
        rate[2 * n] = self.system.lagrangian(&q, &v);
        Ok(rate)
    }

    /// Modified midpoint rule with Gragg's smoothing: the increment of `y` over `h` in `steps` (even) steps.
    fn midpoint(&self, y: &Vector, h: f64, steps: usize) -> Result<Vector, SolveError> {
        let dt = h / steps as f64;
        let rate = self.rate(y)?;
        let mut before = Vector::zeros(y.len());
        let mut now = rate * dt;
        for _ in 1..steps {
            let next = &before + self.rate(&(y + &now))? * (2.0 * dt);
            before = now;
            now = next;
        }
        let beyond = &before + self.rate(&(y + &now))? * (2.0 * dt);
        // now is y_n, before is y_(n-1), beyond is y_(n+1)
        Ok((before + now * 2.0 + beyond) * 0.25)
    }

    /// The motion from `(q, v)` after time `t` (which may be negative), in substeps of at most `longest`.
    ///
    /// # Errors
    /// [`SolveError`] where the mass matrix is singular.
    pub fn flow(&self, q: &Vector, v: &Vector, t: f64, longest: f64) -> Result<MotionPoint, SolveError> {
        let n = q.len();
        let substeps = (t.abs() / longest).ceil().max(1.0) as usize;
        let h = t / substeps as f64;
        let mut y = Vector::zeros(2 * n + 1);
        y.rows_mut(0, n).copy_from(q);
        y.rows_mut(n, n).copy_from(v);
        for _ in 0..substeps {
            let mut row: Vec<Vector> = Vec::new();
            for j in 0..COLUMNS {
                let steps = |j: usize| (2 * (j + 1)) as f64;
                let mut next = vec![self.midpoint(&y, h, 2 * (j + 1))?];
                // Aitken-Neville in the squares of the step numbers.
                for k in 1..=j {
                    let ratio = (steps(j) / steps(j - k)).powi(2);
                    next.push(&next[k - 1] + (&next[k - 1] - &row[k - 1]) / (ratio - 1.0));
                }
                row = next;
            }
            y += &row[COLUMNS - 1];
        }
        Ok(MotionPoint { q: y.rows(0, n).into_owned(), v: y.rows(n, n).into_owned(), action: y[2 * n] })
    }
}
