//! The end of a step: the factorisation in the new configuration, and the second half kick, (4) and (5) of [`super`].

use nalgebra::{Matrix3, Vector3};

use super::{Failure, RETURN, Rattle, add_joint_impulse};
use crate::variational::forces::JointForce;
use crate::variational::joints::{Node, Place, Pose, keep_locked, mismatch};
use crate::variational::method::Method;
use crate::variational::spatial::{Spatial, Wrench};
use crate::variational::tree::Singular;

impl Rattle {
    /// Places the joints in the present configuration and factorises there, for the end of a step of size `h`.
    pub(super) fn factorise(&mut self, h: f64) -> Result<(), Failure> {
        for i in 1..self.nodes.len() {
            let parent = self.nodes[i].parent;
            let parent_arm = self.places[parent].arm;
            let (node, pose, parent) = (&self.nodes[i], &self.pose[i], &self.pose[parent]);
            self.places[i] = Place::new(node, pose, parent, &parent_arm);
            self.gap0[i] = mismatch(node, pose, parent).scaled(RETURN);
        }
        let (nodes, pose, forces) = (&self.nodes, &self.pose, &self.forces);
        let late = |i: usize| if self.implicit.is_some() { late(nodes, forces, i, h) } else { 0.0 };
        self.tree
            .factorise(nodes, &self.places, |i| world_inertia(&nodes[i], &pose[i]), late)
            .map_err(|Singular { node }| Failure::Singular { joint: node - 1 })?;
        if let Some(loops) = &mut self.loops {
            loops.place(nodes, pose, &self.places, RETURN);
            loops.factorise(&self.tree, nodes, &self.places, &mobility(nodes, pose));
        }
        Ok(())
    }

    /// (4) and (5): the second half kick of a step of size `h`, and the joint impulses that make the twists fit.
    pub(super) fn project_momenta(&mut self, h: f64) {
        let (_, part) = self.method.parts();
        let (nodes, bodies, twist, wrench) = (&self.nodes, &self.bodies, &mut self.twist, &mut self.wrench);
        for i in 1..nodes.len() {
            self.trial[i].kick = Spatial::new(part * h * nodes[i].mass * self.gravity, Vector3::zeros());
        }
        if !self.forces.is_empty() {
            for (i, k) in (1..nodes.len()).filter_map(|i| Some((i, nodes[i].force?))) {
                let impulse = self.forces[k].second_half(&nodes[i], &self.places[i]);
                add_joint_impulse(&mut self.trial, nodes, &self.places, i, &impulse);
            }
        }
        if let Some(loops) = &mut self.loops {
            if h != 0.0 {
                loops.push_springs(&self.places, |i, impulse| self.trial[i].kick += impulse);
            }
            let (trial, first) = (&self.trial, loops.first_pass());
            let momentum = |i: usize| Spatial::new(bodies[i].p.value, bodies[i].pi.value) + trial[i].kick;
            self.tree.project(nodes, &self.places, momentum, |i, v, _| first[i] = *v);
            loops.project(&self.places, |i, impulse| self.trial[i].kick += impulse);
        }
        let trial = &self.trial;
        self.tree.project(
            nodes,
            &self.places,
            |i| Spatial::new(bodies[i].p.value, bodies[i].pi.value) + trial[i].kick,
            |i, v, f| {
                twist[i] = *v;
                wrench[i] = f;
            },
        );
        for i in 1..self.nodes.len() {
            // The wrench is a difference of momenta: what roundoff leaves along the free directions would be a force there.
            if late(&self.nodes, &self.forces, i, h) == 0.0 {
                keep_locked(&self.nodes[i], &self.places[i], &mut self.wrench[i]);
            }
            if self.method == Method::Shake && h != 0.0 {
                continue;
            }
            add_joint_impulse(&mut self.trial, &self.nodes, &self.places, i, &self.wrench[i]);
        }
        self.project_light();
        for (body, trial) in self.bodies.iter_mut().zip(&self.trial).skip(1) {
            body.p.add(&trial.kick.linear);
            body.pi.add(&trial.kick.angular);
        }
    }
}

/// What the force of a joint adds to `D` at the end of a step of size `h`.
#[inline(always)]
fn late(nodes: &[Node], forces: &[JointForce], i: usize, h: f64) -> f64 {
    nodes[i].force.map_or(0.0, |k| forces[k].late(h))
}

/// `w M^-1 w` of a wrench about the centre of mass of a free body.
pub(super) fn mobility(nodes: &[Node], pose: &[Pose]) -> impl Fn(usize, &Wrench) -> f64 {
    |i, wrench| {
        let torque = pose[i].r.tr_mul(&wrench.angular);
        let turning = torque.component_mul(&torque).component_div(&nodes[i].inertia).sum();
        wrench.linear.norm_squared() / nodes[i].mass + turning
    }
}

/// Inertia about the centre of mass in world axes.
#[inline(always)]
pub(in crate::variational) fn world_inertia(node: &Node, pose: &Pose) -> Matrix3<f64> {
    let mut scaled = pose.r;
    for k in 0..3 {
        scaled.column_mut(k).scale_mut(node.inertia[k]);
    }
    scaled * pose.r.transpose()
}
