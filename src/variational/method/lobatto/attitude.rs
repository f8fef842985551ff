//! The attitude of one body at the stages of a Lobatto step, for given torques.
//!
//! With `F_i = 1 + B_i` the attitudes at the stages in the body's frame at the start and `X_k = h^2` times the second
//! derivatives of the attitude matrix there,
//!
//! ```text
//! B_i = h c_i hat(Omega0) + sum_k (a ahat)_ik X_k ,     F_i^T F_i = 1 ,     i = 2 ... s
//! F_k^T Y_k - Y_k^T F_k = h^2 hat(tau_k) ,    Y_k = X_k Jd - h^2 N_k ,        k = 1 ... s-1
//! ```
//!
//! where `N_k = sum f r^T` over the forces `f` at points `r` of the body, whose moment follows the body's turn, and
//! `tau_k` are the other torques, in the body's frame at the stage. The multipliers of `F^T F = 1` are the symmetric
//! parts of `F_k^T Y_k`, so they do not appear. `9 (s - 1)` equations for as many unknowns, solved by Newton's method
//! with a factorisation that is kept while it contracts.

use nalgebra::{Matrix3, Vector3};

use super::tableau::{MOST_STAGES, Tableau};

/// Newton iterations after which a step is given up.
pub(super) const MOST_ITERATIONS: usize = 40;

type PerStage<T> = [T; MOST_STAGES];

/// Room for the solve, and the factorisation of the last one.
#[derive(Clone, Debug)]
pub(super) struct Attitude {
    /// `X_1 ... X_(s-1)`.
    pub x: PerStage<Matrix3<f64>>,
    /// `B_1 ... B_s`; the first is zero.
    pub turn: PerStage<Matrix3<f64>>,
    /// `1/2 tr(J) 1 - J`, kg m^2.
    jd: Vector3<f64>,
    size: usize,
    /// Row by row; after the elimination its factors.
    matrix: Vec<f64>,
    pivots: Vec<usize>,
    right: Vec<f64>,
    fresh: bool,
}

impl Attitude {
    /// `inertia` holds the principal moments, kg m^2.
    pub(super) fn new(inertia: &Vector3<f64>, stages: usize) -> Attitude {
        let size = 9 * (stages - 1);
        Attitude {
            x: [Matrix3::zeros(); MOST_STAGES],
            turn: [Matrix3::zeros(); MOST_STAGES],
            jd: inertia.map(|j| 0.5 * inertia.sum() - j),
            size,
            matrix: vec![0.0; size * size],
            pivots: vec![0; size],
            right: vec![0.0; size],
            fresh: false,
        }
    }

    pub(super) fn jd(&self) -> Matrix3<f64> {
        Matrix3::from_diagonal(&self.jd)
    }

    /// Starts from no acceleration.
    pub(super) fn forget(&mut self) {
        self.x = [Matrix3::zeros(); MOST_STAGES];
        self.fresh = false;
    }

    /// Starts from the polynomial through the accelerations of the last step of the same size.
    pub(super) fn predict(&mut self, t: &Tableau) {
        let last = t.stages - 1;
        let back = (Matrix3::identity() + self.turn[last]).transpose();
        let old = self.x.map(|x| back * x);
        for k in 0..last {
            self.x[k] = (0..last).map(|j| old[j] * t.ahead[k][j]).sum();
        }
        self.fresh = false;
    }

    /// Solves for `x` and `turn`. `omega` is `h Omega0` in the body's frame at the start, `forces[k]` are
    /// `h^2 tau_k` and `h^2 N_k`.
    ///
    /// # Errors
    /// The last change of an attitude (rad) where the iteration does not go down to roundoff.
    pub(super) fn solve(
        &mut self,
        t: &Tableau,
        omega: &Vector3<f64>,
        forces: &PerStage<(Vector3<f64>, Matrix3<f64>)>,
    ) -> Result<(), f64> {
        let mut last = f64::INFINITY;
        // Moments may cancel to much less than their parts.
        let noise = forces.iter().map(|(torque, virial)| torque.amax().max(virial.amax())).fold(0.0, f64::max)
            / (self.jd.sum() - self.jd.max());
        self.set_turns(t, omega);
        for _ in 0..MOST_ITERATIONS {
            if !self.fresh {
                self.linearise(t, forces);
                if !self.factorise() {
                    return Err(last);
                }
                self.fresh = true;
            }
            self.residual(t, forces);
            self.back_substitute();
            let mut update = 0.0_f64;
            for (k, x) in self.x.iter_mut().enumerate().take(t.stages - 1) {
                for (slot, change) in x.iter_mut().zip(&self.right[9 * k..]) {
                    *slot -= change;
                    update = update.max(change.abs());
                }
            }
            self.set_turns(t, omega);
            let size = self.x.iter().map(Matrix3::amax).fold(omega.amax().max(noise), f64::max);
            if !update.is_finite() {
                return Err(update);
            }
            if update <= 1e-13 * size && (update >= 0.3 * last || update <= 1e-17 * size) {
                return Ok(());
            }
            self.fresh = update <= 0.1 * last;
            last = update;
        }
        Err(last)
    }

