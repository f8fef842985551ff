//! Rank-revealing factorisation of small dense matrices: the complete orthogonal decomposition.
//!
//! Householder steps with column pivoting give `A P = Q [R; 0]`, rows of `R` that are zero to roundoff are dropped, and
//! Householder steps from the right turn what is left into a triangle (Golub and Van Loan, "Matrix Computations",
//! 5.4.7):
//!
//! ```text
//! A = Q [ T 0 ; 0 0 ] Z^T P^T ,     T upper triangular, rank x rank.
//! ```
//!
//! The solution of least norm follows from `T` alone. Nothing is allocated after [`Orthogonal::new`].

/// Room for the factors of a matrix with a given number of columns.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Orthogonal {
    rows: usize,
    columns: usize,
    rank: usize,
    /// Column-major. Below the diagonal the vectors of `Q`, right of column `rank` those of `Z`, in the triangle `T`.
    a: Vec<f64>,
    /// Factors of the reflections of `Q` and `Z`.
    q: Vec<f64>,
    z: Vec<f64>,
    /// Column `k` of `A P` is column `pivot[k]` of `A`.
    pivot: Vec<usize>,
    work: Vec<f64>,
}

impl Orthogonal {
    pub(in crate::variational) fn new(rows: usize, columns: usize) -> Orthogonal {
        Orthogonal {
            rows,
            columns,
            rank: 0,
            a: vec![0.0; rows * columns],
            q: vec![0.0; columns],
            z: vec![0.0; columns],
            pivot: (0..columns).collect(),
            work: vec![0.0; rows.max(columns)],
        }
    }

    /// The matrix to be factorised, column by column. All of it must be written before [`Orthogonal::factorise`].
    pub(in crate::variational) fn column_mut(&mut self, column: usize) -> &mut [f64] {
        &mut self.a[column * self.rows..(column + 1) * self.rows]
    }

    pub(in crate::variational) fn rank(&self) -> usize {
        self.rank
    }

    /// Factorises. A column counts as zero where what is left of it is shorter than `tolerance`.
    pub(in crate::variational) fn factorise(&mut self, tolerance: f64) {
        for (k, pivot) in self.pivot.iter_mut().enumerate() {
            *pivot = k;
        }
        self.rank = 0;
        for k in 0..self.rows.min(self.columns) {
            let (longest, square) = self.longest_column(k);
            if !(square.sqrt() > tolerance) {
                break;
            }
            self.swap_columns(k, longest);
            self.reflect_from_left(k);
            self.rank += 1;
        }
        if self.rank < self.columns {
            for k in (0..self.rank).rev() {
                self.reflect_from_right(k);
            }
        }
    }

    /// `x <- P Z [ T^-1 T^-T (Z^T P^T x)_rank ; 0 ]`: the solution of least norm of `A^T A y = x`.
    pub(in crate::variational) fn solve_normal(&mut self, x: &mut [f64]) {
        self.enter_row_space(x);
        for k in 0..self.rank {
            let sum: f64 = (0..k).map(|i| self.at(i, k) * self.work[i]).sum();
            self.work[k] = (self.work[k] - sum) / self.at(k, k);
        }
        self.solve_triangle();
        self.leave_row_space(x);
    }

    /// `x <- P Z [ T^-1 (Q^T x)_rank ; 0 ]`: the least-squares solution of least norm of `A y = x`, for a square
    /// matrix.
    pub(in crate::variational) fn solve(&mut self, x: &mut [f64]) {
        for k in 0..self.rank {
            let column = &self.a[k * self.rows..(k + 1) * self.rows];
            let along = x[k] + (k + 1..self.rows).map(|i| column[i] * x[i]).sum::<f64>();
            let along = along * self.q[k];
            x[k] -= along;
            for i in k + 1..self.rows {
                x[i] -= along * column[i];
            }
        }
        self.work[..self.rank].copy_from_slice(&x[..self.rank]);
        self.solve_triangle();
        self.leave_row_space(x);
    }

    /// Takes away what of `x` is orthogonal to all rows of the matrix.
    pub(in crate::variational) fn project_on_rows(&mut self, x: &mut [f64]) {
        if self.rank < self.columns {
            self.enter_row_space(x);
            self.leave_row_space(x);
        }
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        self.a[column * self.rows + row]
    }

    fn longest_column(&self, k: usize) -> (usize, f64) {
        let mut longest = (k, 0.0);
        for column in k..self.columns {
            let square: f64 = (k..self.rows).map(|i| self.at(i, column).powi(2)).sum();
            if square > longest.1 {
                longest = (column, square);
            }
        }
        longest
    }

    fn swap_columns(&mut self, i: usize, j: usize) {
        if i != j {
            let (left, right) = self.a.split_at_mut(j * self.rows);
            left[i * self.rows..(i + 1) * self.rows].swap_with_slice(&mut right[..self.rows]);
            self.pivot.swap(i, j);
        }
    }

    /// The reflection `1 - q v v^T`, `v_k = 1`, that clears column `k` below the diagonal.
    fn reflect_from_left(&mut self, k: usize) {
        let rows = self.rows;
        let (done, rest) = self.a.split_at_mut((k + 1) * rows);
        let column = &mut done[k * rows + k..];
        let norm = column.iter().map(|x| x * x).sum::<f64>().sqrt();
        let beta = -norm.copysign(column[0]);
        self.q[k] = (beta - column[0]) / beta;
        let scale = 1.0 / (column[0] - beta);
        column[1..].iter_mut().for_each(|x| *x *= scale);
        column[0] = beta;
        for other in rest.chunks_exact_mut(rows) {
            let other = &mut other[k..];
            let along = self.q[k] * (other[0] + column[1..].iter().zip(&other[1..]).map(|(v, x)| v * x).sum::<f64>());
            other[0] -= along;
            column[1..].iter().zip(&mut other[1..]).for_each(|(v, x)| *x -= along * v);
        }
    }

