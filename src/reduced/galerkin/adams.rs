//! Predictions of the stages of a collocation step by explicit Adams methods on its nodes.
//!
//! With the rates `f_k` at the `m` nodes `t_k` before a stage, on both sides of the start of the step at time 0, and
//! the polynomials `l_k` of degree `m - 1` that are 1 at one of these nodes and 0 at the others,
//!
//! ```text
//! y(c_i h) = y0 + sum_k f_k h int_0^c_i l_k(t) dt
//! ```
//!
//! (Adams-Bashforth on the nodes of the collocation; Hairer, Norsett and Wanner 1993, section III.5, for unequal
//! steps).

use super::gauss::Gauss;
use crate::reduced::number::real::{LANES, Lanes, Real};

/// `h b_j ydot_j` at the stages of this step and of the one before, in the order of time.
#[derive(Clone, Debug)]
pub(super) struct Rates {
    width: usize,
    stages: usize,
    all: Vec<f64>,
}

impl Rates {
    pub(super) fn new(stages: usize, width: usize) -> Rates {
        Rates { width, stages, all: vec![0.0; 2 * stages * width] }
    }

    /// Those of a stage of this step.
    #[inline(always)]
    pub(super) fn stage(&self, j: usize) -> &[f64] {
        &self.now()[j * self.width..(j + 1) * self.width]
    }

    #[inline(always)]
    pub(super) fn stage_mut(&mut self, j: usize) -> &mut [f64] {
        let first = (self.stages + j) * self.width;
        &mut self.all[first..first + self.width]
    }

    /// Those of this step.
    #[inline(always)]
    pub(super) fn now(&self) -> &[f64] {
        &self.all[self.stages * self.width..]
    }

    /// Those of the `count` stages before a stage of this step.
    #[inline(always)]
    pub(super) fn before(&self, stage: usize, count: usize) -> &[f64] {
        let end = self.stages + stage;
        &self.all[(end - count) * self.width..end * self.width]
    }

    /// This step becomes the one before.
    pub(super) fn turn_over(&mut self) {
        let (before, now) = self.all.split_at_mut(self.stages * self.width);
        before.copy_from_slice(now);
    }

    /// `start + sum_k weights_k rates_k`
    #[inline(always)]
    pub(super) fn sum(&self, rates: &[f64], weights: &[Lanes], start: &[f64], out: &mut [Lanes]) {
        // Four sums side by side do not wait for each other.
        let whole = out.len() / 4 * 4;
        for (block, (out, start)) in out.chunks_exact_mut(4).zip(start.chunks_exact(4)).enumerate() {
            let mut sums = [Lanes::of(0.0); 4];
            for (weight, rates) in weights.iter().zip(rates.chunks_exact(self.width)) {
                let rates = &rates[4 * block..4 * block + 4];
                (0..4).for_each(|k| sums[k] += *weight * Lanes::of(rates[k]));
            }
            (0..4).for_each(|k| out[k] = sums[k] + Lanes::of(start[k]));
        }
        for k in whole..out.len() {
            out[k] = self.weighted(rates, weights, k) + Lanes::of(start[k]);
        }
    }

    /// Component `k` of `sum_k weights_k rates_k`.
    #[inline(always)]
    fn weighted(&self, rates: &[f64], weights: &[Lanes], k: usize) -> Lanes {
        let mut sum = Lanes::of(0.0);
        for (weight, rates) in weights.iter().zip(rates.chunks_exact(self.width)) {
            sum += *weight * Lanes::of(rates[k]);
        }
        sum
    }
}

/// Weights of the predictions.
#[derive(Clone, Debug)]
pub(super) struct Adams {
    /// `mu_ij` of the stages of the first batch.
    first: Vec<Lanes>,
    choices: Vec<Choice>,
}

/// Weights of one order for each batch of stages.
#[derive(Clone, Debug)]
struct Choice {
    /// Number of nodes before a batch that count.
    order: usize,
    /// Of these nodes.
    explicit: Vec<Vec<Lanes>>,
    /// Of these nodes and those of the batch.
    implicit: Vec<Vec<Lanes>>,
}

