//! Gauss-Legendre and Gauss-Lobatto quadrature on [0, 1], and interpolation at given nodes.

use super::Matrix;

/// Nodes and weights on [0, 1].
#[derive(Clone, Debug)]
pub struct Quadrature {
    pub nodes: Vec<f64>,
    pub weights: Vec<f64>,
    /// Polynomials of a lower degree than this are integrated exactly.
    pub order: usize,
}

/// Legendre polynomial `P_n` and its derivative at `x` in (-1, 1), by the three-term recursion.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut p) = (1.0, x);
    if n == 0 {
        return (1.0, 0.0);
    }
    for k in 1..n {
        let k = k as f64;
        let next = ((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0);
        before = p;
        p = next;
    }
    (p, n as f64 * (x * p - before) / (x * x - 1.0))
}

impl Quadrature {
    /// Gauss-Legendre with `s >= 1` nodes, order 2s.
    pub fn gauss(s: usize) -> Quadrature {
        let mut rule = Quadrature { nodes: vec![0.0; s], weights: vec![0.0; s], order: 2 * s };
        for i in 0..s {
            let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (s as f64 + 0.5)).cos();
            for _ in 0..50 {
                let (p, dp) = legendre(s, x);
                x -= p / dp;
            }
            let (_, dp) = legendre(s, x);
            rule.nodes[i] = 0.5 * (1.0 + x);
            rule.weights[i] = 1.0 / ((1.0 - x * x) * dp * dp);
        }
        rule
    }

    /// Gauss-Lobatto with `s >= 2` nodes, both ends among them, order 2s - 2.
    pub fn lobatto(s: usize) -> Quadrature {
        let n = s - 1;
        let mut rule = Quadrature { nodes: vec![0.0; s], weights: vec![0.0; s], order: 2 * s - 2 };
        for i in 0..s {
            let mut x = -(std::f64::consts::PI * i as f64 / n as f64).cos();
            if i > 0 && i < n {
                // Roots of P_n'; its derivative comes from (1 - x^2) P_n'' = 2 x P_n' - n (n + 1) P_n.
                for _ in 0..50 {
                    let (p, dp) = legendre(n, x);
                    let ddp = (2.0 * x * dp - (n * (n + 1)) as f64 * p) / (1.0 - x * x);
                    x -= dp / ddp;
                }
            }
            let (p, _) = if i == 0 || i == n { (1.0, 0.0) } else { legendre(n, x) };
            rule.nodes[i] = 0.5 * (1.0 + x);
            rule.weights[i] = 1.0 / ((n * (n + 1)) as f64 * p * p);
        }
        rule
    }
}

/// Cardinal polynomials of `nodes` at `t`: entry `k` is 1 at node `k` and 0 at the others. Values and derivatives.
pub(crate) fn cardinal(nodes: &[f64], t: f64) -> (Vec<f64>, Vec<f64>) {
    let mut values = Vec::with_capacity(nodes.len());
    let mut slopes = Vec::with_capacity(nodes.len());
    for (k, &c) in nodes.iter().enumerate() {
        let others = || nodes.iter().enumerate().filter(move |&(j, _)| j != k).map(|(j, &d)| (j, d));
        values.push(others().map(|(_, d)| (t - d) / (c - d)).product());
        slopes.push(
            others()
                .map(|(skip, e)| {
                    others().filter(|&(j, _)| j != skip).map(|(_, d)| (t - d) / (c - d)).product::<f64>() / (c - e)
                })
                .sum(),
        );
    }
    (values, slopes)
}

/// Collocation matrix `a_ij = integral from 0 to c_i of the cardinal polynomial of node j`.
pub fn collocation_matrix(nodes: &[f64]) -> Matrix {
    let s = nodes.len();
    let rule = Quadrature::gauss(s.div_ceil(2));
    Matrix::from_fn(s, s, |i, j| {
        let c = nodes[i];
        rule.nodes.iter().zip(&rule.weights).map(|(t, w)| w * c * cardinal(nodes, c * t).0[j]).sum()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integral(rule: &Quadrature, degree: i32) -> f64 {
        rule.nodes.iter().zip(&rule.weights).map(|(t, w)| w * t.powi(degree)).sum()
    }

    #[test]
    fn rules_integrate_all_degrees_below_their_order_and_not_the_next() {
        for rule in (1..9).map(Quadrature::gauss).chain((2..9).map(Quadrature::lobatto)) {
            for degree in 0..rule.order as i32 {
                // measured 3.3e-16
                assert!((integral(&rule, degree) - 1.0 / f64::from(degree + 1)).abs() <= 1e-15);
            }
            let next = rule.order as i32;
            assert!((integral(&rule, next) - 1.0 / f64::from(next + 1)).abs() > 1e-11);
        }
    }

    #[test]
    fn two_stage_gauss_has_the_coefficients_of_the_textbook() {
        let a = collocation_matrix(&Quadrature::gauss(2).nodes);
        let r = 3f64.sqrt() / 6.0;
        let known = Matrix::from_row_slice(2, 2, &[0.25, 0.25 - r, 0.25 + r, 0.25]);
        assert!((a - known).amax() <= 1e-15);
    }
}
