//! The integrator: its step, and the rounds that find the stages.

use super::adams::{Adams, Rates};
use super::batch::{Batch, everywhere};
use super::failure::Failure;
use super::gauss::Gauss;
use super::newton::Newton;
use crate::mechanics::State;
use crate::numeric::{CompensatedVec, larger};
use crate::reduced::equations::hamiltonian::{LinkConstants, canonical, momentum_rates};
use crate::reduced::model::Model;
use crate::reduced::number::real::{LANES, Lanes};

/// Rounds before the stages are continued from shorter steps. Measured over 1 s: at 20 ms at most 16 (chains of 2 and
/// 10 links, `heavy_top`, `joint_zoo`), at 50 ms at most 50 where they converge at all.
pub(super) const MOST_ROUNDS: usize = 60;
/// Corrections of the velocities, in units of those that hold the scene's energy, that no longer count: a third of the
/// roundoff in a round. Over 2000 s of two spatial links (4 to 8 stages, 10 and 20 ms) the energy errors by 1.1e-13 to
/// 8.2e-13, with a tenth of it by 3.0e-13 to 6.2e-13.
pub(super) const NEGLIGIBLE: f64 = 3e-16;
/// Corrections that are larger show how fast the rounds converge; smaller ones have roundoff in them.
pub(super) const CLEAN: f64 = 3e-14;
/// Size below which a correction that does not shrink any more is roundoff.
pub(super) const ROUNDOFF: f64 = 1e-12;

/// The integrator at a fixed step.
#[derive(Clone, Debug)]
pub struct Galerkin {
    pub(super) model: Model,
    pub(super) gauss: Gauss,
    pub(super) adams: Adams,
    /// Nodes that the next prediction uses.
    pub(super) order: usize,
    /// s
    pub(super) step: f64,
    pub(super) taken: u64,
    pub(super) over_scale: f64,
    pub(super) q: CompensatedVec,
    pub(super) p: CompensatedVec,
    pub(super) u: Vec<f64>,
    pub(super) batches: Vec<Batch>,
    /// `h b_j qdot_j` and `h b_j pdot_j`, stage by stage: of this step and of the one before.
    pub(super) q_rates: Rates,
    pub(super) p_rates: Rates,
    pub(super) end: Batch,
    /// `q` and `p` at the start of a step, in case that its end has no velocities.
    pub(super) start: [CompensatedVec; 2],
    pub(super) newton: Newton,
    pub(super) rounds: u64,
}

impl Galerkin {
    /// `stages` from 2 to 8; `energy_scale` in J.
    ///
    /// # Errors
    /// A joint can move without moving any mass.
    pub fn new(model: Model, stages: usize, step: f64, energy_scale: f64) -> Result<Galerkin, Failure> {
        let gauss = Gauss::new(stages);
        let (q, u) = model.initial();
        let constants = LinkConstants::all(&model);
        let mut end = Batch::new(&model, &constants, &gauss, step, 0);
        everywhere(&q, &mut end.q);
        everywhere(&u, &mut end.u);
        end.point.place(&model, &end.q);
        end.evaluate(&model);
        end.point.factorise(&model).ok_or(Failure::Singular)?;
        canonical(&model, &end.q, &end.m, &mut end.p);
        let p: Vec<f64> = end.p.iter().map(|p| p.numbers()[0]).collect();
        // The first prediction knows the rates at the start alone.
        let (mut q_rates, mut p_rates) = (Rates::new(stages, q.len()), Rates::new(stages, q.len()));
        let mut batches: Vec<Batch> =
            (0..stages).step_by(LANES).map(|first| Batch::new(&model, &constants, &gauss, step, first)).collect();
        for batch in &mut batches {
            let Batch { q, p, u, force, .. } = &end;
            model.rates(q, u, &mut batch.rate);
            batch.hand_out(&batch.rate, &mut q_rates);
            momentum_rates(&model, q, p, u, force, &mut batch.rate);
            batch.hand_out(&batch.rate, &mut p_rates);
        }
        q_rates.turn_over();
        p_rates.turn_over();
        Ok(Galerkin {
            adams: Adams::new(&gauss),
            order: 1,
            step,
            taken: 0,
            over_scale: 1.0 / energy_scale,
            batches,
            start: [CompensatedVec::new(q.clone()), CompensatedVec::new(p.clone())],
            newton: Newton::new(stages * u.len()),
            q: CompensatedVec::new(q),
            p: CompensatedVec::new(p),
            u,
            q_rates,
            p_rates,
            end,
            gauss,
            model,
            rounds: 0,
        })
    }

