//! The Galerkin variational integrator of Marsden and West (2001), section 2.6.6, in joint coordinates.
//!
//! The action over a step is taken on the polynomials of degree `s` with Gauss-Legendre quadrature at `s` points; its
//! discrete Hamiltonian map is Gauss collocation of Hamilton's equations. With stage velocities `u_i` the stages satisfy
//!
//! ```text
//! q_i = q0 + sum_j mu_ij h b_j qdot(q_j, u_j)                                   (1)
//! p_i = p0 + sum_j mu_ij h b_j pdot(q_j, p_j, u_j)                              (2)
//! m(q_i, p_i) = H(q_i) u_i                                                      (3)
//! q1  = q0 + sum_j h b_j qdot_j ,    p1 = p0 + sum_j h b_j pdot_j               (4)
//! ```
//!
//! The stages are predicted one `LANES` of them after the other, by the explicit Adams method on the nodes before them,
//! those of the last step included: a node is much nearer to the next than a step is long, so the prediction errs far less
//! than an extrapolation over the whole step. Then (3) is solved for the corrections of the `u_i` with the mass matrix that
//! was factorised at the predicted stage; each further round costs two sweeps of vectors over the tree and no factorisation.
//! The rounds go on until what they leave would be lost in roundoff; `q` and `p` are compensated sums. What is iterated to
//! the end does not depend on where it started, so the prediction takes nothing from symmetry and symplecticity.
//!
//! Over a long step the rounds may be no contraction, whatever their start. Then the stages are continued from those of shorter
//! steps, by Newton's method on (3) with the positions and momenta of (1) and (2) as functions of the velocities.
//!
//! Symplectic, time-reversible, of order `2 s`; keeps joints exactly and momenta that are bilinear in `q` and `p`, among
//! them the angular momentum of a free body; does not conserve energy, whose error stays bounded. Springs between points add to
//! the potential, and drives a potential `-f(t) q` at the times of the stages. Damping, in joints and beside springs, enters by
//! the Lagrange-d'Alembert principle.

mod continuation;

use std::sync::Arc;

use super::adams::{Adams, Rates};
use super::gauss::Gauss;
use super::hamiltonian::{Kept, Point, along_velocities, canonical, momentum_rates};
use super::real::{LANES, Lanes, Real};
use super::{Model, compensated::Compensated};
use crate::mechanics::State;
use continuation::Newton;

const MOST_ROUNDS: usize = 60;
/// Corrections of the velocities, in units of those that hold the scene's energy, that no longer count: a third of the roundoff
/// in a round. Over 2000 s of two spatial links (4 to 8 stages, 10 and 20 ms) the energy errors by 1.1e-13 to 8.2e-13, with a
/// tenth of it by 3.0e-13 to 6.2e-13.
const NEGLIGIBLE: f64 = 3e-16;
/// Corrections that are larger show how fast the rounds converge; smaller ones have roundoff in them.
const CLEAN: f64 = 3e-14;
/// Size below which a correction that does not shrink any more is roundoff.
const ROUNDOFF: f64 = 1e-12;

/// Why a step could not be taken; the integrator stays where it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The rounds did not reach roundoff, nor did Newton's method; the last correction of the rounds in units of the velocities
    /// that hold the scene's energy.
    NotConverged { rounds: usize, correction: f64 },
    /// After these rounds the stages were no numbers any more, and Newton's method found none either.
    RanAway { rounds: usize },
    /// A joint can move without moving any mass, or the stages ran away before the first round.
    Singular,
}

/// The integrator at a fixed step.
#[derive(Clone, Debug)]
pub struct Galerkin {
    model: Model,
    gauss: Gauss,
    adams: Adams,
    /// Nodes that the next prediction uses.
    order: usize,
    /// s
    step: f64,
    taken: u64,
    over_scale: f64,
    q: Compensated,
    p: Compensated,
    u: Vec<f64>,
    batches: Vec<Batch>,
    /// `h b_j qdot_j` and `h b_j pdot_j`, stage by stage: of this step and of the one before.
    q_rates: Rates,
    p_rates: Rates,
    end: Batch,
    /// `q` and `p` at the start of a step, in case that its end has no velocities.
    start: [Compensated; 2],
    newton: Newton,
    rounds: u64,
}

/// As many stages as there are lanes: positions, momenta and velocities, and what the equations say there. Where the stages
/// run out, the last one fills the rest.
#[derive(Clone, Debug)]
struct Batch {
    point: Point,
    /// First stage, and how many there are.
    first: usize,
    count: usize,
    /// `h b` and `mu_ij` for every stage `j`.
    h_b: Lanes,
    mu: Vec<Lanes>,
    /// s
    time: Lanes,
    q: Vec<Lanes>,
    p: Vec<Lanes>,
    u: Vec<Lanes>,
    m: Vec<Lanes>,
    force: Vec<Lanes>,
    /// What (3) lacks, and the correction that follows from it.
    right: Vec<Lanes>,
    /// `h b qdot` or `h b pdot`.
    rate: Vec<Lanes>,
}

