//! RATTLE for rigid bodies on the constraint manifold of their joints.
//!
//! The discrete Hamiltonian map of the constrained discrete Lagrangian of Marsden and West (2001), sections 3.5.3 and
//! 3.5.4, in the variables (q, p): from `phi(q0) = 0`, `G(q0) M^-1 p0 = 0` one step of size `h` is
//!
//! ```text
//! p'  = p0 + h/2 (f(q0) + G(q0)^T lambda0)        half kick                                (1)
//! x1  = x0 + h p'/m ,   R1 = R0 F(s)              drift, with pi' unchanged               (2)
//! phi(q1) = 0                                     the joints hold: this fixes lambda0     (3)
//! p1  = p' + h/2 (f(q1) + G(q1)^T lambda1)        half kick                                (4)
//! G(q1) M^-1 p1 = 0                               the twists fit: this fixes lambda1      (5)
//! ```
//!
//! (3) is solved by a chord iteration ([`super::super::closing`]) with the articulated-body factorisation at `q0`,
//! which is the one that (5) of the step before has made: one factorisation a step. The multipliers live in the joints
//! as wrench impulses `h/2 lambda`; the next step starts from their extrapolation in the child's body frame. `phi(q1)`
//! is computed from the motions of the step, not from the difference of positions, and the iteration ends with a
//! correction below the roundoff of the motions: small steps do not cancel, and nothing is left out that would add up.
//!
//! Springs and drives in joints are part of the discrete Lagrangian, and dampers enter by the discrete
//! Lagrange-d'Alembert principle (Marsden and West, section 3.2): each half kick carries an impulse along the joint's
//! motion subspace, which is solved for with (3); see [`super::super::force`].
//!
//! The map is symplectic on the constraint manifold, time-reversible, of order 2, and conserves the momenta of the
//! system's symmetries; it does not conserve energy, whose error stays bounded while `h` times the largest frequency is
//! small.

use nalgebra::{Quaternion, SVector};

use super::attitude::{norm_defect, turn_less_one};
use super::failure::Failure;
use super::state::Rattle;
use crate::mechanics::State;
use crate::variational::chain::Pose;

impl Rattle {
    /// Takes one step of size `h` (s). After a failure the state is the one before the step; after
    /// [`Failure::Singular`] alone it is that at its end, with momenta that do not fit the joints.
    ///
    /// # Errors
    /// See [`Failure`].
    pub fn step(&mut self, h: f64) -> Result<(), Failure> {
        self.drift_onto_constraints(h)?; // (1), (2), (3)
        self.kick_onto_constraints(h) // (4), (5)
    }

    /// The first half kick and the drift, with the multipliers that close the joints at its end.
    pub(in crate::variational) fn drift_onto_constraints(&mut self, h: f64) -> Result<(), Failure> {
        self.begin_parts(h)?;
        self.solve_or_switch(h)?; // (3)
        self.accept_parts(h);
        let (now, trial) = (&mut self.now, &self.trial);
        for i in 1..self.chain.nodes.len() {
            self.memory.predictor.write(h, i, &now.pose[i], &trial.wrench[i]);
        }
        for (i, trial) in trial.bodies.iter().enumerate().skip(1) {
            let (body, pose) = (&mut now.bodies[i], &mut now.pose[i]);
            body.p.add(&trial.kick.linear); // (1)
            body.pi.add(&trial.kick.angular); // (1)
            body.x.add(&trial.motion.dx); // (2)
            // By the world vector with which the joints were measured: rounded apart from it, attitudes would leave
            // positions behind.
            body.q.add(&(turn_less_one(&trial.motion.s) * Quaternion::from(pose.q)).coords); // (2)
            body.q.add(&norm_defect(&body.q));
            *pose = Pose::new(&body.x, body.q.value);
        }
        self.place_joints();
        self.memory.predictor.advance(self.now.time.value.x);
        Ok(())
    }

    /// The second half kick, with the multipliers that make the twists fit the joints.
    pub(in crate::variational) fn kick_onto_constraints(&mut self, h: f64) -> Result<(), Failure> {
        self.factorise(h)?;
        self.project_momenta(h); // (4), (5)
        self.now.time.add(&SVector::<f64, 1>::new(h));
        Ok(())
    }

    /// Writes the present state: poses, and the twists that fit the joints.
    pub fn write_state(&self, out: &mut State) {
        self.now.write(out);
    }
}
