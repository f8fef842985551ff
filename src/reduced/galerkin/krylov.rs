//! Solution of a linear system that is known by its action alone: GMRES (Saad and Schultz 1986).
//!
//! The matrix acts on velocities, and sizes are measured by the energy `1/2 u . m` of velocities `u` with the momenta
//! `m`. The momenta of each direction are kept beside it, so that a product of two directions needs no mass matrix.

/// Directions of the space that is searched.
const MOST: usize = 24;

/// An orthonormal basis of the space, and the matrix in it.
#[derive(Clone, Debug)]
pub(super) struct Krylov {
    width: usize,
    /// Directions that the matrix has acted on.
    known: usize,
    velocities: Vec<f64>,
    momenta: Vec<f64>,
    /// Columns of the matrix in the basis, made upper triangular by rotations `(c, s)`.
    columns: [[f64; MOST]; MOST],
    rotations: [(f64, f64); MOST],
    /// The right-hand side in the basis; its last entry is what the solution leaves.
    right: [f64; MOST + 1],
}

impl Krylov {
    pub(super) fn new(width: usize) -> Krylov {
        let basis = || vec![0.0; (MOST + 1) * width];
        Krylov {
            width,
            known: 0,
            velocities: basis(),
            momenta: basis(),
            columns: [[0.0; MOST]; MOST],
            rotations: [(1.0, 0.0); MOST],
            right: [0.0; MOST + 1],
        }
    }

    /// A new system with this right-hand side; returns its size.
    pub(super) fn begin(&mut self, velocities: &[f64], momenta: &[f64]) -> f64 {
        let size = dot(velocities, momenta).abs().sqrt();
        (self.known, self.right) = (0, [0.0; MOST + 1]);
        self.right[0] = size;
        self.store(0, velocities, momenta, size);
        size
    }

    /// The direction that the matrix is to act on next.
    pub(super) fn direction(&self) -> &[f64] {
        &self.velocities[self.known * self.width..(self.known + 1) * self.width]
    }

    /// Takes in what the matrix makes of the last direction. Returns what the best solution leaves, and whether there
    /// is room for more.
    pub(super) fn extend(&mut self, velocities: &mut [f64], momenta: &mut [f64]) -> (f64, bool) {
        let (k, n) = (self.known, self.width);
        let mut column = [0.0; MOST];
        for (j, entry) in column.iter_mut().enumerate().take(k + 1) {
            let (v, m) = (&self.velocities[j * n..(j + 1) * n], &self.momenta[j * n..(j + 1) * n]);
            *entry = dot(velocities, m);
            velocities.iter_mut().zip(v).for_each(|(x, v)| *x -= *entry * v);
            momenta.iter_mut().zip(m).for_each(|(x, m)| *x -= *entry * m);
        }
        let size = dot(velocities, momenta).abs().sqrt();
        for (j, (c, s)) in self.rotations.iter().enumerate().take(k) {
            (column[j], column[j + 1]) = (c * column[j] + s * column[j + 1], c * column[j + 1] - s * column[j]);
        }
        let whole = column[k].hypot(size);
        let (c, s) = if whole > 0.0 { (column[k] / whole, size / whole) } else { (1.0, 0.0) };
        column[k] = whole;
        (self.columns[k], self.rotations[k]) = (column, (c, s));
        (self.right[k], self.right[k + 1]) = (c * self.right[k], -s * self.right[k]);
        self.known += 1;
        self.store(self.known, velocities, momenta, size);
        (self.right[k + 1].abs(), self.known < MOST && size > 0.0)
    }

    /// Adds the best solution to `out`.
    pub(super) fn add_solution(&self, out: &mut [f64]) {
        let mut factors = [0.0; MOST];
        for j in (0..self.known).rev() {
            let known: f64 = (j + 1..self.known).map(|k| self.columns[k][j] * factors[k]).sum();
            let pivot = self.columns[j][j];
            factors[j] = if pivot == 0.0 { 0.0 } else { (self.right[j] - known) / pivot };
        }
        for (factor, direction) in factors.iter().zip(self.velocities.chunks_exact(self.width)).take(self.known) {
            out.iter_mut().zip(direction).for_each(|(out, v)| *out += factor * v);
        }
    }

    fn store(&mut self, k: usize, velocities: &[f64], momenta: &[f64], size: f64) {
        let over = if size > 0.0 { 1.0 / size } else { 0.0 };
        let place = k * self.width..(k + 1) * self.width;
        self.velocities[place.clone()].iter_mut().zip(velocities).for_each(|(to, x)| *to = x * over);
        self.momenta[place].iter_mut().zip(momenta).for_each(|(to, x)| *to = x * over);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix5, Vector5};

    #[test]
    fn a_system_is_solved_in_as_many_directions_as_it_has_unknowns() {
        let a = Matrix5::from_fn(|i, k| ((3 * i + 5 * k) as f64).sin() - if i == k { 1.0 + i as f64 } else { 0.0 });
        let mass = Matrix5::from_diagonal(&Vector5::new(1.0, 20.0, 3.0, 0.1, 5.0));
        let b = Vector5::new(0.3, -0.2, 1.0, 0.5, -0.7);
        let mut krylov = Krylov::new(5);
        krylov.begin(b.as_slice(), (mass * b).as_slice());
        for count in 1..=5 {
            let mut image = a * Vector5::from_column_slice(krylov.direction());
            let mut momenta = mass * image;
            let (left, _) = krylov.extend(image.as_mut_slice(), momenta.as_mut_slice());
            let mut x = Vector5::zeros();
            krylov.add_solution(x.as_mut_slice());
            let missed = b - a * x;
            let size = missed.dot(&(mass * missed)).sqrt();
            // measured 1.1e-15 at the end
            assert!((left - size).abs() <= 3e-15, "what is left is what was said: {left:e} {size:e}");
            assert_eq!(size <= 3e-15, count == 5, "{size:e} after {count}");
        }
    }
}