impl Adams {
    pub(super) fn new(gauss: &Gauss) -> Adams {
        let s = gauss.stages();
        let nodes: Vec<f64> = gauss.nodes.iter().map(|c| c - 1.0).chain(gauss.nodes.iter().copied()).collect();
        let mut choices = Vec::new();
        for order in [1, 2, 3, 5, 8] {
            // Of the nodes before a stage, for a batch.
            let weights = |first: usize, before: usize, order: usize| -> Vec<Lanes> {
                let count = order.min(s + before);
                let times = &nodes[s + before - count..s + before];
                let of = |k: usize| {
                    let at = |lane: usize| gauss.nodes[(first + lane).min(s - 1)];
                    Lanes::from_fn(|lane| {
                        integral(gauss, times, k, at(lane)) / gauss.weights[(2 * s + before - count + k) % s]
                    })
                };
                (0..count).map(of).collect()
            };
            let batches = || (0..s).step_by(LANES);
            let end = |first: usize| (first + LANES).min(s);
            choices.push(Choice {
                order,
                explicit: batches().map(|first| weights(first, first, order)).collect(),
                implicit: batches().map(|first| weights(first, end(first), order + end(first) - first)).collect(),
            });
        }
        let first = (0..s).map(|j| Lanes::from_fn(|k| gauss.mu[k * s + j])).collect();
        Adams { first, choices }
    }

    /// Weights in the integrals up to the stages of a batch, of the rates at the nodes before the batch.
    pub(super) fn weights(&self, batch: usize, order: usize) -> &[Lanes] {
        self.choices.iter().find(|choice| choice.order == order).map_or(&[], |choice| &choice.explicit[batch])
    }

    /// The same with the rates of the batch among them.
    pub(super) fn implicit_weights(&self, batch: usize, order: usize) -> &[Lanes] {
        self.choices.iter().find(|choice| choice.order == order).map_or(&[], |choice| &choice.implicit[batch])
    }

    /// The order that would have predicted the first batch of the step best whose rates are known.
    pub(super) fn best_order(&self, rates: &Rates) -> usize {
        let mut best = (1, f64::INFINITY);
        for Choice { order, explicit: weights, .. } in &self.choices {
            let before = rates.before(0, weights[0].len());
            let mut error = 0.0;
            for k in 0..rates.width {
                let missed = rates.weighted(rates.now(), &self.first, k) - rates.weighted(before, &weights[0], k);
                error += missed.numbers().into_iter().map(|x| x * x).sum::<f64>();
            }
            if error < best.1 {
                best = (*order, error);
            }
        }
        best.0
    }
}

/// `int_0^end l_k` with the polynomial that is 1 at `times[k]` and 0 at the others.
fn integral(gauss: &Gauss, times: &[f64], k: usize, end: f64) -> f64 {
    let polynomial = |t: f64| {
        let others = times.iter().enumerate().filter(|(j, _)| *j != k);
        others.map(|(_, other)| (t - other) / (times[k] - other)).product::<f64>()
    };
    // Exact for the degrees at hand: 2 s - 1 and below.
    end * gauss.nodes.iter().zip(&gauss.weights).map(|(c, b)| b * polynomial(end * c)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rates `t^k` are integrated to `c^(k+1) / (k+1)` by every method of order `k + 1` and higher.
    #[test]
    fn a_method_integrates_the_polynomials_of_its_order() {
        for s in 2..=8 {
            let gauss = Gauss::new(s);
            let adams = Adams::new(&gauss);
            let mut worst = 0.0f64;
            for choice in &adams.choices {
                for (batch, first) in (0..s).step_by(LANES).enumerate() {
                    let end = (first + LANES).min(s);
                    for (weights, before) in [(&choice.explicit[batch], first), (&choice.implicit[batch], end)] {
                        for k in 0..weights.len() as i32 {
                            let mut rates = Rates::new(s, 1);
                            let at = |j: usize, back: f64| gauss.weights[j] * (gauss.nodes[j] - back).powi(k);
                            (0..s).for_each(|j| rates.stage_mut(j)[0] = at(j, 1.0));
                            rates.turn_over();
                            (0..s).for_each(|j| rates.stage_mut(j)[0] = at(j, 0.0));
                            let found = rates.weighted(rates.before(before, weights.len()), weights, 0).numbers();
                            for (lane, found) in found.into_iter().enumerate().take(end - first) {
                                let exact = gauss.nodes[first + lane].powi(k + 1) / f64::from(k + 1);
                                worst = worst.max((found - exact).abs());
                            }
                        }
                    }
                }
            }
            println!("{s} {worst:.1e}");
            // measured at most 6.4e-13: weights of high order are large and of both signs
            assert!(worst <= 1.5e-12, "{s}: {worst:e}");
        }
    }
}
