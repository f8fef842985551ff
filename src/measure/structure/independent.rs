//! Independent joint coordinates of a system whose joints depend on one another through loops and mimic joints.
//!
//! The rows `g(theta) = 0` of the loops and mimic joints leave some coordinates `u` free; the others follow by Newton's
//! method, and their rates by `thetadot = B(theta) udot` with `G B = 0`, `G = dg/dtheta`. With the kinetic energy
//! restricted to such rates the momenta are `p_u = B^T p`, and `(u, p_u)` are canonical on the constraint manifold
//! (Marsden and West 2001, section 3.4: the form there is the pullback of `dtheta ^ dp`).

use nalgebra::{DMatrix, DVector};

use super::failure::Failure;
use super::phase_chart::PhaseChart;
use crate::mechanics::{RANK, State};

/// Newton iterations that close the rows at most.
const ITERATIONS: usize = 20;

/// What the rows may be off by, m and rad.
const CLOSED: f64 = 1e-13;

/// Which joint coordinates are independent near one state.
#[derive(Clone, Debug)]
pub(super) struct Independent {
    /// All coordinates in the middle.
    centre: DVector<f64>,
    free: Vec<usize>,
    bound: Vec<usize>,
}

impl Independent {
    /// `None` for a tree, whose coordinates are all independent. Those are chosen to be free whose rates say most: what
    /// elimination with complete pivoting leaves over.
    ///
    /// # Errors
    /// Rows of a lower rank than at the system's start.
    pub(super) fn about(chart: &PhaseChart, state: &State) -> Result<Option<Independent>, Failure> {
        let parts = &chart.system().parts;
        if parts.loops.is_empty() && parts.couplings.is_empty() {
            return Ok(None);
        }
        let mut here = Independent { centre: chart.coordinates(state), free: Vec::new(), bound: Vec::new() };
        let mut rest = here.rows(chart, &here.centre);
        let largest = rest.amax();
        for _ in 0..chart.system().mobility.rank {
            let (row, column) = rest.map(f64::abs).iamax_full();
            if !(rest[(row, column)].abs() > RANK * largest) {
                return Err(Failure::Singular);
            }
            here.bound.push(column);
            let pivot = rest.row(row) / rest[(row, column)];
            let factors = rest.column(column).into_owned();
            rest -= factors * pivot;
        }
        here.free = (0..here.centre.len()).filter(|i| !here.bound.contains(i)).collect();
        Ok(Some(here))
    }

    /// `u` of all coordinates.
    pub(super) fn free(&self, theta: &DVector<f64>) -> DVector<f64> {
        theta.select_rows(&self.free)
    }

    /// `g(theta)`, m and rad; that of a mimic joint by the changes from the middle, so that turns do not matter.
    fn residual(&self, chart: &PhaseChart, theta: &DVector<f64>) -> DVector<f64> {
        self.values(chart, theta, &DVector::zeros(theta.len())).0
    }

    /// `g(theta)` and its rate.
    fn values(&self, chart: &PhaseChart, theta: &DVector<f64>, rate: &DVector<f64>) -> (DVector<f64>, DVector<f64>) {
        let parts = &chart.system().parts;
        let state = chart.state(theta, rate);
        let (mut value, mut speed): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        for closure in &parts.loops {
            let (position, velocity) = closure.residual(&state);
            value.extend(position);
            speed.extend(velocity);
        }
        let change = theta - &self.centre;
        for coupling in &parts.couplings {
            let (follower, source) = (chart.first(coupling.follower), chart.first(coupling.source));
            value.push(change[follower] - coupling.multiplier * change[source]);
            speed.push(rate[follower] - coupling.multiplier * rate[source]);
        }
        (DVector::from_vec(value), DVector::from_vec(speed))
    }

    /// `G`
    fn rows(&self, chart: &PhaseChart, theta: &DVector<f64>) -> DMatrix<f64> {
        let unit = |i: usize| DVector::from_fn(theta.len(), |k, _| if k == i { 1.0 } else { 0.0 });
        let columns: Vec<_> = (0..theta.len()).map(|i| self.values(chart, theta, &unit(i)).1).collect();
        DMatrix::from_columns(&columns)
    }

    /// All coordinates at given free ones.
    ///
    /// # Errors
    /// Free ones that the rows cannot be closed at.
    pub(super) fn close(&self, chart: &PhaseChart, u: &DVector<f64>) -> Result<DVector<f64>, Failure> {
        let mut theta = self.centre.clone();
        self.free.iter().zip(u.iter()).for_each(|(&i, u)| theta[i] = *u);
        let mut residual = self.residual(chart, &theta);
        for _ in 0..ITERATIONS {
            let change = solve(
                self.rows(chart, &theta).select_columns(&self.bound),
                &DMatrix::from_columns(&[residual.clone()]),
            )?;
            let mut next = theta.clone();
            self.bound.iter().zip(change.iter()).for_each(|(&i, change)| next[i] -= change);
            let after = self.residual(chart, &next);
            // Ends where roundoff does not let the rows come closer.
            if after.amax() >= residual.amax() && residual.amax() <= CLOSED {
                break;
            }
            (theta, residual) = (next, after);
        }
        if residual.amax() <= CLOSED { Ok(theta) } else { Err(Failure::Open) }
    }

    /// `B`
    ///
    /// # Errors
    /// Columns that have come to depend on one another.
    pub(super) fn rates(&self, chart: &PhaseChart, theta: &DVector<f64>) -> Result<DMatrix<f64>, Failure> {
        let rows = self.rows(chart, theta);
        let bound = solve(rows.select_columns(&self.bound), &rows.select_columns(&self.free))?;
        let mut all = DMatrix::zeros(theta.len(), self.free.len());
        self.bound.iter().enumerate().for_each(|(k, &i)| all.row_mut(i).copy_from(&-bound.row(k)));
        self.free.iter().enumerate().for_each(|(k, &i)| all[(i, k)] = 1.0);
        Ok(all)
    }
}

/// The least-squares solution for rows some of which may be redundant; the columns are independent.
fn solve(rows: DMatrix<f64>, right: &DMatrix<f64>) -> Result<DMatrix<f64>, Failure> {
    let factors = rows.qr();
    let solution = factors.r().solve_upper_triangular(&factors.q().tr_mul(right));
    solution.filter(|x| x.iter().all(|x| x.is_finite())).ok_or(Failure::Singular)
}
