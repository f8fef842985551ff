//! Several discrete Lagrangians in a row as one.

use crate::discrete::force::Force;
use crate::discrete::lagrangian::{DiscreteLagrangian, DiscreteLegendre, Forced, Jet, Legendre, SharedLagrangian};
use crate::discrete::solve::{SolveError, newton, solve_columns};
use crate::discrete::{Matrix, Vector};

/// ```text
/// L_d(q0, q1, h) = ext over z_1 ... z_(s-1) of sum_i L_d^i(z_(i-1), z_i, g_i h),   z_0 = q0, z_s = q1     (MW 2.5.1)
/// ```
///
/// with weights `g_i` that sum to 1. Its discrete Hamiltonian map is the composition of those of the parts (MW theorem
/// 2.5.1).
pub struct Composition {
    /// `(g_i, L_d^i)` in the order of time.
    pub parts: Vec<(f64, SharedLagrangian)>,
}

impl Composition {
    /// One method with several weights.
    pub fn of(part: SharedLagrangian, weights: &[f64]) -> Composition {
        Composition { parts: weights.iter().map(|&g| (g, part.clone())).collect() }
    }

    /// Suzuki's five substeps, which take a self-adjoint method of order 2 to order 4: weight `1/(4 - 4^(1/3))` four
    /// times, the rest in the middle.
    pub fn suzuki4(part: SharedLagrangian) -> Composition {
        let g = 1.0 / (4.0 - 4f64.cbrt());
        Composition::of(part, &[g, g, 1.0 - 4.0 * g, g, g])
    }

    /// Seven substeps that take a self-adjoint method of order 2 to order 6 (Yoshida 1990, solution A, with the digits
    /// of GeometricIntegrators.jl).
    pub fn yoshida6(part: SharedLagrangian) -> Composition {
        #[allow(clippy::excessive_precision, reason = "digits as published")]
        let w = [
            0.784_513_610_477_557_263_819_497_63,
            0.235_573_213_359_358_133_684_793_18,
            -1.177_679_984_178_871_006_946_415_68,
        ];
        let middle = 1.0 - 2.0 * w.iter().sum::<f64>();
        Composition::of(part, &[w[0], w[1], w[2], middle, w[2], w[1], w[0]])
    }

    /// The points `z_0 ... z_s` for an `x` that stacks the inner ones.
    fn chain(&self, q0: &Vector, x: &Vector, q1: &Vector) -> Vec<Vector> {
        let n = q0.len();
        let inner = (1..self.parts.len()).map(|i| x.rows((i - 1) * n, n).into_owned());
        std::iter::once(q0.clone()).chain(inner).chain(std::iter::once(q1.clone())).collect()
    }

    /// Finds the inner points, at which the momenta of neighbouring parts agree, and returns the chain.
    fn solve<F>(&self, q0: &Vector, q1: &Vector, h: f64, legendre: F) -> Result<Vec<Vector>, SolveError>
    where
        F: Fn(usize, &Vector, &Vector, f64) -> Result<Legendre, SolveError>,
    {
        let (n, s) = (q0.len(), self.parts.len());
        if s == 0 {
            return Err(SolveError::Undefined { what: "a composition needs at least one part" });
        }
        let mut guess = Vector::zeros(n * (s - 1));
        let mut reached = 0.0;
        for i in 1..s {
            reached += self.parts[i - 1].0;
            guess.rows_mut((i - 1) * n, n).copy_from(&(q0 + (q1 - q0) * reached));
        }
        if s == 1 {
            return Ok(self.chain(q0, &guess, q1));
        }
        let x = newton("composition", guess, |x| {
            let links = self.links(&self.chain(q0, x, q1), h, &legendre)?;
            let residual = Vector::from_iterator(
                n * (s - 1),
                (1..s).flat_map(|i| (&links[i - 1].p1 - &links[i].p0).iter().copied().collect::<Vec<f64>>()),
            );
            Ok((residual, inner_jacobian(&links, n)))
        })?;
        Ok(self.chain(q0, &x, q1))
    }

    fn links<F>(&self, z: &[Vector], h: f64, legendre: &F) -> Result<Vec<Legendre>, SolveError>
    where
        F: Fn(usize, &Vector, &Vector, f64) -> Result<Legendre, SolveError>,
    {
        (0..self.parts.len()).map(|i| legendre(i, &z[i], &z[i + 1], self.parts[i].0 * h)).collect()
    }
}

/// Derivative of the jumps `p1_i - p0_(i+1)` with respect to the inner points.
fn inner_jacobian(links: &[Legendre], n: usize) -> Matrix {
    let inner = links.len() - 1;
    let mut jacobian = Matrix::zeros(inner * n, inner * n);
    for i in 0..inner {
        let mut put = |j: usize, block: Matrix| jacobian.view_mut((i * n, j * n), (n, n)).copy_from(&block);
        put(i, &links[i].p1_q1 - &links[i + 1].p0_q0);
        if i > 0 {
            put(i - 1, links[i].p1_q0.clone());
        }
        if i + 1 < inner {
            put(i + 1, -&links[i + 1].p0_q1);
        }
    }
    jacobian
}

