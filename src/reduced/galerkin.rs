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
//! (3) is solved for the corrections of the `u_i` with the mass matrix that was factorised at the predicted stage; each
//! further round costs two sweeps of vectors over the tree and no factorisation. The start is extrapolated from the
//! velocities of the last two steps, with the degree that would have served the last step best. The rounds go on until the
//! next correction would be lost in roundoff; `q` and `p` are compensated sums.
//!
//! Symplectic, time-reversible, of order `2 s`; keeps joints exactly and momenta that are bilinear in `q` and `p`, among
//! them the angular momentum of a free body; does not conserve energy, whose error stays bounded. Springs between points add to
//! the potential, and drives a potential `-f(t) q` at the times of the stages. Damping, in joints and beside springs, enters by
//! the Lagrange-d'Alembert principle.

use super::gauss::Gauss;
use super::hamiltonian::{Point, along_velocities, canonical, momentum_rates};
use super::{Model, compensated::Compensated};
use crate::mechanics::State;

const MOST_ROUNDS: usize = 60;
/// Corrections of the velocities, in units of those that hold the scene's energy, that no longer count.
const NEGLIGIBLE: f64 = 3e-17;
/// Size below which a correction that does not shrink any more is roundoff.
const ROUNDOFF: f64 = 1e-12;

/// Why a step could not be taken; the integrator stays where it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The rounds did not reach roundoff.
    NotConverged { rounds: usize, correction: f64 },
    /// A joint can move without moving any mass, or the state is not a number.
    Singular,
}

/// The integrator at a fixed step.
#[derive(Clone, Debug)]
pub struct Galerkin {
    model: Model,
    gauss: Gauss,
    /// s
    step: f64,
    taken: u64,
    /// `h b_j`, and `1 / energy scale`.
    steps: Vec<f64>,
    over_scale: f64,
    q: Compensated,
    p: Compensated,
    u: Vec<f64>,
    stages: Vec<Stage>,
    /// `h b_j qdot_j` and `h b_j pdot_j`, stage by stage.
    q_steps: Vec<f64>,
    p_steps: Vec<f64>,
    end: Point,
    history: History,
    /// Room for one vector of velocities.
    right: Vec<f64>,
    before: Vec<f64>,
    rounds: u64,
}

/// One stage: positions, momenta and velocities, and what the equations say there.
#[derive(Clone, Debug)]
struct Stage {
    point: Point,
    /// s
    time: f64,
    q: Vec<f64>,
    p: Vec<f64>,
    u: Vec<f64>,
    m: Vec<f64>,
    force: Vec<f64>,
}

impl Stage {
    fn new(model: &Model) -> Stage {
        let (positions, velocities) = (|| vec![0.0; model.positions], || vec![0.0; model.velocities]);
        Stage {
            point: Point::new(model),
            time: 0.0,
            q: positions(),
            p: positions(),
            u: velocities(),
            m: velocities(),
            force: velocities(),
        }
    }

    /// `h b qdot`
    fn position_step(&self, model: &Model, h_b: f64, out: &mut [f64]) {
        model.rates(&self.q, &self.u, out);
        out.iter_mut().for_each(|x| *x *= h_b);
    }

    fn evaluate(&mut self, model: &Model) {
        self.point.evaluate(model, self.time, &self.q, &self.u, &mut self.m, &mut self.force);
    }

    /// `h b pdot`
    fn momentum_step(&self, model: &Model, h_b: f64, out: &mut [f64]) {
        momentum_rates(model, &self.q, &self.p, &self.u, &self.force, out);
        out.iter_mut().for_each(|x| *x *= h_b);
    }
}

impl Galerkin {
    /// `stages` from 2 to 8; `energy_scale` in J.
    ///
    /// # Errors
    /// A joint can move without moving any mass.
    pub fn new(model: Model, stages: usize, step: f64, energy_scale: f64) -> Result<Galerkin, Failure> {
        let gauss = Gauss::new(stages);
        let (q, u) = model.initial();
        let mut end = Point::new(&model);
        let (mut m, mut force, mut p) = (vec![0.0; u.len()], vec![0.0; u.len()], vec![0.0; q.len()]);
        end.evaluate(&model, 0.0, &q, &u, &mut m, &mut force);
        end.factorise(&model).ok_or(Failure::Singular)?;
        canonical(&model, &q, &m, &mut p);
        Ok(Galerkin {
            step,
            taken: 0,
            steps: step_weights(&gauss, step),
            over_scale: 1.0 / energy_scale,
            stages: vec![Stage::new(&model); stages],
            q_steps: vec![0.0; stages * q.len()],
            p_steps: vec![0.0; stages * q.len()],
            history: History::new(&gauss, &u),
            before: vec![0.0; u.len()],
            right: m,
            q: Compensated::new(q),
            p: Compensated::new(p),
            u,
            end,
            gauss,
            model,
            rounds: 0,
        })
    }

