//! The symplectic-energy-momentum map: RATTLE whose step is an unknown (Marsden and West 2001, section 4.9; Kane,
//! Marsden and Ortiz 1999).
//!
//! The discrete Lagrangian `L_d(q0, q1, h)` of RATTLE is one of the extended space of positions and times. Its momentum
//! in time is minus the discrete energy of a step, and the discrete Euler-Lagrange equation in time makes that of one
//! step equal to that of the next:
//!
//! ```text
//! (q1, p1) = RATTLE_h (q0, p0)                                                                            (1)
//! E_d(q0, q1, h) = -d L_d / d h = E                    this fixes h                                       (2)
//! ```
//!
//! where `E` is the discrete energy of the first step, whose size is given. The map is symplectic on the extended phase
//! space, for `dq ^ dp - dt ^ dE`, time-reversible, of order 2 in a step that varies, and keeps `E` and the momenta of
//! symmetries to roundoff. It does not keep the energy of `(q, p)`, which differs from `E` by `O(h^2)`.
//!
//! Without springs the discrete energy of a step from `(q0, p0)` is
//!
//! ```text
//! E_d = H(q0, p0) + h^2/8 (|G(q0)^T lambda0|^2 - |f|^2) ,      |u|^2 = u . M^-1 u ,                          (3)
//! ```
//!
//! on the linear space of positions and attitude matrices: where the joint forces (those that keep a body rigid among
//! them) pass the size of the weight, no step keeps the energy. For a bob on a rod at the angle `theta` from hanging
//! that is at `l thetadot^2 = g (1 - cos(theta))`, before every turning point; a pendulum that goes round fast never
//! gets there, nor does anything without gravity (MW example 4.9.1 is the case without joint forces). Towards such a
//! point the steps grow, as the reciprocal cube root of the bracket in (3), and end in [`Failure::NoStep`].
//!
//! Output at a given time is a step of RATTLE to it from a copy of the last grid point.

use std::cmp::Ordering;

use super::grid::Grid;
use crate::mechanics::State;
use crate::variational::map::{Map, OwnStep};
use crate::variational::rattle::{Failure, Rattle};

/// By which factor a step may differ from the last one.
const REACH: f64 = 2.0;

/// By which factor the first try of a step may differ from the last one.
const GUESS: f64 = 1.2;

/// Rounds of the secant method, and of the bisection after it.
const ROUNDS: usize = 20;
const HALVINGS: usize = 100;

/// Steps on either side of the last one that are tried for a change of sign where the secant method finds none.
const SCAN: i32 = 16;

/// Discrete energies that differ by this many roundings of their terms are the same; by so many where more rounds do
/// not help.
const SAME: f64 = 2.0;
const CLOSE: f64 = 16.0;

/// A step that was tried, s, and by how much its discrete energy exceeds that of the run, J.
#[derive(Clone, Copy, Debug)]
struct Tried {
    h: f64,
    excess: f64,
    /// One rounding of the energy's terms, J.
    rounding: f64,
}

impl Tried {
    fn within(&self, roundings: f64) -> bool {
        self.excess.abs() <= roundings * self.rounding
    }
}

/// Which of two steps comes closer to the energy of the run.
fn closer(a: &Tried, b: &Tried) -> Ordering {
    a.excess.abs().total_cmp(&b.excess.abs())
}

/// The integrator.
#[derive(Clone, Debug)]
pub struct EnergyMomentum {
    grid: Grid,
    /// The end of the step `tried`; the next grid point, if that is `found`.
    ahead: Rattle,
    tried: Option<Tried>,
    found: Option<Tried>,
    /// `E`, J, from the first step on.
    energy: Option<f64>,
    /// The last two steps, s, and the slope of the discrete energy over the square of the step, J/s^2.
    steps: [f64; 2],
    slope: Option<f64>,
    taken: u64,
    solves: u64,
    shortest: f64,
    longest: f64,
    worst: f64,
}

/// What the steps of a run were like.
#[derive(Clone, Copy, Debug)]
pub struct Report {
    /// Steps from grid point to grid point.
    pub steps: u64,
    /// RATTLE steps that were taken to find them.
    pub solves: u64,
    pub shortest: f64,
    pub longest: f64,
    /// `E`, J.
    pub energy: f64,
    /// The largest difference of a step's discrete energy from it, over the size of its terms.
    pub worst: f64,
}

