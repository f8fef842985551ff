//! Gauss-Legendre collocation in a form that roundoff leaves symplectic.
//!
//! With the nodes `c`, weights `b` and the Runge-Kutta matrix `a` write `a_ij = mu_ij b_j`. A Runge-Kutta method is
//! symplectic where `b_i a_ij + b_j a_ji = b_i b_j` (Sanz-Serna 1988), that is `mu_ij + mu_ji = 1`. Here that holds
//! exactly in floating point, so that the rounding of the coefficients perturbs the method within the symplectic ones
//! and gives no drift (Hairer, McLachlan and Razakarivony 2008; the form with `mu` is that of Antonana, Makazaga and
//! Murua 2017).

/// A method with `s` stages, order `2 s`.
#[derive(Clone, Debug)]
pub(super) struct Gauss {
    pub nodes: Vec<f64>,
    pub weights: Vec<f64>,
    /// `mu_ij`, row by row.
    pub mu: Vec<f64>,
}

impl Gauss {
    /// On the orthonormal Legendre polynomials `p_k` of [0, 1], `mu_ij = sum_k p_k(c_j) int_0^c_i p_k` for `k < s`.
    pub(super) fn new(s: usize) -> Gauss {
        let nodes: Vec<f64> = (0..s).map(|i| node(s, i)).collect();
        let weights: Vec<f64> = nodes.iter().map(|&c| weight(s, c)).collect();
        let mut mu = vec![0.5; s * s];
        for i in 0..s {
            for j in 0..i {
                // The larger of the two is rounded; 1 minus it is exact.
                let below = coupling(s, nodes[i], nodes[j]);
                let (large, small) =
                    if below >= 0.5 { (below, 1.0 - below) } else { (1.0 - (1.0 - below), 1.0 - below) };
                (mu[i * s + j], mu[j * s + i]) = (large, small);
            }
        }
        Gauss { nodes, weights, mu }
    }

    pub(super) fn stages(&self) -> usize {
        self.nodes.len()
    }
}

/// Legendre polynomials `P_0 ... P_(s+1)` at `x` in [-1, 1].
fn legendre(s: usize, x: f64) -> Vec<f64> {
    let mut p = vec![1.0, x];
    for k in 1..=s {
        let k_f = k as f64;
        p.push(((2.0 * k_f + 1.0) * x * p[k] - k_f * p[k - 1]) / (k_f + 1.0));
    }
    p
}

fn derivative(s: usize, x: f64) -> f64 {
    let p = legendre(s, x);
    s as f64 * (p[s - 1] - x * p[s]) / (1.0 - x * x)
}

/// Zero `i` of `P_s(2 c - 1)` by Newton's method, mirror images made exact.
fn node(s: usize, i: usize) -> f64 {
    if 2 * i + 1 == s {
        return 0.5;
    }
    if 2 * i + 1 > s {
        return 1.0 - node(s, s - 1 - i);
    }
    let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (s as f64 + 0.5)).cos();
    for _ in 0..20 {
        x -= legendre(s, x)[s] / derivative(s, x);
    }
    0.5 * (1.0 + x)
}

fn weight(s: usize, c: f64) -> f64 {
    let x = 2.0 * c - 1.0;
    1.0 / ((1.0 - x * x) * derivative(s, x).powi(2))
}

/// `a_ij / b_j` for the nodes `c_i` and `c_j`.
fn coupling(s: usize, ci: f64, cj: f64) -> f64 {
    let (at, of) = (legendre(s, 2.0 * ci - 1.0), legendre(s, 2.0 * cj - 1.0));
    // int_0^c P_k(2 x - 1) dx = (P_(k+1) - P_(k-1)) / (2 (2 k + 1)); the squared norm of P_k is 1 / (2 k + 1).
    ci + (1..s).map(|k| 0.5 * of[k] * (at[k + 1] - at[k - 1])).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_methods_are_symplectic_in_floating_point() {
        for s in 2..=8 {
            let gauss = Gauss::new(s);
            for i in 0..s {
                for j in 0..s {
                    assert_eq!(gauss.mu[i * s + j] + gauss.mu[j * s + i], 1.0, "{s} {i} {j}");
                }
            }
        }
    }

    /// `sum_j a_ij c_j^(k-1) = c_i^k / k` and `sum_j b_j c_j^(k-1) = 1/k`.
    #[test]
    fn the_methods_satisfy_their_order_conditions() {
        for s in 2..=8 {
            let gauss = Gauss::new(s);
            let mut worst = 0.0f64;
            for k in 1..=s {
                for i in 0..s {
                    let sum: f64 = (0..s)
                        .map(|j| gauss.mu[i * s + j] * gauss.weights[j] * gauss.nodes[j].powi(k as i32 - 1))
                        .sum();
                    worst = worst.max((sum - gauss.nodes[i].powi(k as i32) / k as f64).abs());
                }
            }
            for k in 1..=2 * s {
                let sum: f64 = (0..s).map(|j| gauss.weights[j] * gauss.nodes[j].powi(k as i32 - 1)).sum();
                worst = worst.max((sum - 1.0 / k as f64).abs());
            }
            println!("{s} {worst:.1e}");
            // measured at most 3.3e-16
            assert!(worst <= 1e-15, "{s}: {worst:e}");
        }
    }
}
