//! A step that fails, taken in halves.
//!
//! Halves are halved again until they converge, down to [`MOST_HALVINGS`] times. The result is a solution of the same
//! accuracy or better, but a step whose size depends on whether it converged is no symplectic and no time-reversible
//! map: the long-time behaviour is given up wherever it happens.

use crate::mechanics::State;
use crate::variational::map::{Map, OwnStep};
use crate::variational::rattle::{Failure, Rattle};

/// How often a step is halved at most: down to 1/1024 of it.
pub const MOST_HALVINGS: u32 = 10;

/// Takes a step of size `h` by `step`, in halves where it fails. A `step` that fails must leave its state unchanged.
/// Returns how often the step was halved where it was halved most, 0 if it did not fail.
///
/// # Errors
/// The failure of the shortest step that was tried. What was taken before it stays taken.
pub fn step_in_halves(h: f64, step: &mut impl FnMut(f64) -> Result<(), Failure>) -> Result<u32, Failure> {
    halve(h, 0, step)
}

fn halve(h: f64, halvings: u32, step: &mut impl FnMut(f64) -> Result<(), Failure>) -> Result<u32, Failure> {
    match step(h) {
        Ok(()) => Ok(halvings),
        // A step that ends in a singular configuration has been taken when that is found.
        Err(failure) if halvings == MOST_HALVINGS || matches!(failure, Failure::Singular { .. }) => Err(failure),
        Err(_) => {
            let first = halve(0.5 * h, halvings + 1, step)?;
            Ok(first.max(halve(0.5 * h, halvings + 1, step)?))
        }
    }
}

/// The longest step `h / 2^k` by which a state advances over `h` without a failure, found by trying on copies of it;
/// `None` where `k` up to [`MOST_HALVINGS`] does not help.
pub fn step_that_works<S: Clone>(
    state: &S,
    h: f64,
    mut step: impl FnMut(&mut S, f64) -> Result<(), Failure>,
) -> Option<f64> {
    (1..=MOST_HALVINGS).find_map(|k| {
        let (parts, mut copy) = (1_u32 << k, state.clone());
        let part = h / f64::from(parts);
        (0..parts).all(|_| step(&mut copy, part).is_ok()).then_some(part)
    })
}

/// How many of the steps that were taken in halves are remembered.
const REMEMBERED: usize = 3;

/// A map whose steps are taken in halves where they fail.
#[derive(Clone, Debug)]
pub struct Halving<M> {
    map: M,
    taken: u64,
    halved: Halved,
}

/// Steps that were taken in halves.
#[derive(Clone, Debug)]
pub struct Halved {
    pub steps: u64,
    /// How often a step was halved where it was halved most.
    pub most: u32,
    /// The first of them, as numbers of steps before.
    pub first: Vec<u64>,
}

impl<M: Map> Halving<M> {
    pub fn new(map: M) -> Halving<M> {
        Halving { map, taken: 0, halved: Halved { steps: 0, most: 0, first: Vec::with_capacity(REMEMBERED) } }
    }

    pub fn map(&self) -> &M {
        &self.map
    }

    pub fn halved(&self) -> &Halved {
        &self.halved
    }
}

impl<M: Map> Map for Halving<M> {
    const STAYS_ON_FAILURE: bool = false;

    fn step(&mut self, h: f64) -> Result<(), Failure> {
        let (map, halved) = (&mut self.map, &mut self.halved);
        let halvings = step_in_halves(h, &mut |h| map.step(h))?;
        if halvings > 0 {
            halved.steps += 1;
            halved.most = halved.most.max(halvings);
            if halved.first.len() < REMEMBERED {
                halved.first.push(self.taken);
            }
        }
        self.taken += 1;
        Ok(())
    }

    fn write_state(&self, out: &mut State) {
        self.map.write_state(out);
    }

    fn rattle(&self) -> Option<&Rattle> {
        self.map.rattle()
    }

    fn before_failure(&self, _h: f64) -> Option<Halving<M>> {
        None
    }

    fn own_step(&self) -> Option<OwnStep> {
        None
    }
}