impl EnergyMomentum {
    /// Makes an integrator in its present state vary its step, from a first one of size `h` > 0 (s). Its bodies keep
    /// their rotation rules. The system must have no dampers and no drives.
    pub fn new(mut rattle: Rattle, h: f64) -> EnergyMomentum {
        rattle.keep_rotation();
        EnergyMomentum {
            ahead: rattle.clone(),
            grid: Grid::starting_at(rattle),
            tried: None,
            found: None,
            energy: None,
            steps: [h, h],
            slope: None,
            taken: 0,
            solves: 0,
            shortest: f64::INFINITY,
            longest: 0.0,
            worst: 0.0,
        }
    }

    /// The same with the discrete energy (J) of the run given: the first step is the one near `h` that has it.
    pub fn with_energy(rattle: Rattle, h: f64, energy: f64) -> EnergyMomentum {
        EnergyMomentum { energy: Some(energy), ..EnergyMomentum::new(rattle, h) }
    }

    /// `E`, J; `None` before the first step.
    pub fn energy(&self) -> Option<f64> {
        self.energy
    }

    /// What the steps were like so far; `None` before the first.
    pub fn report(&self) -> Option<Report> {
        let EnergyMomentum { solves, shortest, longest, worst, .. } = *self;
        let energy = self.energy.filter(|_| self.taken > 0)?;
        Some(Report { steps: self.taken, solves, shortest, longest, energy, worst })
    }

    /// The last step from grid point to grid point, s; before the first the one that is tried first.
    pub fn step_size(&self) -> f64 {
        self.steps[0]
    }

    /// Time of the output, s.
    pub fn output_time(&self) -> f64 {
        self.grid.output_time()
    }

    /// Time of the last grid point, s.
    pub fn grid_time(&self) -> f64 {
        self.grid.last.time()
    }

    /// Takes one step of the sequence. After a failure the grid point is the one before.
    ///
    /// # Errors
    /// See [`Failure`]; [`Failure::NoStep`] where no step keeps the discrete energy.
    pub fn step_on_grid(&mut self) -> Result<(), Failure> {
        let found = self.find()?;
        std::mem::swap(&mut self.grid.last, &mut self.ahead);
        (self.found, self.tried) = (None, None);
        self.steps = [found.h, if self.taken == 0 { found.h } else { self.steps[0] }];
        self.taken += 1;
        (self.shortest, self.longest) = (self.shortest.min(found.h), self.longest.max(found.h));
        self.worst = self.worst.max(found.excess.abs() / found.rounding * f64::EPSILON);
        Ok(())
    }

    /// Advances to a time (s) and makes the output there.
    ///
    /// # Errors
    /// See [`Failure`]. The output is then none.
    pub fn advance_to(&mut self, time: f64) -> Result<(), Failure> {
        while self.grid.last.time() < time {
            self.find()?;
            if self.ahead.time() > time {
                break;
            }
            self.step_on_grid()?;
        }
        self.grid.make_output(time, self.step_size())
    }

    /// Writes the state at the time of the output.
    pub fn write_state(&self, out: &mut State) {
        self.grid.write_output(out);
    }

    /// Writes the state of the last grid point.
    pub fn write_grid_point(&self, out: &mut State) {
        self.grid.last.write_state(out);
    }

    /// The step from the grid point, with its end in `ahead`.
    fn find(&mut self) -> Result<Tried, Failure> {
        if let Some(found) = self.found {
            return Ok(found);
        }
        let last = self.steps[0];
        if !(last > f64::EPSILON * self.grid.last.time().abs()) {
            return Err(Failure::Stalled { step: last });
        }
        let found = match self.energy {
            Some(energy) => self.solve(energy)?,
            None => self.first(last)?,
        };
        self.found = Some(found);
        Ok(found)
    }

    /// The first step, whose discrete energy is that of the run.
    fn first(&mut self, h: f64) -> Result<Tried, Failure> {
        self.ahead.copy_from(&self.grid.last)?;
        self.ahead.step(h)?;
        let of_step = self.ahead.discrete_energy(h);
        self.energy = Some(of_step.energy);
        self.solves += 1;
        Ok(Tried { h, excess: 0.0, rounding: f64::EPSILON * of_step.size })
    }

    /// (1) for a step of size `h`: by how much it misses (2). `None` where RATTLE has no such step.
    fn attempt(&mut self, h: f64, energy: f64) -> Option<Tried> {
        self.solves += 1;
        self.tried = None;
        self.ahead.copy_from(&self.grid.last).ok()?;
        self.ahead.step(h).ok()?;
        let of_step = self.ahead.discrete_energy(h);
        let tried = Tried { h, excess: of_step.energy - energy, rounding: f64::EPSILON * of_step.size };
        self.tried = Some(tried).filter(|tried| tried.excess.is_finite());
        self.tried
    }

