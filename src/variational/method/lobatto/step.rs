//! A step: predict the multipliers, close the joints at all stages, go to the last of them, project the momenta.

use nalgebra::{Matrix3, Quaternion, Vector3};

use super::integrator::Lobatto;
use super::matrix::{cayley_vector, twice_skew};
use super::tableau::MOST_STAGES;
use crate::mechanics::State;
use crate::variational::chain::{JointFrame, Pose, keep_locked};
use crate::variational::map::{Map, OwnStep};
use crate::variational::rattle::{Failure, Rattle, norm_defect, turn_less_one};
use crate::variational::tree::spatial::Spatial;

impl Lobatto {
    /// Takes one step of size `h` (s). After a failure the state is the one before the step, but for
    /// [`Failure::Singular`], which is found at the end of the step.
    ///
    /// # Errors
    /// [`Failure::Constraint`], [`Failure::NotFinite`], [`Failure::Singular`].
    pub fn step(&mut self, h: f64) -> Result<(), Failure> {
        self.predict(h);
        if self.iterate(h).is_err() {
            self.forget();
            if let Err(failure) = self.iterate(h) {
                self.forget();
                return Err(failure);
            }
        }
        self.last_step = h;
        for i in 1..self.nodes.len() {
            let (linear, angular) = self.impulse(i, h);
            let end = self.tableau.stages - 1;
            let dx = self.stages[i * self.tableau.stages + end].dx;
            let s = cayley_vector(&self.attitudes[i].turn[end]);
            let (body, pose) = (&mut self.bodies[i], &mut self.pose[i]);
            body.p.add(&linear);
            body.pi.add(&(pose.r * angular));
            body.x.add(&dx);
            body.q.add(&(Quaternion::from(pose.q) * turn_less_one(&s)).coords);
            body.q.add(&norm_defect(&body.q));
            *pose = Pose::new(&body.x, body.q.value);
        }
        self.factorise()?;
        self.project_momenta();
        Ok(())
    }

    /// Starts the multipliers from the polynomial through those of the last step.
    fn predict(&mut self, h: f64) {
        let s = self.tableau.stages;
        if self.last_step != h {
            self.forget();
            return;
        }
        for (node, stages) in self.nodes.iter().zip(self.stages.chunks_exact_mut(s)) {
            let mut old = [Spatial::ZERO; MOST_STAGES];
            for (old, stage) in old.iter_mut().zip(stages.iter()) {
                *old = stage.wrench;
            }
            for (k, stage) in stages.iter_mut().enumerate().take(s - 1) {
                stage.wrench = Spatial::ZERO;
                for (weight, wrench) in self.tableau.ahead[k].iter().zip(&old).take(s - 1) {
                    stage.wrench += wrench.scaled(*weight);
                }
                // Extrapolation would let the roundoff along the free directions grow from step to step.
                keep_locked(node, &JointFrame::GROUND, &mut stage.wrench);
            }
        }
        for attitude in &mut self.attitudes[1..] {
            attitude.predict(&self.tableau);
        }
    }

    /// Starts the multipliers from zero.
    fn forget(&mut self) {
        self.last_step = 0.0;
        for stage in &mut self.stages {
            (stage.wrench, stage.dx) = (Spatial::ZERO, Vector3::zeros());
        }
        for attitude in &mut self.attitudes[1..] {
            attitude.forget();
            attitude.turn = [Matrix3::zeros(); MOST_STAGES];
        }
    }

    /// (3) without the last stage's multipliers: the impulse on the body (N s), and the change of its spin in its frame
    /// at the start: `hat(pi) = P F^T - F P^T` with `P = Rdot Jd`.
    fn impulse(&self, i: usize, h: f64) -> (Vector3<f64>, Vector3<f64>) {
        let (attitude, s) = (&self.attitudes[i], self.tableau.stages);
        let jd = attitude.jd();
        let mut linear = self.gravity * (h * self.nodes[i].mass);
        let mut change = Matrix3::zeros();
        for k in 0..s - 1 {
            linear += self.stages[i * s + k].load.linear * (h * self.tableau.b[k]);
            change += attitude.x[k] * jd * (self.tableau.b[k] / h);
        }
        let turn = &attitude.turn[s - 1];
        let end = Matrix3::identity() + turn;
        let x = self.body_velocity(i).cross_matrix() * jd * turn.transpose() + change * end.transpose();
        (linear, twice_skew(&x))
    }
}

impl Map for Lobatto {
    const STAYS_ON_FAILURE: bool = true;

    fn step(&mut self, h: f64) -> Result<(), Failure> {
        Lobatto::step(self, h)
    }

    fn write_state(&self, out: &mut State) {
        Lobatto::write_state(self, out);
    }

    fn rattle(&self) -> Option<&Rattle> {
        None
    }

    fn before_failure(&self, _h: f64) -> Option<Lobatto> {
        Some(self.clone())
    }

    fn own_step(&self) -> Option<OwnStep> {
        None
    }
}