    /// One step. After a failure nothing has changed.
    pub fn step(&mut self) -> Result<(), Failure> {
        if let Err(failure) = self.solve_stages() {
            // A violent moment spoils the extrapolation: start once more from the velocities at hand.
            if self.history.used == 1 {
                return Err(failure);
            }
            self.history.used = 1;
            self.solve_stages()?;
        }
        self.q_steps.chunks_exact(self.q.value.len()).for_each(|step| self.q.collect(step));
        self.p_steps.chunks_exact(self.p.value.len()).for_each(|step| self.p.collect(step));
        self.q.advance();
        self.p.advance();
        self.before.copy_from_slice(&self.u);
        along_velocities(&self.model, &self.q.value, &self.p.value, &mut self.right);
        self.taken += 1;
        let (last, time) = (&mut self.stages[0], self.taken as f64 * self.step);
        self.end.evaluate(&self.model, time, &self.q.value, &self.u, &mut last.m, &mut last.force);
        self.end.factorise(&self.model).ok_or(Failure::Singular)?;
        self.end.solve(&self.model, &mut self.right);
        self.u.copy_from_slice(&self.right);
        self.history.update(&self.before, &self.u, &self.stages);
        Ok(())
    }

    fn solve_stages(&mut self) -> Result<(), Failure> {
        self.predict()?;
        let mut last = f64::INFINITY;
        for round in 1..=MOST_ROUNDS {
            let correction = self.correct();
            self.rounds += 1;
            if !correction.is_finite() {
                return Err(Failure::NotConverged { rounds: round, correction });
            }
            // The corrections shrink by a constant factor: this is what the next would be.
            let next = if last.is_finite() { correction * (correction / last) } else { correction };
            if next <= NEGLIGIBLE && correction < last || correction >= last && correction < ROUNDOFF {
                return Ok(());
            }
            last = correction;
        }
        Err(Failure::NotConverged { rounds: MOST_ROUNDS, correction: last })
    }

    /// The stages at the extrapolated velocities, with the mass matrix factorised there.
    fn predict(&mut self) -> Result<(), Failure> {
        for (i, stage) in self.stages.iter_mut().enumerate() {
            self.history.extrapolate(i, &mut stage.u);
            stage.q.copy_from_slice(&self.q.value);
            stage.time = (self.taken as f64 + self.gauss.nodes[i]) * self.step;
        }
        for _ in 0..=self.model.turns() {
            self.place_stages();
        }
        let steps = self.p_steps.chunks_exact_mut(self.p.value.len());
        for ((stage, h_b), p_step) in self.stages.iter_mut().zip(&self.steps).zip(steps) {
            stage.evaluate(&self.model);
            stage.point.factorise(&self.model).ok_or(Failure::Singular)?;
            canonical(&self.model, &stage.q, &stage.m, &mut stage.p);
            stage.momentum_step(&self.model, *h_b, p_step);
        }
        Ok(())
    }

    /// (1)
    fn place_stages(&mut self) {
        let steps = self.q_steps.chunks_exact_mut(self.q.value.len());
        for ((stage, h_b), q_step) in self.stages.iter().zip(&self.steps).zip(steps) {
            stage.position_step(&self.model, *h_b, q_step);
        }
        for (stage, mu) in self.stages.iter_mut().zip(self.gauss.mu.chunks_exact(self.steps.len())) {
            couple(mu, &self.q.value, &self.q_steps, &mut stage.q);
        }
    }

