//! Stages that are evaluated side by side.

use std::sync::Arc;

use super::adams::Rates;
use super::failure::Failure;
use super::gauss::Gauss;
use crate::numeric::larger;
use crate::reduced::equations::hamiltonian::{LinkConstants, Point, along_velocities, momentum_rates};
use crate::reduced::model::Model;
use crate::reduced::number::real::{LANES, Lanes, Real};

/// As many stages as there are lanes: positions, momenta and velocities, and what the equations say there. Where the
/// stages run out, the last one fills the rest.
#[derive(Clone, Debug)]
pub(super) struct Batch {
    pub(super) point: Point,
    /// First stage, and how many there are.
    pub(super) first: usize,
    pub(super) count: usize,
    /// `h b` and `mu_ij` for every stage `j`.
    pub(super) h_b: Lanes,
    pub(super) mu: Vec<Lanes>,
    /// s
    pub(super) time: Lanes,
    pub(super) q: Vec<Lanes>,
    pub(super) p: Vec<Lanes>,
    pub(super) u: Vec<Lanes>,
    pub(super) m: Vec<Lanes>,
    pub(super) force: Vec<Lanes>,
    /// What (3) lacks, and the correction that follows from it.
    pub(super) right: Vec<Lanes>,
    /// `h b qdot` or `h b pdot`.
    pub(super) rate: Vec<Lanes>,
}

impl Batch {
    pub(super) fn new(
        model: &Model,
        constants: &Arc<[LinkConstants]>,
        gauss: &Gauss,
        step: f64,
        first: usize,
    ) -> Batch {
        let (positions, velocities) =
            (|| vec![Lanes::of(0.0); model.positions], || vec![Lanes::of(0.0); model.velocities]);
        let s = gauss.stages();
        let stage = |k: usize| (first + k).min(s - 1);
        Batch {
            point: Point::new(model, constants),
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
    pub(super) fn stage(&self, lane: usize) -> usize {
        self.first + lane.min(self.count - 1)
    }

    pub(super) fn evaluate(&mut self, model: &Model) {
        self.point.evaluate(model, self.time, &self.q, &self.u, &mut self.m, &mut self.force);
    }

    /// Links, mass matrix and velocities from positions and momenta.
    pub(super) fn move_along(&mut self, model: &Model) -> Result<(), Failure> {
        self.point.place(model, &self.q);
        self.point.factorise(model).ok_or(Failure::Singular)?;
        along_velocities(model, &self.q, &self.p, &mut self.u);
        self.point.solve(model, &mut self.u);
        Ok(())
    }

    /// Hands out `h b qdot`.
    pub(super) fn position_steps(&mut self, model: &Model, out: &mut Rates) {
        if model.plain {
            return self.hand_out(&self.u, out);
        }
        model.rates(&self.q, &self.u, &mut self.rate);
        self.hand_out(&self.rate, out);
    }

    /// Hands out `h b pdot`.
    pub(super) fn momentum_steps(&mut self, model: &Model, out: &mut Rates) {
        if model.plain {
            return self.hand_out(&self.force, out);
        }
        momentum_rates(model, &self.q, &self.p, &self.u, &self.force, &mut self.rate);
        self.hand_out(&self.rate, out);
    }

    pub(super) fn hand_out(&self, rates: &[Lanes], out: &mut Rates) {
        for lane in 0..self.count {
            for (step, rate) in out.stage_mut(self.first + lane).iter_mut().zip(rates) {
                *step = (*rate * self.h_b).numbers()[lane];
            }
        }
    }

    /// What (3) lacks in `m` and in `right`.
    pub(super) fn residual(&mut self, model: &Model) {
        along_velocities(model, &self.q, &self.p, &mut self.right);
        for (m, right) in self.m.iter_mut().zip(&mut self.right) {
            *right -= *m;
            *m = *right;
        }
    }

    /// Takes the corrections in `right`. Returns the largest of the stages, squared, as an energy in J.
    pub(super) fn take(&mut self) -> f64 {
        let mut work = Lanes::of(0.0);
        for ((u, residual), correction) in self.u.iter_mut().zip(&self.m).zip(&self.right) {
            *u += *correction;
            work += *residual * *correction;
        }
        work.numbers().into_iter().fold(0.0, |most, work| larger(most, work.abs()))
    }

    /// What (3) lacks in `m`, and the corrections of the velocities that it asks for in `right`.
    pub(super) fn lack(&mut self, model: &Model) {
        self.residual(model);
        self.point.solve(model, &mut self.right);
    }
}

pub(super) fn everywhere(from: &[f64], to: &mut [Lanes]) {
    to.iter_mut().zip(from).for_each(|(to, x)| *to = Lanes::of(*x));
}
