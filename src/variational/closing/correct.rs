//! The linear steps of a round: one of the chord iteration with the factorisation at the start, or one of Newton's method.

use nalgebra::Vector3;

use crate::variational::chain::RelativeMotion;
use crate::variational::force::Parts;
use crate::variational::force::bond::Trying;
use crate::variational::rattle::Rattle;
use crate::variational::rattle::kick::kick_joint;
use crate::variational::tree::newton::{Tried, turning_inertia};
use crate::variational::tree::spatial::{Spatial, Twist};
use crate::variational::tree::{Singular, Tree};

impl Rattle {
    /// (3): one round of the chord iteration, and (1) with what it finds.
    pub(super) fn correct(&mut self, h: f64) {
        match &self.parts {
            None => self.correct_plain(h),
            Some(parts) if parts.loops.is_some() => self.correct_across(h),
            Some(parts) if parts.light.is_empty() => self.correct_forced(h),
            Some(_) => self.correct_loaded(h),
        }
    }

    /// On a plain tree, with (1) in the same sweep.
    fn correct_plain(&mut self, h: f64) {
        let gravity = self.first_kick(h);
        let (nodes, now, trial) = (&self.chain.nodes, &mut self.now, &mut self.trial);
        let (frames, bias, wrench, bodies) = (&now.frames, &trial.bias, &mut trial.wrench, &mut trial.bodies);
        now.tree.correct(
            nodes,
            frames,
            |i| bias[i],
            |_| Vector3::zeros(),
            |i, _, f| {
                wrench[i] += f;
                kick_joint(bodies, nodes, frames, i, &gravity, &wrench[i]);
            },
        );
    }

    /// On a tree with forces along its joints.
    fn correct_forced(&mut self, h: f64) {
        self.correct_joints(|_, _| ());
        self.kick(h);
    }

    /// Across a tree: the tree alone first, then the impulses along the rows, to which it answers.
    fn correct_across(&mut self, h: f64) {
        let Some(mut loops) = self.parts.as_mut().and_then(|parts| parts.loops.take()) else { return };
        let twist = loops.first_pass();
        self.correct_joints(|i, v| twist[i] = *v);
        let (nodes, now, wrench) = (&self.chain.nodes, &mut self.now, &mut self.trial.wrench);
        if let Some(parts) = &mut self.parts {
            let tree = parts.implicit.as_mut().unwrap_or(&mut now.tree);
            loops.correct(h, tree, nodes, &now.frames, |i, f| wrench[i] += f);
            parts.loops = Some(loops);
        }
        self.kick(h);
    }

    /// The part of it that the tree does alone; `twist(i, v)` gets the twists at the joint points.
    fn correct_joints(&mut self, mut twist: impl FnMut(usize, &Twist)) {
        let (nodes, now, trial) = (&self.chain.nodes, &mut self.now, &mut self.trial);
        let Some(Parts { forces, implicit, excess, .. }) = self.parts.as_deref_mut() else { return };
        let (frames, bias, wrench) = (&now.frames, &trial.bias, &mut trial.wrench);
        let tree = implicit.as_mut().unwrap_or(&mut now.tree);
        let add = |i: usize, v: &Twist, f| {
            wrench[i] += f;
            twist(i, v);
        };
        if forces.is_empty() {
            tree.correct(nodes, frames, |i| bias[i], |_| Vector3::zeros(), add);
        } else {
            tree.correct(nodes, frames, |i| bias[i], |i| excess[i], add);
        }
    }

    /// On a tree where light bodies have impulses to balance.
    fn correct_loaded(&mut self, h: f64) {
        let Some(parts) = &mut self.parts else { return };
        let mut tree = std::mem::replace(parts.implicit.as_mut().unwrap_or(&mut self.now.tree), Tree::EMPTY);
        tree.load(&self.chain.nodes, &self.now.frames, |i| self.imbalance(i, h));
        let (bias, wrench) = (&self.trial.bias, &mut self.trial.wrench);
        let along = |i: usize| self.parts.as_ref().map_or(Vector3::zeros(), |parts| parts.excess[i]);
        tree.correct_loaded(&self.chain.nodes, &self.now.frames, |i| bias[i], along, |i, _, f| wrench[i] += f);
        self.correct_light(h, |rattle, i| tree.twist(i).twist_at(&-rattle.now.frames[i].arm));
        if let Some(parts) = &mut self.parts {
            *parts.implicit.as_mut().unwrap_or(&mut self.now.tree) = tree;
        }
        self.kick(h);
    }

    /// (3): one round of Newton's method with the exact linearisation, and (1) with what it finds.
    ///
    /// # Errors
    /// A block that has no inverse.
    pub(super) fn correct_exactly(&mut self, h: f64) -> Result<(), Singular> {
        self.linearise(h);
        let (nodes, now) = (&self.chain.nodes, &self.now);
        let (newton, wrench, bodies) = (&mut self.trial.newton, &mut self.trial.wrench, &self.trial.bodies);
        newton.correct(nodes, &now.frames, h, |i, f| wrench[i] += f)?;
        if let Some(loops) = self.parts.as_mut().and_then(|parts| parts.loops.as_mut()) {
            let at = Trying { nodes, pose: &now.pose, frames: &now.frames, motion: &|i| bodies[i].motion };
            loops.correct_exactly(h, newton, &at, |i, f| wrench[i] += f)?;
        }
        self.correct_light(h, |rattle, i| {
            let (arm, motion) = (&rattle.now.frames[i].arm, &rattle.trial.bodies[i].motion);
            rattle.trial.newton.motion(i).twist_at(&-(arm + motion.turned(arm)))
        });
        self.kick(h);
        Ok(())
    }

    /// Hands the configuration that is being tried to the exact linearisation.
    fn linearise(&mut self, h: f64) {
        for i in 1..self.chain.nodes.len() {
            let (node, frame, trial) = (&self.chain.nodes[i], &self.now.frames[i], &self.trial.bodies[i]);
            let parent = &self.trial.bodies[node.parent].motion;
            let k = self.memory.rules[i].derivative(&node.inertia, &trial.s, &trial.hm);
            let parts = self.parts.as_deref();
            self.trial.newton.tried[i] = Tried {
                motion: trial.motion,
                inertia: turning_inertia(&self.now.pose[i].r, &trial.s, &k),
                turn: RelativeMotion::new(frame, &self.now.frames[node.parent].arm, &trial.motion, parent).turn,
                locked: self.trial.bias[i].scaled(-h),
                along: parts.map_or(Vector3::zeros(), |parts| parts.excess[i]),
                implicit: parts.map_or(0.0, |parts| node.force.map_or(0.0, |k| parts.forces[k].implicit(h))),
                kick: parts.map_or(Spatial::ZERO, |_| self.imbalance(i, h)),
            };
        }
    }

    /// (1) with the present wrenches.
    fn kick(&mut self, h: f64) {
        let gravity = self.first_kick(h);
        let (nodes, trial) = (&self.chain.nodes, &mut self.trial);
        // Parents come before their children.
        for i in 1..nodes.len() {
            kick_joint(&mut trial.bodies, nodes, &self.now.frames, i, &gravity, &trial.wrench[i]);
        }
        self.kick_parts();
    }
}
