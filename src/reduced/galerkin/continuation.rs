//! Where the rounds do not converge: the stages of the whole step by continuation from those of a part of it.
//!
//! The unknowns are the velocities of all stages; their positions and momenta follow from equations (1) and (2) of
//! [`super`], and what (3) lacks is taken away by Newton's method. Its linear systems are solved by GMRES, with
//! differences in the place of derivatives, preconditioned by the mass matrices of the stages.

use super::batch::{Batch, everywhere};
use super::integrator::{Galerkin, NEGLIGIBLE, ROUNDOFF};
use super::newton::Newton;
use crate::reduced::number::real::Lanes;

/// Solutions by Newton's method at parts of the step before it is given up.
const MOST_PARTS: usize = 40;
const MOST_NEWTON_STEPS: usize = 12;
/// Correction that is small enough at a part of the step: the solution only starts the next.
const ENOUGH_FOR_A_PART: f64 = 1e-4;
/// Part of a Newton step that may be missing from its linear system.
const LINEAR: f64 = 1e-4;
/// Velocities of differences, in units of those that hold the scene's energy.
const DIFFERENCE: f64 = 1e-7;
/// Rounds that settle the quaternions at given velocities.
const SETTLING: usize = 60;

impl Batch {
    /// `u`, moved by `size` along a direction if there is one, for the stages.
    fn set_velocities(&mut self, u: &[f64], moved: Option<(&[f64], f64)>) {
        let width = self.u.len();
        for k in 0..width {
            self.u[k] = Lanes::from_fn(|lane| {
                let at = self.stage(lane) * width + k;
                u[at] + moved.map_or(0.0, |(direction, size)| size * direction[at])
            });
        }
    }

    /// Hands out what [`Self::lack`] found.
    fn hand_out_lack(&self, correction: &mut [f64], lacking: &mut [f64]) {
        for (from, to) in [(&self.right, correction), (&self.m, lacking)] {
            for (k, numbers) in from.iter().enumerate() {
                for (lane, x) in numbers.numbers().into_iter().enumerate().take(self.count) {
                    to[(self.first + lane) * from.len() + k] = x;
                }
            }
        }
    }
}

impl Galerkin {
    /// The stages by continuation from those of a part of the step: `None` where that comes to a halt.
    pub(super) fn continue_stages(&mut self) -> Option<()> {
        let width = self.u.len();
        self.newton.reached.chunks_exact_mut(width).for_each(|u| u.copy_from_slice(&self.u));
        let (mut reached, mut further) = (0.0, 0.25);
        for _ in 0..MOST_PARTS {
            let part = if reached + further < 1.0 { reached + further } else { 1.0 };
            self.stretch(part);
            // Velocities change in proportion to time, as far as is known.
            let ratio = if reached > 0.0 { part / reached } else { 1.0 };
            let Newton { u, reached: from, .. } = &mut self.newton;
            for (u, from) in u.chunks_exact_mut(width).zip(from.chunks_exact(width)) {
                for ((u, from), start) in u.iter_mut().zip(from).zip(&self.u) {
                    *u = start + (from - start) * ratio;
                }
            }
            if self.newton_steps(if part < 1.0 { ENOUGH_FOR_A_PART } else { NEGLIGIBLE }).is_some() {
                if part == 1.0 {
                    return Some(());
                }
                self.newton.reached.copy_from_slice(&self.newton.u);
                (reached, further) = (part, 2.0 * further);
            } else {
                further *= 0.5;
            }
        }
        self.stretch(1.0);
        None
    }

    /// Stages for a part of the step, at its start.
    fn stretch(&mut self, part: f64) {
        let step = self.step * part;
        for batch in &mut self.batches {
            batch.h_b = Lanes::from_fn(|k| self.gauss.weights[batch.stage(k)] * step);
            batch.time = Lanes::from_fn(|k| self.taken as f64 * self.step + self.gauss.nodes[batch.stage(k)] * step);
            everywhere(&self.q.value, &mut batch.q);
            everywhere(&self.p.value, &mut batch.p);
        }
    }

    /// Newton's method from `newton.u`, until corrections are small enough or roundoff. `None` where they do not
    /// shrink.
    fn newton_steps(&mut self, enough: f64) -> Option<()> {
        let scale = self.over_scale.sqrt();
        let mut last = f64::INFINITY;
        for _ in 0..MOST_NEWTON_STEPS {
            self.settle(None);
            for batch in &mut self.batches {
                batch.point.factorise(&self.model)?;
            }
            self.lacks();
            let Newton { krylov, correction, lacking, first, first_lacking, .. } = &mut self.newton;
            first.copy_from_slice(correction);
            first_lacking.copy_from_slice(lacking);
            let size = krylov.begin(first, first_lacking);
            let relative = size * scale;
            if !relative.is_finite() {
                return None;
            }
            if relative <= enough || relative > 0.5 * last && relative < ROUNDOFF {
                return Some(());
            }
            if relative > last {
                return None;
            }
            last = relative;
            let epsilon = DIFFERENCE / scale;
            loop {
                self.settle(Some(epsilon));
                self.lacks();
                let Newton { krylov, correction, lacking, first, first_lacking, .. } = &mut self.newton;
                // What a direction takes off.
                let difference = |now: &mut [f64], first: &[f64]| {
                    now.iter_mut().zip(first).for_each(|(now, first)| *now = (first - *now) / epsilon);
                };
                difference(correction, first);
                difference(lacking, first_lacking);
                let (left, more) = krylov.extend(correction, lacking);
                if !more || left.is_nan() || left <= LINEAR * size {
                    break;
                }
            }
            self.newton.krylov.add_solution(&mut self.newton.u);
        }
        None
    }

    /// Positions, rates and momenta of the stages that follow from `newton.u`, moved by a size along the last
    /// direction.
    fn settle(&mut self, size: Option<f64>) {
        // An angle settles at once, lengths in the axes of a planar joint after it.
        let rounds = if self.model.positions > self.model.velocities { SETTLING } else { 2 };
        for batch in &mut self.batches {
            batch.set_velocities(&self.newton.u, size.map(|size| (self.newton.krylov.direction(), size)));
        }
        for _ in 0..rounds {
            for batch in &mut self.batches {
                batch.position_steps(&self.model, &mut self.q_rates);
            }
            for batch in &mut self.batches {
                self.q_rates.sum(self.q_rates.now(), &batch.mu, &self.q.value, &mut batch.q);
            }
        }
        for batch in &mut self.batches {
            batch.point.place(&self.model, &batch.q);
            batch.evaluate(&self.model);
        }
        for _ in 0..rounds {
            for batch in &mut self.batches {
                batch.momentum_steps(&self.model, &mut self.p_rates);
            }
            for batch in &mut self.batches {
                self.p_rates.sum(self.p_rates.now(), &batch.mu, &self.p.value, &mut batch.p);
            }
        }
    }

    /// What (3) lacks at all stages.
    fn lacks(&mut self) {
        for batch in &mut self.batches {
            batch.lack(&self.model);
            batch.hand_out_lack(&mut self.newton.correction, &mut self.newton.lacking);
        }
    }
}
