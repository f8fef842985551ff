//! Compensated sums (Kahan 1965) of a vector.

/// A vector that takes in increments without losing their low bits.
#[derive(Clone, Debug)]
pub(in crate::reduced) struct Compensated {
    pub value: Vec<f64>,
    /// What has not been added yet: the increments collected and what the last addition left over.
    rest: Vec<f64>,
}

impl Compensated {
    pub(in crate::reduced) fn new(value: Vec<f64>) -> Compensated {
        Compensated { rest: vec![0.0; value.len()], value }
    }

    pub(in crate::reduced) fn copy_from(&mut self, other: &Compensated) {
        self.value.copy_from_slice(&other.value);
        self.rest.copy_from_slice(&other.rest);
    }

    /// Collects a part of the next increment.
    pub(in crate::reduced) fn collect(&mut self, part: &[f64]) {
        for (rest, part) in self.rest.iter_mut().zip(part) {
            *rest += part;
        }
    }

    /// Adds what has been collected.
    pub(in crate::reduced) fn advance(&mut self) {
        for (value, rest) in self.value.iter_mut().zip(&mut self.rest) {
            let sum = *value + *rest;
            *rest -= sum - *value;
            *value = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_small_increments_are_not_lost() {
        let mut sum = Compensated::new(vec![1.0]);
        for _ in 0..1_000_000 {
            sum.collect(&[4e-18]);
            sum.collect(&[6e-18]);
            sum.advance();
        }
        assert!((sum.value[0] - (1.0 + 1e-11)).abs() <= 2e-16, "{}", sum.value[0] - 1.0 - 1e-11);
    }
}