/// Derivative of the inner points with respect to `(q0, q1)`.
fn response(links: &[Legendre], n: usize) -> Result<Matrix, SolveError> {
    let inner = links.len() - 1;
    let mut right = Matrix::zeros(inner * n, 2 * n);
    if inner > 0 {
        right.view_mut((0, 0), (n, n)).copy_from(&-&links[0].p1_q0);
        right.view_mut(((inner - 1) * n, n), (n, n)).copy_from(&links[inner].p0_q1);
    }
    solve_columns("composition", &inner_jacobian(links, n), &right)
}

/// The Legendre transforms of the whole, from those of its links.
fn total(links: &[Legendre], response: &Matrix, n: usize) -> Legendre {
    let inner = links.len() - 1;
    let (first, last) = (&links[0], &links[inner]);
    if inner == 0 {
        return first.clone();
    }
    let at_first = response.rows(0, n);
    let at_last = response.rows((inner - 1) * n, n);
    Legendre {
        p0: first.p0.clone(),
        p1: last.p1.clone(),
        p0_q0: &first.p0_q0 + &first.p0_q1 * at_first.columns(0, n),
        p0_q1: &first.p0_q1 * at_first.columns(n, n),
        p1_q0: &last.p1_q0 * at_last.columns(0, n),
        p1_q1: &last.p1_q1 + &last.p1_q0 * at_last.columns(n, n),
    }
}

impl DiscreteLagrangian for Composition {
    fn dim(&self) -> usize {
        self.parts.first().map_or(0, |(_, part)| part.dim())
    }

    fn jet(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Jet, SolveError> {
        let n = q0.len();
        let plain = |i: usize, a: &Vector, b: &Vector, h: f64| self.parts[i].1.legendre(a, b, h);
        let z = self.solve(q0, q1, h, plain)?;
        let links = self.links(&z, h, &plain)?;
        let total = total(&links, &response(&links, n)?, n);
        let mut value = 0.0;
        for (i, (g, part)) in self.parts.iter().enumerate() {
            value += part.value(&z[i], &z[i + 1], g * h)?;
        }
        Ok(Jet { value, d1: -total.p0, d2: total.p1, d11: -total.p0_q0, d12: -total.p0_q1, d22: total.p1_q1 })
    }

    fn forced(&self, force: &dyn Force, q0: &Vector, q1: &Vector, h: f64) -> Result<Forced, SolveError> {
        let n = q0.len();
        let with_force =
            |i: usize, a: &Vector, b: &Vector, h: f64| Ok(self.parts[i].1.forced(force, a, b, h)?.legendre);
        let z = self.solve(q0, q1, h, with_force)?;
        let links = self.links(&z, h, &with_force)?;
        let response = response(&links, n)?;
        // The virtual work of all parts when only the ends move.
        let mut work = Vector::zeros(2 * n);
        for (i, (g, part)) in self.parts.iter().enumerate() {
            let at = part.forced(force, &z[i], &z[i + 1], g * h)?;
            for (point, f) in [(i, at.minus), (i + 1, at.plus)] {
                match point {
                    0 => work.rows_mut(0, n).axpy(1.0, &f, 1.0),
                    end if end == self.parts.len() => work.rows_mut(n, n).axpy(1.0, &f, 1.0),
                    inner => work += response.rows((inner - 1) * n, n).transpose() * f,
                }
            }
        }
        let legendre = total(&links, &response, n);
        Ok(Forced { legendre, minus: work.rows(0, n).into_owned(), plus: work.rows(n, n).into_owned() })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::discrete::methods::alpha;
    use crate::discrete::problems::coupled_wells;

    #[test]
    fn weights_satisfy_their_order_conditions() {
        let part: SharedLagrangian = Arc::new(alpha(coupled_wells().system, 0.5));
        let power_sum = |c: &Composition, k: i32| c.parts.iter().map(|(w, _)| w.powi(k)).sum::<f64>();
        let (four, six) = (Composition::suzuki4(part.clone()), Composition::yoshida6(part));
        for (composition, powers) in [(&four, vec![3]), (&six, vec![3, 5])] {
            assert!((power_sum(composition, 1) - 1.0).abs() <= 4e-16);
            for power in powers {
                // measured 5.0e-16
                let sum = power_sum(composition, power).abs();
                assert!(sum <= 1.2e-15, "{power}: {sum:e}");
            }
        }
        assert!(power_sum(&four, 5).abs() > 1e-3);
    }
}