    fn set_turns(&mut self, t: &Tableau, omega: &Vector3<f64>) {
        for i in 1..t.stages {
            self.turn[i] = omega.cross_matrix() * t.c[i];
            for k in 0..t.stages - 1 {
                self.turn[i] += self.x[k] * t.product[i][k];
            }
        }
    }

    /// The equations, left minus right side; those of the torque over the moments that they are about.
    fn residual(&mut self, t: &Tableau, forces: &PerStage<(Vector3<f64>, Matrix3<f64>)>) {
        let s = t.stages;
        for i in 1..s {
            let b = &self.turn[i];
            let strain = b + b.transpose() + b.tr_mul(b);
            for (row, (p, q)) in SYMMETRIC.into_iter().enumerate() {
                self.right[6 * (i - 1) + row] = strain[(p, q)];
            }
        }
        for k in 0..s - 1 {
            let f = Matrix3::identity() + self.turn[k];
            let (torque, virial) = &forces[k];
            let m = f.tr_mul(&(self.x[k] * self.jd() - virial));
            for (row, (p, q)) in SKEW.into_iter().enumerate() {
                let moment = m[(p, q)] - m[(q, p)] - torque[row];
                self.right[6 * (s - 1) + 3 * k + row] = moment / (self.jd[p] + self.jd[q]);
            }
        }
    }

    /// The derivative of [`Attitude::residual`] by the entries of `X_1, X_2, ...`, column by column of each.
    fn linearise(&mut self, t: &Tableau, forces: &PerStage<(Vector3<f64>, Matrix3<f64>)>) {
        let (s, n) = (t.stages, self.size);
        let unit = |a: usize, b: usize| if a == b { 1.0 } else { 0.0 };
        for (m, column, r) in (0..s - 1).flat_map(|m| (0..9).map(move |e| (m, e / 3, e % 3))) {
            let at = 9 * m + 3 * column + r;
            for i in 1..s {
                let f = Matrix3::identity() + self.turn[i];
                for (row, (p, q)) in SYMMETRIC.into_iter().enumerate() {
                    let strain = f[(r, p)] * unit(column, q) + f[(r, q)] * unit(column, p);
                    self.matrix[(6 * (i - 1) + row) * n + at] = t.product[i][m] * strain;
                }
            }
            for k in 0..s - 1 {
                let f = Matrix3::identity() + self.turn[k];
                let own = unit(k, m);
                for (row, (p, q)) in SKEW.into_iter().enumerate() {
                    let of_x = f[(r, p)] * unit(column, q) * self.jd[q] - f[(r, q)] * unit(column, p) * self.jd[p];
                    let y = |c: usize| self.x[k][(r, c)] * self.jd[c] - forces[k].1[(r, c)];
                    let of_f = unit(column, p) * y(q) - unit(column, q) * y(p);
                    let moment = own * of_x + t.product[k][m] * of_f;
                    self.matrix[(6 * (s - 1) + 3 * k + row) * n + at] = moment / (self.jd[p] + self.jd[q]);
                }
            }
        }
    }

    /// Gaussian elimination with partial pivoting; false where a pivot is zero or not a number.
    fn factorise(&mut self) -> bool {
        let (n, a) = (self.size, &mut self.matrix);
        for k in 0..n {
            let mut pivot = k;
            for row in k + 1..n {
                if a[row * n + k].abs() > a[pivot * n + k].abs() {
                    pivot = row;
                }
            }
            self.pivots[k] = pivot;
            if pivot != k {
                for column in 0..n {
                    a.swap(k * n + column, pivot * n + column);
                }
            }
            if !(a[k * n + k].abs() > 0.0) {
                return false;
            }
            let (upper, lower) = a.split_at_mut((k + 1) * n);
            let top = &upper[k * n..];
            for row in lower.chunks_exact_mut(n) {
                let factor = row[k] / top[k];
                row[k] = factor;
                for (slot, above) in row[k + 1..].iter_mut().zip(&top[k + 1..]) {
                    *slot -= factor * above;
                }
            }
        }
        true
    }

    /// Solves in place of the right-hand side.
    fn back_substitute(&mut self) {
        let (n, a, x) = (self.size, &self.matrix, &mut self.right);
        for k in 0..n {
            x.swap(k, self.pivots[k]);
        }
        for row in 0..n {
            x[row] -= (0..row).map(|k| a[row * n + k] * x[k]).sum::<f64>();
        }
        for row in (0..n).rev() {
            let rest: f64 = (row + 1..n).map(|k| a[row * n + k] * x[k]).sum();
            x[row] = (x[row] - rest) / a[row * n + row];
        }
    }
}

/// Entries of a symmetric matrix, and those of `v` in `hat(v)`.
const SYMMETRIC: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)];
const SKEW: [(usize, usize); 3] = [(2, 1), (0, 2), (1, 0)];
