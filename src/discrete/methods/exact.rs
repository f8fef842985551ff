//! The exact discrete Lagrangian.

use crate::discrete::flow::{Motion, MotionPoint};
use crate::discrete::force::Force;
use crate::discrete::lagrangian::{DiscreteLagrangian, Forced, Jet, Legendre};
use crate::discrete::quadrature::Quadrature;
use crate::discrete::solve::{SolveError, central_difference, newton};
use crate::discrete::structure::{join, split};
use crate::discrete::system::SharedSystem;
use crate::discrete::{Matrix, Vector};

/// ```text
/// L_d^E(q0, q1, h) = integral from 0 to h of L(q(t), q'(t)) dt                                       (MW 1.6.1)
/// f_d^E-(q0, q1, h) = integral of f . dq(t)/dq0 dt,     f_d^E+ = integral of f . dq(t)/dq1 dt          (MW 3.2.3)
/// ```
///
/// along the motion with `q(0) = q0`, `q(h) = q1`, found by shooting to roundoff. Its discrete Hamiltonian map is the flow
/// (MW 1.6.3 and 1.6.4). Second derivatives and the discrete forces take central differences of shots (about 1e-10).
///
/// Where several motions join the points, the one nearest to the chord is taken.
pub struct Exact {
    pub system: SharedSystem,
}

/// Longest substep of the reference flow, s, for motions with times of about 1 s.
const LONGEST: f64 = 0.05;
/// Step of the differences in `q` and `v`.
const DIFFERENCE: f64 = 1e-3;
/// Nodes of the quadrature for the discrete forces.
const FORCE_NODES: usize = 8;

impl Exact {
    fn motion<'a>(&'a self, force: Option<&'a dyn Force>) -> Motion<'a> {
        Motion { system: self.system.as_ref(), force, constraint: None }
    }

    /// The initial velocity with which the motion from `q0` arrives at `q1`.
    fn shoot(&self, motion: &Motion<'_>, q0: &Vector, q1: &Vector, h: f64) -> Result<Vector, SolveError> {
        let arrive = |v: &Vector| Ok(motion.flow(q0, v, h, LONGEST)?.q);
        let guess = (q1 - q0) / h;
        newton("shooting", guess, |v| Ok((arrive(v)? - q1, central_difference(v, DIFFERENCE, arrive)?)))
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

    fn transforms(
        &self,
        motion: &Motion<'_>,
        q0: &Vector,
        q1: &Vector,
        h: f64,
    ) -> Result<(Legendre, MotionPoint), SolveError> {
        let n = q0.len();
        let (p0, p1, end) = self.momenta(motion, q0, q1, h)?;
        let ends = join(q0, q1);
        let by = central_difference(&ends, DIFFERENCE, |ends| {
            let (q0, q1) = split(ends);
            let (p0, p1, _) = self.momenta(motion, &q0, &q1, h)?;
            Ok(join(&p0, &p1))
        })?;
        let block = |i: usize, j: usize| by.view((i * n, j * n), (n, n)).into_owned();
        let legendre =
            Legendre { p0, p1, p0_q0: block(0, 0), p0_q1: block(0, 1), p1_q0: block(1, 0), p1_q1: block(1, 1) };
        Ok((legendre, end))
    }

    /// Positions and velocities at the quadrature nodes of the motion from `q0` to `q1`, stacked.
    fn samples(&self, motion: &Motion<'_>, q0: &Vector, q1: &Vector, h: f64) -> Result<Vec<MotionPoint>, SolveError> {
        let v0 = self.shoot(motion, q0, q1, h)?;
        Quadrature::gauss(FORCE_NODES).nodes.iter().map(|c| motion.flow(q0, &v0, c * h, LONGEST)).collect()
    }

    /// `(f_d^E-, f_d^E+)` stacked.
    fn discrete_forces(&self, force: &dyn Force, q0: &Vector, q1: &Vector, h: f64) -> Result<Vector, SolveError> {
        let n = q0.len();
        let motion = self.motion(Some(force));
        let ends = join(q0, q1);
        let moved: Matrix = central_difference(&ends, DIFFERENCE, |ends| {
            let (q0, q1) = split(ends);
            let points = self.samples(&motion, &q0, &q1, h)?;
            Ok(Vector::from_iterator(n * FORCE_NODES, points.iter().flat_map(|p| p.q.iter().copied())))
        })?;
        let mut sum = Vector::zeros(2 * n);
        let weights = Quadrature::gauss(FORCE_NODES).weights;
        for (i, (point, weight)) in self.samples(&motion, q0, q1, h)?.iter().zip(weights).enumerate() {
            sum += moved.rows(i * n, n).transpose() * force.value(&point.q, &point.v) * (weight * h);
        }
        Ok(sum)
    }
}

impl DiscreteLagrangian for Exact {
    fn dim(&self) -> usize {
        self.system.dim()
    }

    fn jet(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Jet, SolveError> {
        let (at, end) = self.transforms(&self.motion(None), q0, q1, h)?;
        Ok(Jet { value: end.action, d1: -at.p0, d2: at.p1, d11: -at.p0_q0, d12: -at.p0_q1, d22: at.p1_q1 })
    }

    fn forced(&self, force: &dyn Force, q0: &Vector, q1: &Vector, h: f64) -> Result<Forced, SolveError> {
        let (legendre, _) = self.transforms(&self.motion(Some(force)), q0, q1, h)?;
        let (minus, plus) = split(&self.discrete_forces(force, q0, q1, h)?);
        Ok(Forced { legendre, minus, plus })
    }

    fn value(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<f64, SolveError> {
        Ok(self.momenta(&self.motion(None), q0, q1, h)?.2.action)
    }
}