    /// The reflection that clears row `k` right of column `rank`, with `v_k = 1`.
    fn reflect_from_right(&mut self, k: usize) {
        let (rows, rank, columns) = (self.rows, self.rank, self.columns);
        let head = self.at(k, k);
        let tail: f64 = (rank..columns).map(|c| self.at(k, c).powi(2)).sum();
        if tail == 0.0 {
            self.z[k] = 0.0;
            return;
        }
        let beta = -(head * head + tail).sqrt().copysign(head);
        self.z[k] = (beta - head) / beta;
        let scale = 1.0 / (head - beta);
        for c in rank..columns {
            self.a[c * rows + k] *= scale;
        }
        self.a[k * rows + k] = beta;
        for i in 0..k {
            let tail: f64 = (rank..columns).map(|c| self.at(i, c) * self.at(k, c)).sum();
            let along = self.z[k] * (self.at(i, k) + tail);
            self.a[k * rows + i] -= along;
            for c in rank..columns {
                self.a[c * rows + i] -= along * self.a[c * rows + k];
            }
        }
    }

    /// `work <- T^-1 work` in the first `rank` entries.
    fn solve_triangle(&mut self) {
        for k in (0..self.rank).rev() {
            let sum: f64 = (k + 1..self.rank).map(|c| self.at(k, c) * self.work[c]).sum();
            self.work[k] = (self.work[k] - sum) / self.at(k, k);
        }
    }

    /// `work <- Z^T P^T x`
    fn enter_row_space(&mut self, x: &[f64]) {
        for (k, &pivot) in self.pivot.iter().enumerate() {
            self.work[k] = x[pivot];
        }
        if self.rank < self.columns {
            for k in (0..self.rank).rev() {
                self.reflect_work(k);
            }
        }
    }

    /// `x <- P Z [ work_rank ; 0 ]`
    fn leave_row_space(&mut self, x: &mut [f64]) {
        self.work[self.rank..self.columns].fill(0.0);
        if self.rank < self.columns {
            for k in 0..self.rank {
                self.reflect_work(k);
            }
        }
        for (k, &pivot) in self.pivot.iter().enumerate() {
            x[pivot] = self.work[k];
        }
    }

    fn reflect_work(&mut self, k: usize) {
        let tail: f64 = (self.rank..self.columns).map(|c| self.at(k, c) * self.work[c]).sum();
        let along = self.z[k] * (self.work[k] + tail);
        self.work[k] -= along;
        for c in self.rank..self.columns {
            self.work[c] -= along * self.at(k, c);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// A matrix of given shape and rank, entries of order 1.
    fn matrix(rows: usize, columns: usize, rank: usize) -> DMatrix<f64> {
        let wave = |seed: f64| move |r: usize, c: usize| (seed * (1.0 + r as f64) * (1.7 + c as f64)).sin();
        DMatrix::from_fn(rows, rank, wave(1.3)) * DMatrix::from_fn(rank, columns, wave(2.9))
    }

    fn factorised(a: &DMatrix<f64>) -> Orthogonal {
        let mut factors = Orthogonal::new(a.nrows(), a.ncols());
        for c in 0..a.ncols() {
            factors.column_mut(c).copy_from_slice(a.column(c).as_slice());
        }
        factors.factorise(1e-10);
        factors
    }

    #[test]
    fn solutions_are_those_of_the_pseudo_inverse() {
        for (rows, columns, rank) in [(5, 5, 5), (5, 5, 2), (7, 4, 4), (7, 4, 3), (3, 6, 3), (3, 6, 2), (4, 4, 1)] {
            let a = matrix(rows, columns, rank);
            let mut factors = factorised(&a);
            assert_eq!(factors.rank(), rank);
            let x = DVector::from_fn(columns, |i, _| (0.3 + i as f64).cos());
            let normal = (a.transpose() * &a).pseudo_inverse(1e-10).unwrap() * &x;
            let mut y = x.clone();
            factors.solve_normal(y.as_mut_slice());
            // measured 4.0e-13 of the solution, whose matrix has the square of the condition number of `a`
            assert!((&y - &normal).norm() <= 1e-12 * (1.0 + normal.norm()), "{}", (&y - &normal).norm());
            if rows == columns {
                let exact = a.clone().pseudo_inverse(1e-10).unwrap() * &x;
                let mut y = x.clone();
                factors.solve(y.as_mut_slice());
                assert!((&y - &exact).norm() <= 1e-13 * (1.0 + exact.norm()), "{}", (&y - &exact).norm());
            }
            let mut projected = x.clone();
            factors.project_on_rows(projected.as_mut_slice());
            let expected = a.clone().pseudo_inverse(1e-10).unwrap() * &a * &x;
            assert!((projected - expected).norm() <= 1e-13);
        }
    }

    #[test]
    fn a_zero_matrix_has_rank_zero() {
        let mut factors = factorised(&DMatrix::zeros(3, 2));
        let mut x = [1.0, 2.0];
        factors.solve_normal(&mut x);
        assert_eq!((factors.rank(), x), (0, [0.0, 0.0]));
    }
}
