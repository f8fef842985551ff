//! RATTLE with a variable step that is time-reversible.
//!
//! The step is the reciprocal of a density `rho`, which follows a monitor `U(q, p)` of how fast things happen by an
//! explicit update that is its own reversal (Barth, Leimkuhler and Reich 1999, cited by Marsden and West 2001; see also
//! Hairer, Lubich and Wanner 2006, section VIII.3.2):
//!
//! ```text
//! h_{n+1/2} = C sqrt(tol) / rho_{n+1/2}
//! rho_{n+1/2} rho_{n-1/2} = U(q_n, p_n)^2 ,   rho_{1/2} = U(q_0, p_0)                                (1)
//! U^2 = U0^2 + sum_b K_b/E |Omega_b|^2 + C^2 tol / REACH^2 (sum_b |Omega_b|^4)^(1/2)                     (2)
//! ```
//!
//! with `K_b` the kinetic energy of a body, `Omega_b` its angular velocity, `E` the energy scale of the system and
//! `U0^2 = |g|/l + (1 rad/s)^2` for the mean length `l` of a link. The geometric mean of (1), instead of the arithmetic
//! one of the paper, keeps `rho` positive. The second term of (2) makes the energy error of a step, which is about
//! `h^2/12 sum K_b |Omega_b|^2`, a part of `tol` of `E`; the third keeps `h |Omega_b|` below `REACH`, where a step has
//! one solution.
//!
//! `U` is even in `p`, so (1) taken backwards gives the same steps in reverse: with a reversible system the energy
//! error stays bounded, where a step chosen from the present state alone lets it drift. The map is not symplectic. `U`
//! sees bodies that turn; the oscillation of a stiff spring and the frequency of a drive are not resolved by it.
//!
//! Output at a given time is made by a step to it from a copy of the last grid point.

use super::grid::Grid;
use crate::mechanics::{State, System};
use crate::variational::map::{Map, OwnStep};
use crate::variational::rattle::{Failure, Rattle};

/// `C`: the step that belongs to a tolerance of 1 at a density of 1/s.
const SCALE: f64 = 3.0;

/// The largest `h |Omega|` of a body, rad.
const REACH: f64 = 0.3;

/// The rate (2) of the present state, 1/s.
#[derive(Clone, Copy, Debug)]
pub struct Monitor {
    tolerance: f64,
    energy: f64,
    /// `U0^2`, 1/s^2
    slow: f64,
}

impl Monitor {
    fn new(system: &System, rattle: &Rattle, tolerance: f64) -> Monitor {
        let slow = system.gravity.norm() / rattle.length() + 1.0;
        Monitor { tolerance, energy: system.energy_scale, slow }
    }

    fn rate(&self, rattle: &Rattle) -> f64 {
        let (mut error, mut fast) = (0.0, 0.0);
        for body in rattle.turning() {
            error += body.kinetic / self.energy * body.omega_squared;
            fast += body.omega_squared * body.omega_squared;
        }
        let reach = (SCALE / REACH).powi(2) * self.tolerance;
        (self.slow + error + reach * fast.sqrt()).sqrt() // (2)
    }

    /// The step that goes with the present state alone, s. Chosen by this, steps are not reversible.
    pub fn step(&self, rattle: &Rattle) -> f64 {
        self.step_at(self.rate(rattle))
    }

    fn step_at(&self, density: f64) -> f64 {
        SCALE * self.tolerance.sqrt() / density
    }
}

/// The integrator.
#[derive(Clone, Debug)]
pub struct Adaptive {
    grid: Grid,
    monitor: Monitor,
    /// `rho_{n+1/2}` of the step from the grid point, 1/s.
    density: f64,
    /// 1, or -1 backwards in time.
    direction: f64,
    /// Steps from grid point to grid point since the start.
    steps: u64,
}

impl Adaptive {
    /// Varies the step of an integrator of the system at its present state, for a relative energy error of about
    /// `tolerance`.
    pub fn new(system: &System, rattle: Rattle, tolerance: f64) -> Adaptive {
        let monitor = Monitor::new(system, &rattle, tolerance);
        let density = monitor.rate(&rattle);
        Adaptive { grid: Grid::starting_at(rattle), monitor, density, direction: 1.0, steps: 0 }
    }

    pub fn monitor(&self) -> Monitor {
        self.monitor
    }

    /// Size of the step that is next, s; negative backwards in time.
    pub fn step_size(&self) -> f64 {
        self.direction * self.monitor.step_at(self.density)
    }

    /// Steps from grid point to grid point since the start.
    pub fn steps(&self) -> u64 {
        self.steps
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
    /// See [`Failure`].
    pub fn step_on_grid(&mut self) -> Result<(), Failure> {
        let h = self.step_size();
        if !(h.abs() > f64::EPSILON * self.grid.last.time().abs()) {
            return Err(Failure::Stalled { step: h });
        }
        self.grid.last.step(h)?;
        let rate = self.monitor.rate(&self.grid.last);
        self.density = rate * rate / self.density; // (1)
        self.steps += 1;
        Ok(())
    }

    /// Goes back from the last grid point: the grid points that were passed are passed again in reverse order.
    pub fn turn_back(&mut self) {
        let rate = self.monitor.rate(&self.grid.last);
        self.density = rate * rate / self.density;
        self.direction = -self.direction;
    }

    /// Advances to a time (s) and makes the output there.
    ///
    /// # Errors
    /// See [`Failure`]. The output is then none.
    pub fn advance_to(&mut self, time: f64) -> Result<(), Failure> {
        while self.direction * (time - self.grid.last.time() - self.step_size()) >= 0.0 {
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
}

impl Map for Adaptive {
    const STAYS_ON_FAILURE: bool = false;

    /// Advances the output.
    fn step(&mut self, h: f64) -> Result<(), Failure> {
        self.advance_to(self.output_time() + h)
    }

    fn write_state(&self, out: &mut State) {
        Adaptive::write_state(self, out);
    }

    fn rattle(&self) -> Option<&Rattle> {
        Some(&self.grid.last)
    }

    fn before_failure(&self, _h: f64) -> Option<Adaptive> {
        None
    }

    fn own_step(&self) -> Option<OwnStep> {
        Some(OwnStep { time: self.grid_time(), size: self.step_size() })
    }
}
