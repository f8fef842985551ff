//! The linear steps of a round: one of the chord iteration with the factorisation at the start, or one of Newton's
//! method.

use nalgebra::Vector3;

use crate::variational::chain::RelativeMotion;
use crate::variational::force::Parts;
use crate::variational::force::bond::Trying;
use crate::variational::rattle::Rattle;
use crate::variational::rattle::kick::kick_joint;
use crate::variational::tree::newton::closing_twist;
use crate::variational::tree::spatial::Twist;
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
        let (now, wrench) = (&mut self.now, &mut self.trial.wrench);
        if let Some(parts) = &mut self.parts {
            let tree = parts.implicit.as_mut().unwrap_or(&mut now.tree);
            loops.correct(h, tree, &now.frames, |i, f| wrench[i] += f);
            parts.loops = Some(loops);
        }
        self.kick(h);
    }

    /// The part of it that the tree does alone; `twist(i, v)` gets the twists at the joint points.
    fn correct_joints(&mut self, mut twist: impl FnMut(usize, &Twist)) {
        let (now, trial) = (&mut self.now, &mut self.trial);
        let Some(Parts { forces, implicit, excess, .. }) = self.parts.as_deref_mut() else { return };
        let (frames, bias, wrench) = (&now.frames, &trial.bias, &mut trial.wrench);
        let tree = implicit.as_mut().unwrap_or(&mut now.tree);
        let add = |i: usize, v: &Twist, f| {
            wrench[i] += f;
            twist(i, v);
        };
        if forces.is_empty() {
            tree.correct(frames, |i| bias[i], |_| Vector3::zeros(), add);
        } else {
            tree.correct(frames, |i| bias[i], |i| excess[i], add);
        }
    }

    /// On a tree where light bodies have impulses to balance.
    fn correct_loaded(&mut self, h: f64) {
        let Some(parts) = &mut self.parts else { return };
        let mut tree = std::mem::replace(parts.implicit.as_mut().unwrap_or(&mut self.now.tree), Tree::EMPTY);
        tree.load(&self.now.frames, |i| self.imbalance(i, h));
        let (bias, wrench) = (&self.trial.bias, &mut self.trial.wrench);
        let along = |i: usize| self.parts.as_ref().map_or(Vector3::zeros(), |parts| parts.excess[i]);
        tree.correct_loaded(&self.now.frames, |i| bias[i], along, |i, _, f| wrench[i] += f);
        self.correct_light(h, |rattle, i| tree.twist(i).twist_at(&-rattle.now.frames[i].arm));
        if let Some(parts) = &mut self.parts {
            *parts.implicit.as_mut().unwrap_or(&mut self.now.tree) = tree;
        }
        self.kick(h);
    }

    /// The exact linearisation at the present trial, for [`Rattle::correct_exactly`].
    ///
    /// # Errors
    /// A block that has no inverse.
    pub(super) fn linearise(&mut self, h: f64) -> Result<(), Singular> {
        let (nodes, now, newton, bodies) = (&self.chain.nodes, &self.now, &mut self.trial.newton, &self.trial.bodies);
        let (rules, motion) = (&self.memory.rules, |i: usize| bodies[i].motion);
        let inertia = |i: usize| {
            let (trial, r) = (&bodies[i], &now.pose[i].r);
            r * rules[i].inertia(&nodes[i].inertia, &trial.s, &trial.hm) * r.transpose()
        };
        let Some(parts) = &mut self.parts else {
            return newton.factorise(nodes, &now.frames, motion, inertia, |_| 0.0);
        };
        let implicit = |i: usize| nodes[i].force.map_or(0.0, |k| parts.forces[k].implicit(h));
        newton.factorise(nodes, &now.frames, motion, inertia, implicit)?;
        if let Some(loops) = &mut parts.loops {
            let at = Trying { nodes, pose: &now.pose, frames: &now.frames, motion: &motion };
            loops.factorise_exactly(newton, &at);
        }
        Ok(())
    }

    /// (3): one round with the factors of the last exact linearisation, and (1) with what it finds.
    pub(super) fn correct_exactly(&mut self, h: f64) {
        let gravity = self.first_kick(h);
        self.trial.newton.unload();
        if self.parts.is_some() {
            self.load_light(h);
        }
        let (nodes, frames, trial) = (&self.chain.nodes, &self.now.frames, &mut self.trial);
        let (wrench, bodies, newton) = (&mut trial.wrench, &mut trial.bodies, &mut trial.newton);
        for i in 1..nodes.len() {
            let (node, frame, carried) = (&nodes[i], &frames[i], &bodies[nodes[i].parent].motion);
            let moved = RelativeMotion::new(frame, &frames[node.parent].arm, &bodies[i].motion, carried);
            newton.close(i, closing_twist(&trial.bias[i], &moved.turn, carried));
        }
        let Some(parts) = &mut self.parts else {
            let kick = |i: usize, f| {
                wrench[i] += f;
                kick_joint(bodies, nodes, frames, i, &gravity, &wrench[i]);
            };
            return newton.solve(nodes, frames, |_| Vector3::zeros(), kick);
        };
        newton.solve(nodes, frames, |i| parts.excess[i], |i, f| wrench[i] += f);
        if let Some(loops) = &mut parts.loops {
            let at = Trying { nodes, pose: &self.now.pose, frames, motion: &|i| bodies[i].motion };
            loops.correct_exactly(h, newton, &at, |i, f| wrench[i] += f);
        }
        self.correct_light(h, |rattle, i| {
            let (arm, motion) = (&rattle.now.frames[i].arm, &rattle.trial.bodies[i].motion);
            rattle.trial.newton.motion(i).twist_at(&-(arm + motion.turned(arm)))
        });
        self.kick(h);
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