    /// One step. After a failure nothing has changed.
    pub fn step(&mut self) -> Result<(), Failure> {
        self.find_stages()?;
        self.start[0].copy_from(&self.q);
        self.start[1].copy_from(&self.p);
        let (q_sum, p_sum) = (&mut self.q, &mut self.p);
        for j in 0..self.gauss.stages() {
            q_sum.collect(self.q_rates.stage(j));
            p_sum.collect(self.p_rates.stage(j));
        }
        q_sum.advance();
        p_sum.advance();
        everywhere(&self.q.value, &mut self.end.q);
        everywhere(&self.p.value, &mut self.end.p);
        if let Err(failure) = self.end.move_along(&self.model) {
            self.q.copy_from(&self.start[0]);
            self.p.copy_from(&self.start[1]);
            return Err(failure);
        }
        self.taken += 1;
        self.u.iter_mut().zip(&self.end.u).for_each(|(u, found)| *u = found.numbers()[0]);
        self.order = self.adams.best_order(&self.p_rates);
        self.q_rates.turn_over();
        self.p_rates.turn_over();
        Ok(())
    }

    fn find_stages(&mut self) -> Result<(), Failure> {
        let Err(mut failure) = self.solve_stages() else { return Ok(()) };
        // A violent moment spoils the extrapolation: start once more from the last rates alone.
        if self.order > 1 {
            self.order = 1;
            let Err(second) = self.solve_stages() else { return Ok(()) };
            failure = second;
        }
        self.continue_stages().ok_or(failure)
    }

    fn solve_stages(&mut self) -> Result<(), Failure> {
        self.predict()?;
        // What the last round has left to correct: measured while roundoff allows, then from the rate of convergence.
        let (mut last, mut left, mut rate) = (f64::INFINITY, f64::INFINITY, 1.0);
        for round in 1..=MOST_ROUNDS {
            let correction = self.correct();
            self.rounds += 1;
            if !correction.is_finite() {
                return Err(Failure::RanAway { rounds: round });
            }
            if correction > CLEAN {
                rate = if last.is_finite() { correction / last } else { 1.0 };
                left = correction;
            } else {
                rate = if rate < 1.0 { rate } else { correction / last };
                left = correction.min(left * rate);
            }
            if left * rate <= NEGLIGIBLE || correction >= last && correction < ROUNDOFF {
                return Ok(());
            }
            last = correction;
        }
        Err(Failure::NotConverged { rounds: MOST_ROUNDS, correction: last })
    }

    /// The stages one batch after the other, each from the rates at the nodes before it, with the mass matrix
    /// factorised there.
    fn predict(&mut self) -> Result<(), Failure> {
        for batch in &mut self.batches {
            let nodes = &self.gauss.nodes;
            batch.time = Lanes::from_fn(|k| (self.taken as f64 + nodes[batch.stage(k)]) * self.step);
            let weights = self.adams.weights(batch.first / LANES, self.order);
            self.q_rates.sum(self.q_rates.before(batch.first, weights.len()), weights, &self.q.value, &mut batch.q);
            self.p_rates.sum(self.p_rates.before(batch.first, weights.len()), weights, &self.p.value, &mut batch.p);
            batch.move_along(&self.model)?;
            // The velocities at hand make better positions: the implicit method without its iteration.
            batch.position_steps(&self.model, &mut self.q_rates);
            let weights = self.adams.implicit_weights(batch.first / LANES, self.order);
            let end = batch.first + batch.count;
            self.q_rates.sum(self.q_rates.before(end, weights.len()), weights, &self.q.value, &mut batch.q);
            batch.point.place(&self.model, &batch.q);
            batch.evaluate(&self.model);
            batch.position_steps(&self.model, &mut self.q_rates);
            batch.momentum_steps(&self.model, &mut self.p_rates);
        }
        Ok(())
    }

    /// One round: (2), then (3) for the velocities, then (1) and the rates. Returns the largest correction. All stages
    /// take the rates of the round before: each from those of this round converges slower, 13.7 rounds a step against
    /// 8.3 on five links with 8 stages at 40 ms.
    fn correct(&mut self) -> f64 {
        for batch in &mut self.batches {
            self.p_rates.sum(self.p_rates.now(), &batch.mu, &self.p.value, &mut batch.p);
            batch.residual(&self.model);
            batch.point.begin();
        }
        // A solve is a chain of operations that wait for each other: the chains of all batches go side by side.
        for (i, link) in self.model.links.iter().enumerate().rev() {
            self.batches.iter_mut().for_each(|batch| batch.point.inward(i, link, &mut batch.right));
        }
        for (i, link) in self.model.links.iter().enumerate() {
            self.batches.iter_mut().for_each(|batch| batch.point.outward(i, link, &mut batch.right));
        }
        let mut work = 0.0;
        for batch in &mut self.batches {
            work = larger(work, batch.take());
            batch.position_steps(&self.model, &mut self.q_rates);
        }
        for batch in &mut self.batches {
            self.q_rates.sum(self.q_rates.now(), &batch.mu, &self.q.value, &mut batch.q);
            batch.point.place(&self.model, &batch.q);
            batch.evaluate(&self.model);
            batch.momentum_steps(&self.model, &mut self.p_rates);
        }
        (work * self.over_scale).sqrt()
    }

    /// Poses and twists of the bodies.
    pub fn write_state(&self, out: &mut State) {
        self.model.write_state(&self.q.value, &self.u, out);
    }

    /// Rounds taken so far, over all steps.
    pub fn rounds(&self) -> u64 {
        self.rounds
    }
}
