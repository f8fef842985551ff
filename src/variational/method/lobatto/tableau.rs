//! Coefficients of the Lobatto IIIA-IIIB pairs of 2 to 5 stages (Hairer, Lubich and Wanner 2006, section II.1.4 and
//! VI.4.2).

use nalgebra::{DMatrix, SMatrix};

pub(super) const MOST_STAGES: usize = 5;

type Table = [[f64; MOST_STAGES]; MOST_STAGES];

/// The coefficients, in the first `stages` rows and columns.
#[derive(Clone, Debug)]
pub(super) struct Tableau {
    pub stages: usize,
    pub c: [f64; MOST_STAGES],
    pub b: [f64; MOST_STAGES],
    /// `a ahat`
    pub product: Table,
    /// Inverse of `(a ahat)_ik`, `i = 2 ... s`, `k = 1 ... s-1`: `inverse[k][i - 1]` from zero.
    pub inverse: Table,
    /// Value at `1 + c_k` of the polynomial through values at `c_1 ... c_(s-1)`, as weights of these values.
    pub ahead: Table,
}

impl Tableau {
    /// Two to five stages; other numbers are taken to the nearest.
    pub(super) fn new(stages: usize) -> Tableau {
        let s = stages.clamp(2, MOST_STAGES);
        let Pair { c, b, a, ahat } = Pair::new(s);
        let mut product = Table::default();
        for i in 0..s {
            for k in 0..s {
                product[i][k] = (0..s).map(|j| a[i][j] * ahat[j][k]).sum();
            }
        }
        let block = DMatrix::from_fn(s - 1, s - 1, |i, k| product[i + 1][k]);
        let (mut inverse, mut ahead) = (Table::default(), Table::default());
        if let Some(found) = block.try_inverse() {
            for k in 0..s - 1 {
                for i in 0..s - 1 {
                    inverse[k][i] = found[(k, i)];
                }
            }
        }
        for k in 0..s - 1 {
            for j in 0..s - 1 {
                ahead[k][j] = value(&lagrange(&c[..s - 1], j), 1.0 + c[k]);
            }
        }
        Tableau { stages: s, c, b, product, inverse, ahead }
    }
}

/// A pair of methods.
struct Pair {
    c: [f64; MOST_STAGES],
    b: [f64; MOST_STAGES],
    /// IIIA: `a_ij = int_0^c_i l_j`, with `l_j` the Lagrange polynomials of the nodes.
    a: Table,
    /// IIIB: `b_i ahat_ij + b_j a_ji = b_i b_j`, which makes the pair symplectic.
    ahat: Table,
}

impl Pair {
    fn new(s: usize) -> Pair {
        let c = nodes(s);
        let (mut b, mut a, mut ahat) = ([0.0; MOST_STAGES], Table::default(), Table::default());
        for j in 0..s {
            let l = lagrange(&c[..s], j);
            b[j] = integral(&l, 1.0);
            for i in 0..s {
                a[i][j] = integral(&l, c[i]);
            }
        }
        for i in 0..s {
            for j in 0..s {
                ahat[i][j] = b[j] * (1.0 - a[j][i] / b[i]);
            }
            // The last column is zero, which the formula meets to roundoff only.
            ahat[i][s - 1] = 0.0;
        }
        Pair { c, b, a, ahat }
    }
}

/// Nodes of the Lobatto quadrature on [0, 1].
fn nodes(s: usize) -> [f64; MOST_STAGES] {
    let (fifth, three) = (0.5 - 5.0_f64.sqrt() / 10.0, 0.5 - 21.0_f64.sqrt() / 14.0);
    match s {
        2 => [0.0, 1.0, 0.0, 0.0, 0.0],
        3 => [0.0, 0.5, 1.0, 0.0, 0.0],
        4 => [0.0, fifth, 1.0 - fifth, 1.0, 0.0],
        _ => [0.0, three, 0.5, 1.0 - three, 1.0],
    }
}

/// Coefficients, constant first.
type Polynomial = SMatrix<f64, MOST_STAGES, 1>;

/// The polynomial that is 1 at node `j` and 0 at the others.
fn lagrange(nodes: &[f64], j: usize) -> Polynomial {
    let mut l = Polynomial::zeros();
    l[0] = 1.0;
    for (_, node) in nodes.iter().enumerate().filter(|(k, _)| *k != j) {
        let mut times_x = Polynomial::zeros();
        for power in 1..MOST_STAGES {
            times_x[power] = l[power - 1];
        }
        l = (times_x - l * *node) / (nodes[j] - node);
    }
    l
}

fn value(l: &Polynomial, x: f64) -> f64 {
    l.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

/// `int_0^x l`
fn integral(l: &Polynomial, x: f64) -> f64 {
    l.iter().enumerate().rev().fold(0.0, |sum, (k, coefficient)| (sum + coefficient / (k + 1) as f64) * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `sum b c^(k-1) = 1/k` to order `2 s - 2` and not beyond, `sum_j a_ij c_j^(k-1) = c_i^k / k` for `k <= s`, and
    /// `sum_i b_i c_i^(k-1) ahat_ij = b_j (1 - c_j^k) / k` for `k <= s`.
    #[test]
    fn the_coefficients_meet_the_simplifying_conditions() {
        for s in 2..=MOST_STAGES {
            let t = Pair::new(s);
            let power = |x: f64, k: usize| x.powi(k as i32);
            let quadrature = |k: usize| (0..s).map(|i| t.b[i] * power(t.c[i], k - 1)).sum::<f64>() - 1.0 / k as f64;
            let worst = (1..=2 * s - 2).map(|k| quadrature(k).abs()).fold(0.0, f64::max);
            // measured 1.3e-15
            assert!(worst <= 3e-15, "{s}: {worst:e}");
            // 2.8e-5 with five stages, where it is least
            assert!(quadrature(2 * s - 1).abs() > 1e-5, "{s}");
            for k in 1..=s {
                for i in 0..s {
                    // measured at most 1.3e-15
                    let c: f64 = (0..s).map(|j| t.a[i][j] * power(t.c[j], k - 1)).sum();
                    assert!((c - power(t.c[i], k) / k as f64).abs() <= 4e-15, "{s} {k} {i}");
                    let d: f64 = (0..s).map(|j| t.b[j] * power(t.c[j], k - 1) * t.ahat[j][i]).sum();
                    assert!((d - t.b[i] * (1.0 - power(t.c[i], k)) / k as f64).abs() <= 4e-15, "{s} {k} {i}");
                }
            }
        }
    }

    #[test]
    fn the_inverse_is_one() {
        for s in 2..=MOST_STAGES {
            let t = Tableau::new(s);
            for i in 1..s {
                for m in 1..s {
                    let sum: f64 = (0..s - 1).map(|k| t.product[i][k] * t.inverse[k][m - 1]).sum();
                    let expected = if i == m { 1.0 } else { 0.0 };
                    // measured at most 6e-15
                    assert!((sum - expected).abs() <= 2e-14, "{s} {i} {m}: {sum}");
                }
            }
        }
    }
}
