//! High order by symmetric composition (Marsden and West 2001, section 2.5; Hairer, Lubich and Wanner 2006, chapter
//! V.3).
//!
//! RATTLE is a symmetric map of order 2 on the constraint manifold. Composed as `R(w_1 H) ... R(w_m H)` with
//! palindromic weights of sum 1 that meet the order conditions (`sum w^3 = 0`, then `sum w^5 = 0`, ...) it is a
//! symmetric, symplectic map of order 4, 6 or 8 on the same manifold. Weights of order above 2 cannot all be positive
//! (Suzuki 1991), so a damper, which has no backward motion, does not go with them.
//!
//! Other published sets beside those that ship, at the same number of solves (`tests/core/composition_sets.rs`): errors
//! over those of what ships, of the positions at the end and of the energy, on a spatial chain of five links (1 s) and
//! on a planar double pendulum (5 s); geometric means over three or four numbers of solves, from 500 to 8000. Below 1
//! is better than what ships.
//!
//! | order | set, stages | chain | pendulum |
//! | --- | --- | --- | --- |
//! | 4 | Yoshida 1990, 3 | 9.2, 3.6 | 9.2, 4.6 |
//! | 4 | 7 with equal weights but the middle one | 0.56, 1.07 | 0.56, 0.99 |
//! | 4 | 9 with equal weights but the middle one | 0.44, 1.35 | 0.46, 1.21 |
//! | 4 | 11 with equal weights but the middle one | 0.39, 1.72 | 0.42, 1.46 |
//! | 4 | Blanes and Moan 2002, 12 symplectic Euler maps | 2.2, 1.43 | 2.1, 1.59 |
//! | 6 | Yoshida 1990 A, 7 | 21, 3.7 | 26, 5.1 |
//! | 6 | Kahan and Li 1997 a and b, 9 | 6.9, 1.79 | 7.7, 2.1 |
//! | 6 | Sofroniou and Spaletta 2005, 11 | 1.58, 1.09 | 1.68, 0.99 |
//! | 6 | Blanes and Moan 2002, 20 symplectic Euler maps | 19, 5.6 | 27, 8.1 |
//! | 8 | Yoshida 1990 D, 15 | 3500, 1300 | 4600, 5600 |
//! | 8 | Suzuki and Umeno 1993, 15 | 1.79, 4.5 | 1.34, 4.0 |
//! | 8 | Kahan and Li 1997 b, 17 | 0.96, 1.01 | 0.95, 0.99 |
//! | 8 | Sofroniou and Spaletta 2005, 21 | 1.7, 3.1 | 3.9, 4.0 |
//!
//! At order 6 nothing is better by more than a hundredth. At order 8 the other set of Kahan and Li is better by a
//! twentieth in the positions; the 21 stages are better only where steps are fine (0.55 in the positions of the chain
//! at 2000 solves). At order 4 Suzuki's form with more equal weights trades energy for positions: nine stages have less
//! than half of the error in the positions and a fifth to a third more in the energy.

use crate::mechanics::State;
use crate::variational::map::{Map, OwnStep};
use crate::variational::rattle::{Failure, Rattle};

/// Symmetric weights, given by their first half; the middle weight is what the sum leaves over.
#[derive(Clone, Copy, Debug)]
pub struct Composition {
    /// As in specs.
    pub name: &'static str,
    pub order: u32,
    /// `w_1 ... w_k`; the full row is `w_1 ... w_k, 1 - 2 sum, w_k ... w_1`.
    half: &'static [f64],
    pub source: &'static str,
}

/// RATTLE itself.
pub const ORDER_2: Composition = Composition { name: "2", order: 2, half: &[], source: "RATTLE" };

/// Five stages with the weight `1 / (4 - 4^(1/3))`.
pub const ORDER_4: Composition = Composition {
    name: "4",
    order: 4,
    half: &[0.4144907717943757371423540628607615, 0.4144907717943757371423540628607615],
    source: "Suzuki 1990",
};