impl Batch {
    fn new(model: &Model, kept: &Arc<[Kept]>, gauss: &Gauss, step: f64, first: usize) -> Batch {
        let (positions, velocities) =
            (|| vec![Lanes::of(0.0); model.positions], || vec![Lanes::of(0.0); model.velocities]);
        let s = gauss.stages();
        let stage = |k: usize| (first + k).min(s - 1);
        Batch {
            point: Point::new(model, kept),
            first,
            count: LANES.min(s - first),
            h_b: Lanes::from_fn(|k| gauss.weights[stage(k)] * step),
            mu: (0..s).map(|j| Lanes::from_fn(|k| gauss.mu[stage(k) * s + j])).collect(),
            time: Lanes::of(0.0),
            q: positions(),
            p: positions(),
            u: velocities(),
            m: velocities(),
            force: velocities(),
            right: velocities(),
            rate: positions(),
        }
    }

    /// The stage in a lane.
    fn stage(&self, lane: usize) -> usize {
        self.first + lane.min(self.count - 1)
    }

    fn evaluate(&mut self, model: &Model) {
        self.point.evaluate(model, self.time, &self.q, &self.u, &mut self.m, &mut self.force);
    }

    /// Links, mass matrix and velocities from positions and momenta.
    fn move_along(&mut self, model: &Model) -> Result<(), Failure> {
        self.point.place(model, &self.q);
        self.point.factorise(model).ok_or(Failure::Singular)?;
        along_velocities(model, &self.q, &self.p, &mut self.u);
        self.point.solve(model, &mut self.u);
        Ok(())
    }

    /// Hands out `h b qdot`.
    fn position_steps(&mut self, model: &Model, out: &mut Rates) {
        if model.plain {
            return self.hand_out(&self.u, out);
        }
        model.rates(&self.q, &self.u, &mut self.rate);
        self.hand_out(&self.rate, out);
    }

    /// Hands out `h b pdot`.
    fn momentum_steps(&mut self, model: &Model, out: &mut Rates) {
        if model.plain {
            return self.hand_out(&self.force, out);
        }
        momentum_rates(model, &self.q, &self.p, &self.u, &self.force, &mut self.rate);
        self.hand_out(&self.rate, out);
    }

    fn hand_out(&self, rates: &[Lanes], out: &mut Rates) {
        for lane in 0..self.count {
            for (step, rate) in out.stage_mut(self.first + lane).iter_mut().zip(rates) {
                *step = (*rate * self.h_b).numbers()[lane];
            }
        }
    }

    /// What (3) lacks in `m` and in `right`.
    fn residual(&mut self, model: &Model) {
        along_velocities(model, &self.q, &self.p, &mut self.right);
        for (m, right) in self.m.iter_mut().zip(&mut self.right) {
            *right -= *m;
            *m = *right;
        }
    }

    /// Takes the corrections in `right`. Returns the largest of the stages, squared, as an energy in J.
    fn take(&mut self) -> f64 {
        let mut work = Lanes::of(0.0);
        for ((u, residual), correction) in self.u.iter_mut().zip(&self.m).zip(&self.right) {
            *u += *correction;
            work += *residual * *correction;
        }
        work.numbers().into_iter().fold(0.0, largest)
    }

    /// What (3) lacks in `m`, and the corrections of the velocities that it asks for in `right`.
    fn lack(&mut self, model: &Model) {
        self.residual(model);
        self.point.solve(model, &mut self.right);
    }
}

fn everywhere(from: &[f64], to: &mut [Lanes]) {
    to.iter_mut().zip(from).for_each(|(to, x)| *to = Lanes::of(*x));
}

/// The larger size; a number that is none wins.
fn largest(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b.abs()) }
}

impl Galerkin {
    /// `stages` from 2 to 8; `energy_scale` in J.
    ///
    /// # Errors
    /// A joint can move without moving any mass.
    pub fn new(model: Model, stages: usize, step: f64, energy_scale: f64) -> Result<Galerkin, Failure> {
        let gauss = Gauss::new(stages);
        let (q, u) = model.initial();
        let kept = Kept::all(&model);
        let mut end = Batch::new(&model, &kept, &gauss, step, 0);
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
            (0..stages).step_by(LANES).map(|first| Batch::new(&model, &kept, &gauss, step, first)).collect();
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
            start: [Compensated::new(q.clone()), Compensated::new(p.clone())],
            newton: Newton::new(stages * u.len()),
            q: Compensated::new(q),
            p: Compensated::new(p),
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

    /// The stages one batch after the other, each from the rates at the nodes before it, with the mass matrix factorised
    /// there.
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

    /// One round: (2), then (3) for the velocities, then (1) and the rates. Returns the largest correction.
    /// All stages take the rates of the round before: each from those of this round converges slower, 13.7 rounds a step
    /// against 8.3 on five links with 8 stages at 40 ms.
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
            work = largest(work, batch.take());
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
