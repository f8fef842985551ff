//! The exact discrete Lagrangian.

use crate::discrete::Vector;
use crate::discrete::flow::{Motion, MotionPoint};
use crate::discrete::force::Force;
use crate::discrete::lagrangian::{DiscreteLagrangian, Forced, Jet, Legendre};
use crate::discrete::solve::{SolveError, central_difference, newton};
use crate::discrete::structure::{join, split};
use crate::discrete::system::SharedSystem;

/// ```text
/// L_d^E(q0, q1, h) = integral from 0 to h of L(q(t), q'(t)) dt                                       (MW 1.6.1)
/// f_d^E-(q0, q1, h) = integral of f . dq(t)/dq0 dt,     f_d^E+ = integral of f . dq(t)/dq1 dt          (MW 3.2.3)
/// ```
///
/// along the motion with `q(0) = q0`, `q(h) = q1`, found by shooting to roundoff. Its discrete Hamiltonian map is the
/// flow (MW 1.6.3 and 1.6.4). The discrete forces are taken from the momenta, `f_d^E+ = p1 - D2 L_d^E`; they and the
/// second derivatives are central differences of shots (error about 1e-11).
///
/// Where several motions join the points, the one nearest to the chord is taken.
pub struct Exact {
    pub system: SharedSystem,
}

/// Longest substep of the reference flow, s, for motions with times of about 1 s.
const LONGEST: f64 = 0.1;
/// Step of the differences in `q` and `v`.
const DIFFERENCE: f64 = 1e-3;

impl Exact {
    fn motion<'a>(&'a self, force: Option<&'a dyn Force>) -> Motion<'a> {
        Motion { system: self.system.as_ref(), force, constraint: None }
    }

    /// The initial velocity with which the motion from `q0` arrives at `q1`.
    fn shoot(&self, motion: &Motion<'_>, q0: &Vector, q1: &Vector, h: f64) -> Result<Vector, SolveError> {
        let arrive = |v: &Vector| Ok(motion.flow(q0, v, h, LONGEST)?.q);
        let guess = (q1 - q0) / h;
        // The derivative at the guess serves for all rounds: over a step it hardly changes.
        let derivative = central_difference(&guess, DIFFERENCE, arrive)?;
        newton("shooting", guess, |v| Ok((arrive(v)? - q1, derivative.clone())))
    }

    /// `p0` and `p1` of the motion from `q0` to `q1`, and where it ends.
    fn momenta(
        &self,
        motion: &Motion<'_>,
        q0: &Vector,
        q1: &Vector,
        h: f64,
    ) -> Result<(Vector, Vector, MotionPoint), SolveError> {
        let v0 = self.shoot(motion, q0, q1, h)?;
        let end = motion.flow(q0, &v0, h, LONGEST)?;
        Ok((self.system.momentum(q0, &v0), self.system.momentum(q1, &end.v), end))
    }

    /// The Legendre transforms, the action, and its derivatives `(D1, D2)` stacked.
    fn transforms(
        &self,
        motion: &Motion<'_>,
        q0: &Vector,
        q1: &Vector,
        h: f64,
    ) -> Result<(Legendre, f64, Vector), SolveError> {
        let n = q0.len();
        let (p0, p1, end) = self.momenta(motion, q0, q1, h)?;
        let by = central_difference(&join(q0, q1), DIFFERENCE, |ends| {
            let (q0, q1) = split(ends);
            let (p0, p1, end) = self.momenta(motion, &q0, &q1, h)?;
            Ok(join(&join(&p0, &p1), &Vector::from_element(1, end.action)))
        })?;
        let block = |i: usize, j: usize| by.view((i * n, j * n), (n, n)).into_owned();
        let legendre =
            Legendre { p0, p1, p0_q0: block(0, 0), p0_q1: block(0, 1), p1_q0: block(1, 0), p1_q1: block(1, 1) };
        Ok((legendre, end.action, by.row(2 * n).transpose()))
    }
}

impl DiscreteLagrangian for Exact {
    fn dim(&self) -> usize {
        self.system.dim()
    }

    fn jet(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Jet, SolveError> {
        let (at, value, _) = self.transforms(&self.motion(None), q0, q1, h)?;
        Ok(Jet { value, d1: -at.p0, d2: at.p1, d11: -at.p0_q0, d12: -at.p0_q1, d22: at.p1_q1 })
    }

    fn forced(&self, force: &dyn Force, q0: &Vector, q1: &Vector, h: f64) -> Result<Forced, SolveError> {
        let (legendre, _, slopes) = self.transforms(&self.motion(Some(force)), q0, q1, h)?;
        let (d1, d2) = split(&slopes);
        let (minus, plus) = (-d1 - &legendre.p0, &legendre.p1 - d2);
        Ok(Forced { legendre, minus, plus })
    }

    fn value(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<f64, SolveError> {
        Ok(self.momenta(&self.motion(None), q0, q1, h)?.2.action)
    }
}
