//! Bodies and joints at the stages, for given forces of the joints there.

use nalgebra::{Matrix3, Vector3};

use super::attitude::MOST_ITERATIONS;
use super::integrator::Lobatto;
use super::matrix::cayley_vector;
use super::tableau::MOST_STAGES;
use crate::variational::chain::{JointFrame, Motion, Pose};
use crate::variational::rattle::Failure;
use crate::variational::tree::spatial::Spatial;

impl Lobatto {
    /// Places the joints in every stage and puts their forces on the bodies.
    pub(super) fn place_and_load(&mut self) {
        let s = self.tableau.stages;
        for k in 0..s {
            for i in 1..self.nodes.len() {
                let parent = self.nodes[i].parent;
                let parent_arm = self.stages[parent * s + k].frame.arm;
                let (pose, above) = (self.pose_at(i, k), self.pose_at(parent, k));
                self.stages[i * s + k].frame = JointFrame::new(&self.nodes[i], &pose, &above, &parent_arm);
                self.stages[i * s + k].load = Spatial::ZERO;
                self.stages[i * s + k].virial = Matrix3::zeros();
            }
            for i in 1..self.nodes.len() {
                let (stage, parent) = (self.stages[i * s + k], self.nodes[i].parent);
                let axes = &stage.frame.axes;
                let wrench = Spatial::new(axes * stage.wrench.linear, axes * stage.wrench.angular);
                let force = self.pose[i].r.tr_mul(&wrench.linear);
                self.stages[i * s + k].load += wrench;
                self.stages[i * s + k].virial += force * self.nodes[i].mount.arm.transpose();
                if parent > 0 {
                    let arm = self.stages[parent * s + k].frame.arm + stage.frame.offset;
                    let arm = self.pose_at(parent, k).r.tr_mul(&arm);
                    let force = self.pose[parent].r.tr_mul(&wrench.linear);
                    self.stages[parent * s + k].load -= wrench;
                    self.stages[parent * s + k].virial -= force * arm.transpose();
                }
            }
        }
    }

    pub(super) fn pose_at(&self, node: usize, k: usize) -> Pose {
        let (pose, stage) = (&self.pose[node], &self.stages[node * self.tableau.stages + k]);
        if node == 0 {
            return Pose::GROUND;
        }
        pose.moved(&stage.dx, pose.r + pose.r * self.attitudes[node].turn[k])
    }

    /// (1) and (2) with the present forces of the joints.
    pub(super) fn move_stages(&mut self, h: f64) -> Result<(), Failure> {
        let s = self.tableau.stages;
        for i in 1..self.nodes.len() {
            let omega = self.body_velocity(i) * h;
            let mass = self.nodes[i].mass;
            let velocity = self.bodies[i].p.value / mass;
            let mut forces = [(Vector3::zeros(), Matrix3::zeros()); MOST_STAGES];
            for (k, (torque, virial)) in forces.iter_mut().enumerate().take(s - 1) {
                let (f, stage) = (Matrix3::identity() + self.attitudes[i].turn[k], &self.stages[i * s + k]);
                *torque = f.tr_mul(&self.pose[i].r.tr_mul(&stage.load.angular)) * (h * h);
                *virial = stage.virial * (h * h);
            }
            self.attitudes[i].solve(&self.tableau, &omega, &forces).map_err(|change| Failure::Constraint {
                joint: i - 1,
                rounds: MOST_ITERATIONS,
                residual: self.length * change,
            })?;
            for k in 1..s {
                let mut dx = velocity * (h * self.tableau.c[k]);
                for j in 0..s - 1 {
                    let acceleration = self.stages[i * s + j].load.linear / mass + self.gravity;
                    dx += acceleration * (h * h * self.tableau.product[k][j]);
                }
                self.stages[i * s + k].dx = dx;
            }
        }
        Ok(())
    }

    /// `Omega = J^-1 R^T pi` at the start of the step.
    pub(super) fn body_velocity(&self, i: usize) -> Vector3<f64> {
        self.pose[i].r.tr_mul(&self.bodies[i].pi.value).component_div(&self.nodes[i].inertia)
    }

    pub(super) fn motion(&self, node: usize, k: usize) -> Motion {
        if node == 0 {
            return Motion::NONE;
        }
        let stage = &self.stages[node * self.tableau.stages + k];
        Motion { dx: stage.dx, s: self.pose[node].r * cayley_vector(&self.attitudes[node].turn[k]) }
    }
}