    /// One round: (2), then (3) for the velocities, then (1) and the rates. Returns the largest correction.
    fn correct(&mut self) -> f64 {
        let mut largest = 0.0f64;
        for (stage, mu) in self.stages.iter_mut().zip(self.gauss.mu.chunks_exact(self.steps.len())) {
            couple(mu, &self.p.value, &self.p_steps, &mut stage.p);
            along_velocities(&self.model, &stage.q, &stage.p, &mut self.right);
            let residual = &mut stage.m;
            for (residual, m) in residual.iter_mut().zip(&mut self.right) {
                *residual = *m - *residual;
                *m = *residual;
            }
            stage.point.solve(&self.model, &mut self.right);
            let work: f64 = residual.iter().zip(&self.right).map(|(r, du)| r * du).sum();
            largest = if work.is_nan() || largest.is_nan() { f64::NAN } else { largest.max(work.abs()) };
            for (u, du) in stage.u.iter_mut().zip(&self.right) {
                *u += du;
            }
        }
        self.place_stages();
        let steps = self.p_steps.chunks_exact_mut(self.p.value.len());
        for ((stage, h_b), p_step) in self.stages.iter_mut().zip(&self.steps).zip(steps) {
            stage.evaluate(&self.model);
            stage.momentum_step(&self.model, *h_b, p_step);
        }
        (largest * self.over_scale).sqrt()
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

/// `h b_j`, mirror images equal.
fn step_weights(gauss: &Gauss, step: f64) -> Vec<f64> {
    gauss.weights.iter().map(|b| b * step).collect()
}

/// `y_i = y0 + sum_j mu_ij L_j` for one stage.
#[inline(always)]
fn couple(mu: &[f64], start: &[f64], steps: &[f64], out: &mut [f64]) {
    out.fill(0.0);
    for (mu, step) in mu.iter().zip(steps.chunks_exact(start.len())) {
        for (out, step) in out.iter_mut().zip(step) {
            *out += mu * step;
        }
    }
    for (out, start) in out.iter_mut().zip(start) {
        *out += start;
    }
}

/// Velocities of the last two steps, and how to go on from them.
#[derive(Clone, Debug)]
struct History {
    /// Velocities at the start, then backwards the stages of the last step, its start, and the stages of the one before.
    velocities: Vec<Vec<f64>>,
    known: usize,
    /// How many of them the next prediction uses.
    used: usize,
    /// For each choice of `used` the weights at every stage.
    choices: Vec<(usize, Vec<Vec<f64>>)>,
}

impl History {
    fn new(gauss: &Gauss, u: &[f64]) -> History {
        let s = gauss.stages();
        let back = |steps: f64| gauss.nodes.iter().rev().map(move |c| c - steps);
        let times: Vec<f64> = std::iter::once(0.0).chain(back(1.0)).chain([-1.0]).chain(back(2.0)).collect();
        let mut counts = vec![1, 3, s / 2 + 2, s + 1, s + 2, s + 3 + s / 3, s + 3 + 2 * s / 3, 2 * s + 2];
        counts.dedup();
        let weights = |count: usize| gauss.nodes.iter().map(|c| lagrange(&times[..count], 1.0 * c)).collect();
        let choices = counts.into_iter().map(|count| (count, weights(count))).collect();
        let mut velocities = vec![vec![0.0; u.len()]; times.len()];
        velocities[0].copy_from_slice(u);
        History { velocities, known: 1, used: 1, choices }
    }

    fn extrapolate(&self, stage: usize, out: &mut [f64]) {
        let choice = self.choices.iter().find(|c| c.0 == self.used);
        let Some((_, weights)) = choice else { return };
        out.fill(0.0);
        for (weight, velocity) in weights[stage].iter().zip(&self.velocities) {
            for (out, v) in out.iter_mut().zip(velocity) {
                *out += weight * v;
            }
        }
    }

    /// Takes in the step from `start` to `end`, and picks the number of points that predicts its last stage best.
    fn update(&mut self, start: &[f64], end: &[f64], stages: &[Stage]) {
        let s = stages.len();
        let found = &stages[s - 1].u;
        let mut best = f64::INFINITY;
        for (count, weights) in self.choices.iter().filter(|c| c.0 <= self.known) {
            let mut error = 0.0;
            for (k, found) in found.iter().enumerate() {
                let predicted: f64 = weights[s - 1].iter().zip(&self.velocities).map(|(w, v)| w * v[k]).sum();
                error += (predicted - found).powi(2);
            }
            if error < best {
                (best, self.used) = (error, *count);
            }
        }
        for k in (1..=s).rev() {
            self.velocities.swap(k, k + s + 1);
        }
        self.velocities[0].copy_from_slice(end);
        for (k, stage) in stages.iter().rev().enumerate() {
            self.velocities[1 + k].copy_from_slice(&stage.u);
        }
        self.velocities[s + 1].copy_from_slice(start);
        if self.known == 1 {
            self.used = s + 2;
        }
        self.known = (self.known + s + 1).min(2 * s + 2);
    }
}

/// Weights of the values at `times` in the polynomial through them, at `at`.
fn lagrange(times: &[f64], at: f64) -> Vec<f64> {
    let weight = |k: usize| {
        let others = times.iter().enumerate().filter(|(j, _)| *j != k);
        others.map(|(_, t)| (at - t) / (times[k] - t)).product()
    };
    (0..times.len()).map(weight).collect()
}