    /// (2), by the secant method on the square of the step, and where that fails by bisection between a change of sign.
    fn solve(&mut self, energy: f64) -> Result<Tried, Failure> {
        let [last, before] = self.steps;
        let guess = last * (last / before).clamp(1.0 / GUESS, GUESS);
        // The step itself fails where RATTLE does: that has a reason of its own.
        let Some(first) = self.attempt(guess, energy) else {
            return self.search(energy, None);
        };
        let mut best = first;
        let mut at = first;
        let mut stalled = 0;
        for _ in 0..ROUNDS {
            if best.within(SAME) || (stalled >= 2 && best.within(CLOSE)) {
                return self.take(best, energy);
            }
            let square = match self.slope {
                Some(slope) if slope != 0.0 => at.h * at.h - at.excess / slope,
                _ => at.h * at.h * 1.01,
            };
            let h = square.max(0.0).sqrt().clamp(last / REACH, last * REACH);
            if h == at.h {
                break;
            }
            let Some(next) = self.attempt(h, energy) else { break };
            let slope = (next.excess - at.excess) / (next.h * next.h - at.h * at.h);
            // Between neighbours the difference of two roundings is no slope.
            if (next.excess - at.excess).abs() > CLOSE * next.rounding {
                self.slope = Some(slope);
            }
            stalled = if next.excess.abs() < best.excess.abs() { 0 } else { stalled + 1 };
            if stalled == 0 {
                best = next;
            }
            at = next;
        }
        if best.within(CLOSE) {
            return self.take(best, energy);
        }
        self.search(energy, Some(best))
    }

    /// Tries steps between the limits, from the last one outwards, for a change of sign next to each other, and halves.
    fn search(&mut self, energy: f64, mut best: Option<Tried>) -> Result<Tried, Failure> {
        let last = self.steps[0];
        let h = |k: i32| last * REACH.powf(f64::from(k) / f64::from(SCAN));
        let middle = self.attempt(last, energy);
        if let Some(found) = middle.filter(|tried| tried.within(SAME)) {
            return Ok(found);
        }
        let mut sides = [middle, middle];
        for k in 1..=SCAN {
            for (side, sign) in [(0, 1), (1, -1)] {
                let next = self.attempt(h(sign * k), energy);
                if let Some(found) = next.filter(|tried| tried.within(SAME)) {
                    return Ok(found);
                }
                if let (Some(a), Some(b)) = (sides[side], next)
                    && a.excess.signum() != b.excess.signum()
                    && let Some(found) = self.halve(a, b, energy)
                {
                    return Ok(found);
                }
                sides[side] = next;
                best = [best, next].into_iter().flatten().min_by(closer);
            }
        }
        let Some(best) = [best, middle].into_iter().flatten().min_by(closer) else {
            // No step of any of these sizes can be taken: RATTLE says why.
            self.ahead.copy_from(&self.grid.last)?;
            self.ahead.step(last)?;
            return Err(Failure::Stalled { step: last });
        };
        Err(Failure::NoStep { step: best.h, energy, missed: best.excess })
    }

    /// Halves between two steps whose discrete energies lie on either side of (2).
    fn halve(&mut self, mut a: Tried, mut b: Tried, energy: f64) -> Option<Tried> {
        for _ in 0..HALVINGS {
            let middle = self.attempt(0.5 * (a.h + b.h), energy)?;
            if middle.within(SAME) {
                return Some(middle);
            }
            if middle.h == a.h || middle.h == b.h {
                return middle.within(CLOSE).then_some(middle);
            }
            if middle.excess.signum() == a.excess.signum() { a = middle } else { b = middle }
        }
        None
    }

    /// Takes a step that was tried, once more unless `ahead` is its end.
    fn take(&mut self, found: Tried, energy: f64) -> Result<Tried, Failure> {
        if self.tried.is_some_and(|tried| tried.h == found.h) {
            return Ok(found);
        }
        let missed = Failure::NoStep { step: found.h, energy, missed: found.excess };
        self.attempt(found.h, energy).ok_or(missed)
    }
}

impl Map for EnergyMomentum {
    const STAYS_ON_FAILURE: bool = false;

    /// Advances the output.
    fn step(&mut self, h: f64) -> Result<(), Failure> {
        self.advance_to(self.output_time() + h)
    }

    fn write_state(&self, out: &mut State) {
        EnergyMomentum::write_state(self, out);
    }

    fn rattle(&self) -> Option<&Rattle> {
        Some(&self.grid.last)
    }

    fn before_failure(&self, _h: f64) -> Option<EnergyMomentum> {
        None
    }

    fn own_step(&self) -> Option<OwnStep> {
        Some(OwnStep { time: self.grid_time(), size: self.step_size() })
    }
}