/// Thirteen stages.
pub const ORDER_6: Composition = Composition {
    name: "6",
    order: 6,
    half: &[
        0.13861930854051695245808013042625,
        0.13346562851074760407046858832209,
        0.13070531011449225190542755785015,
        0.12961893756907034772505366537091,
        -0.35000324893920896516170830911323,
        0.11805530653002387170273438954049,
    ],
    source: "Sofroniou and Spaletta 2005",
};

/// Seventeen stages.
pub const ORDER_8: Composition = Composition {
    name: "8",
    order: 8,
    half: &[
        0.13020248308889008087881763,
        0.56116298177510838456196441,
        -0.38947496264484728640807860,
        0.15884190655515560089621075,
        -0.39590389413323757733623154,
        0.18453964097831570709183254,
        0.25837438768632204729397911,
        0.29501172360931029887096624,
    ],
    source: "Kahan and Li 1997",
};

/// All sets, in the order of their order. A new one is one constant and one entry here.
pub const ALL: &[Composition] = &[ORDER_2, ORDER_4, ORDER_6, ORDER_8];

impl Composition {
    /// Number of RATTLE steps that one step of the composition takes.
    pub fn stages(&self) -> usize {
        2 * self.half.len() + 1
    }

    /// The weights in the order of the substeps.
    pub fn weights(&self) -> impl Iterator<Item = f64> + '_ {
        let middle = 1.0 - 2.0 * self.half.iter().sum::<f64>();
        self.half.iter().copied().chain(std::iter::once(middle)).chain(self.half.iter().rev().copied())
    }

    /// Takes one step of size `h` (s) of the composition by a map: `w_1 h`, ..., `w_m h`.
    ///
    /// # Errors
    /// That of the substep that fails; the map stays where the one before led.
    pub fn step(&self, map: &mut impl Map, h: f64) -> Result<(), Failure> {
        self.substeps(map, h).map_err(|(_, failure)| failure)
    }

    /// The same; a failure comes with the number of substeps before it.
    fn substeps(&self, map: &mut impl Map, h: f64) -> Result<(), (usize, Failure)> {
        let mut numbered = self.weights().enumerate();
        numbered.try_for_each(|(k, w)| map.step(w * h).map_err(|failure| (k, failure)))
    }
}

/// A map composed of steps of another one.
#[derive(Clone, Debug)]
pub struct Composed<M> {
    map: M,
    composition: Composition,
    /// Substeps before the one that failed in the last step.
    taken: usize,
}

impl<M: Map> Composed<M> {
    pub fn new(map: M, composition: Composition) -> Composed<M> {
        Composed { map, composition, taken: 0 }
    }
}

impl<M: Map> Map for Composed<M> {
    const STAYS_ON_FAILURE: bool = false;

    fn step(&mut self, h: f64) -> Result<(), Failure> {
        self.composition.substeps(&mut self.map, h).map_err(|(taken, failure)| {
            self.taken = taken;
            failure
        })
    }

    fn write_state(&self, out: &mut State) {
        self.map.write_state(out);
    }

    fn rattle(&self) -> Option<&Rattle> {
        self.map.rattle()
    }

    fn before_failure(&self, h: f64) -> Option<Composed<M>> {
        let mut start = self.clone();
        let taken: Vec<f64> = self.composition.weights().take(self.taken).collect();
        taken.iter().rev().try_for_each(|w| start.map.step(-(w * h))).ok()?;
        Some(start)
    }

    fn own_step(&self) -> Option<OwnStep> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `sum w^k = 0` for odd `3 <= k < order`, and not beyond: `sum w^(order + 1)` is what makes the error.
    #[test]
    fn the_weights_meet_the_power_sum_conditions_of_their_order() {
        for c in ALL {
            let power_sum = |k: i32| c.weights().map(|w| w.powi(k)).sum::<f64>();
            assert!((power_sum(1) - 1.0).abs() < 4e-16);
            for k in (3..c.order as i32).step_by(2) {
                // measured at most 2e-16 (roundoff of the sum)
                assert!(power_sum(k).abs() <= 5e-16, "order {} k {k}: {:e}", c.order, power_sum(k));
            }
            assert!(power_sum(c.order as i32 + 1).abs() > 1e-6, "order {}", c.order);
        }
    }
}
