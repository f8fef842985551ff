//! The end of a step: the factorisation in the new configuration, and the second half kick, (4) and (5) of [`super`].

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use super::{Failure, Gravity, RETURN, Rattle, add_joint_impulse, blocks, kick_joint};
use crate::variational::forces::JointForce;
use crate::variational::joints::{Node, Place, Pose, keep_locked, mismatch};
use crate::variational::method::Method;
use crate::variational::spatial::{Spatial, Wrench};
use crate::variational::tree::Singular;

impl Rattle {
    /// Places all joints in the present configuration.
    pub(super) fn place_joints(&mut self) {
        blocks(1..self.nodes.len()).for_each(|block| self.place_block(block));
    }

    /// Places the joints of a block of nodes in the present configuration, of which the nodes before have taken theirs.
    #[inline(always)]
    pub(super) fn place_block(&mut self, block: Range<usize>) {
        let (nodes, pose) = (&self.nodes, &self.pose);
        for i in block.clone() {
            let parent_arm = self.places[nodes[i].parent].arm;
            let (node, pose, parent) = (&nodes[i], &pose[i], &pose[nodes[i].parent]);
            self.places[i] = Place::new(node, pose, parent, &parent_arm);
            self.gap0[i] = mismatch(node, pose, parent).scaled(RETURN);
        }
        block.for_each(|i| self.tree.put_body(nodes, &self.places, i, &world_inertia(&nodes[i], &pose[i])));
    }

    /// Factorises with the joints as they have been placed, for the end of a step of size `h`.
    pub(super) fn factorise(&mut self, h: f64) -> Result<(), Failure> {
        let (nodes, pose, forces) = (&self.nodes, &self.pose, &self.forces);
        let late = |i: usize| if self.implicit.is_some() { late(nodes, forces, i, h) } else { 0.0 };
        self.tree
            .factorise_bodies(nodes, &self.places, late)
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
        let second = !(self.method == Method::Shake && h != 0.0);
        if second && self.forces.is_empty() && self.loops.is_none() {
            self.project_joints(&Gravity { time: part * h, field: self.gravity });
        } else {
            self.project_parts(h, part, second);
        }
        self.project_light();
        for (body, trial) in self.bodies.iter_mut().zip(&self.trial).skip(1) {
            body.p.add(&trial.kick.linear);
            body.pi.add(&trial.kick.angular);
        }
    }

    /// Where there is nothing but gravity and the joints of a tree.
    fn project_joints(&mut self, gravity: &Gravity) {
        let (nodes, places, bodies) = (&self.nodes, &self.places, &self.bodies);
        let (twist, wrench, trial) = (&mut self.twist, &mut self.wrench, &mut self.trial);
        self.tree.project(
            nodes,
            places,
            |i| Spatial::new(bodies[i].p.value + gravity.impulse(nodes[i].mass), bodies[i].pi.value),
            |i, v, f| {
                twist[i] = *v;
                wrench[i] = f;
                // The wrench is a difference of momenta: what roundoff leaves along the free directions would be a force there.
                keep_locked(&nodes[i], &places[i], &mut wrench[i]);
                kick_joint(trial, nodes, places, i, gravity, &wrench[i]);
            },
        );
    }

    fn project_parts(&mut self, h: f64, part: f64, second: bool) {
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
            // As above.
            if late(&self.nodes, &self.forces, i, h) == 0.0 {
                keep_locked(&self.nodes[i], &self.places[i], &mut self.wrench[i]);
            }
            if second {
                add_joint_impulse(&mut self.trial, &self.nodes, &self.places, i, &self.wrench[i]);
            }
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
