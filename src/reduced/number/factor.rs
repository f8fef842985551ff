//! Small symmetric positive definite systems.

use super::real::{Real, reciprocal};

/// `A = L D L^T` with a unit lower triangular `L`.
#[derive(Clone, Debug)]
pub(in crate::reduced) struct Factor<T: Real, const N: usize> {
    /// Below the diagonal `L`.
    l: [[T; N]; N],
    over_d: [T; N],
}

impl<T: Real, const N: usize> Factor<T, N> {
    pub(in crate::reduced) fn identity() -> Factor<T, N> {
        Factor { l: [[T::zero(); N]; N], over_d: [T::one(); N] }
    }

    /// Of the matrix with the given entries, of which those on and below the diagonal are asked for. `None` where it is
    /// not positive definite or not a number.
    pub(in crate::reduced) fn new(entry: impl Fn(usize, usize) -> T) -> Option<Factor<T, N>> {
        let mut factor = Factor::identity();
        let mut d = [T::zero(); N];
        for i in 0..N {
            for k in 0..=i {
                let mut rest = entry(i, k);
                for j in 0..k {
                    rest -= factor.l[i][j] * factor.l[k][j] * d[j];
                }
                if k < i {
                    factor.l[i][k] = rest * factor.over_d[k];
                } else {
                    (d[i], factor.over_d[i]) = (rest, reciprocal(rest)?);
                }
            }
        }
        Some(factor)
    }

    /// `A^-1 b`
    pub(in crate::reduced) fn solve(&self, mut b: [T; N]) -> [T; N] {
        for i in 0..N {
            for j in 0..i {
                let known = b[j];
                b[i] -= self.l[i][j] * known;
            }
        }
        for i in (0..N).rev() {
            b[i] *= self.over_d[i];
            for j in i + 1..N {
                let known = b[j];
                b[i] -= self.l[j][i] * known;
            }
        }
        b
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix6, Vector6};

    #[test]
    fn a_factor_solves_its_system_and_refuses_an_indefinite_one() {
        let a = Matrix6::from_fn(|i, k| ((i * k) as f64).sin());
        let b = Vector6::new(0.3, -0.2, 1.0, 0.5, -0.7, 0.1);
        let spd = a.transpose() * a + Matrix6::identity();
        let x = Factor::<f64, 6>::new(|i, k| spd[(i, k)]).expect("positive definite").solve(b.into());
        let x = Vector6::from(x);
        // measured 1.1e-16
        assert!((spd * x - b).amax() <= 3e-16, "{:e}", (spd * x - b).amax());
        let mut bad = spd;
        bad[(3, 3)] = -1.0;
        assert!(Factor::<f64, 6>::new(|i, k| bad[(i, k)]).is_none());
        bad[(3, 3)] = f64::NAN;
        assert!(Factor::<f64, 6>::new(|i, k| bad[(i, k)]).is_none());
    }
}
