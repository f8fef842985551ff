//! The end of a step: the factorisation in the new configuration, and the second half kick, (4) and (5) of
//! [`super::step`].

use nalgebra::{Matrix3, Vector3};

use super::failure::Failure;
use super::kick::{Gravity, add_joint_impulse, kick_joint};
use super::state::Rattle;
use crate::variational::chain::{JointFrame, Node, Pose, keep_locked, mismatch};
use crate::variational::force::Parts;
use crate::variational::method::Method;
use crate::variational::tree::Singular;
use crate::variational::tree::spatial::{Spatial, Wrench};

/// The part of a joint's mismatch that one step takes away. The mismatch is a sum of roundoff over many steps; it is
/// known to roundoff of the positions only, so taking away all of it in every step would put that noise, divided by the
/// step, into the momenta. The noise has a bias, and the energy drifts in proportion to this rate: at 1e-3 a pendulum
/// loses 1.3e-20 of its energy scale a step, at 1e-4 2.8e-21, below that nothing is left of it.
pub(in crate::variational) const RETURN: f64 = 3e-5;

impl Rattle {
    /// Places all joints in the present configuration.
    pub(super) fn place_joints(&mut self) {
        let (nodes, now) = (&self.chain.nodes, &mut self.now);
        for i in 1..nodes.len() {
            let parent_arm = now.frames[nodes[i].parent].arm;
            let (node, pose, parent) = (&nodes[i], &now.pose[i], &now.pose[nodes[i].parent]);
            now.frames[i] = JointFrame::new(node, pose, parent, &parent_arm);
            now.gap0[i] = mismatch(node, pose, parent).scaled(RETURN);
        }
        for i in 1..nodes.len() {
            now.tree.put_body(nodes, &now.frames, i, &world_inertia(&nodes[i], &now.pose[i]));
        }
    }

    /// Factorises with the joints as they have been placed, for the end of a step of size `h`.
    ///
    /// # Errors
    /// [`Failure::Singular`] where a joint can move without moving any mass.
    pub(super) fn factorise(&mut self, h: f64) -> Result<(), Failure> {
        let (nodes, now) = (&self.chain.nodes, &mut self.now);
        let factorised = match &mut self.parts {
            None => now.tree.factorise_bodies(nodes, &now.frames, |_| 0.0),
            Some(parts) => now.tree.factorise_bodies(nodes, &now.frames, |i| parts.late(nodes, i, h)),
        };
        factorised.map_err(|Singular { node }| Failure::Singular { joint: node - 1 })?;
        if let Some(loops) = self.parts.as_mut().and_then(|parts| parts.loops.as_mut()) {
            loops.place(nodes, &now.pose, &now.frames, RETURN);
            loops.factorise(&now.tree, nodes, &now.frames, &mobility(nodes, &now.pose));
        }
        Ok(())
    }

    /// (4) and (5): the second half kick of a step of size `h`, and the joint impulses that make the twists fit.
    pub(in crate::variational) fn project_momenta(&mut self, h: f64) {
        let (_, part) = self.settings.method.parts();
        let second = !(self.settings.method == Method::Shake && h != 0.0);
        let gravity = Gravity { time: part * h, field: self.chain.gravity };
        if second && self.parts.as_ref().is_none_or(|parts| parts.is_tree_under_gravity()) {
            self.project_joints(&gravity);
        } else {
            self.project_parts(h, part, second);
        }
        self.project_light();
        for (body, trial) in self.now.bodies.iter_mut().zip(&self.trial.bodies).skip(1) {
            body.p.add(&trial.kick.linear); // (4)
            body.pi.add(&trial.kick.angular); // (4)
        }
    }

    /// Where there is nothing but gravity and the joints of a tree.
    fn project_joints(&mut self, gravity: &Gravity) {
        let (nodes, now) = (&self.chain.nodes, &mut self.now);
        let (frames, bodies, twist) = (&now.frames, &now.bodies, &mut now.twist);
        let (wrench, trial) = (&mut self.trial.wrench, &mut self.trial.bodies);
        // (5)
        now.tree.project(
            frames,
            |i| Spatial::new(bodies[i].p.value + gravity.impulse(nodes[i].mass), bodies[i].pi.value),
            |i, v, f| {
                twist[i] = *v;
                wrench[i] = f;
                // The wrench is a difference of momenta: what roundoff leaves along the free directions would be a
                // force there.
                keep_locked(&nodes[i], &frames[i], &mut wrench[i]);
                kick_joint(trial, nodes, frames, i, gravity, &wrench[i]);
            },
        );
    }

    /// The same with what acts along the joints and across the tree; `second` is whether the joints' impulses act.
    fn project_parts(&mut self, h: f64, part: f64, second: bool) {
        let (nodes, now) = (&self.chain.nodes, &mut self.now);
        let (frames, bodies, twist) = (&now.frames, &now.bodies, &mut now.twist);
        let (wrench, trial) = (&mut self.trial.wrench, &mut self.trial.bodies);
        for i in 1..nodes.len() {
            trial[i].kick = Spatial::new(part * h * nodes[i].mass * self.chain.gravity, Vector3::zeros());
        }
        if let Some(parts) = &mut self.parts {
            for (i, k) in Parts::forced(nodes) {
                let impulse = parts.forces[k].second_half(&nodes[i], &frames[i]);
                add_joint_impulse(trial, nodes, frames, i, &impulse);
            }
            if let Some(loops) = &mut parts.loops {
                if h != 0.0 {
                    loops.push_springs(frames, |i, impulse| trial[i].kick += impulse);
                }
                let first = loops.first_pass();
                let momentum = |i: usize| Spatial::new(bodies[i].p.value, bodies[i].pi.value) + trial[i].kick;
                now.tree.project(frames, momentum, |i, v, _| first[i] = *v);
                loops.project(frames, |i, impulse| trial[i].kick += impulse);
            }
        }
        // (5)
        now.tree.project(
            frames,
            |i| Spatial::new(bodies[i].p.value, bodies[i].pi.value) + trial[i].kick,
            |i, v, f| {
                twist[i] = *v;
                wrench[i] = f;
            },
        );
        for i in 1..nodes.len() {
            // As above.
            if self.parts.as_ref().is_none_or(|parts| parts.late(nodes, i, h) == 0.0) {
                keep_locked(&nodes[i], &frames[i], &mut wrench[i]);
            }
            if second {
                add_joint_impulse(trial, nodes, frames, i, &wrench[i]);
            }
        }
    }
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
