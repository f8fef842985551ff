//! The linear steps of a round: a chord step with the factorisation at the start, or one of Newton's method.

use nalgebra::Vector3;

use super::{Failure, Gravity, Rattle, kick_joint};
use crate::variational::bonds::Trying;
use crate::variational::joints::Moved;
use crate::variational::newton::{Tried, turning_inertia};
use crate::variational::spatial::{Twist, Wrench};
use crate::variational::tree::{Singular, Tree};

impl Rattle {
    /// (3): one round of the chord iteration, and (1) with what it finds.
    pub(super) fn correct(&mut self, h: f64) {
        if let Some(mut loops) = self.loops.take() {
            let twist = loops.first_pass();
            self.correct_tree(None, |i, v| twist[i] = *v);
            let (tree, wrench) = (self.implicit.as_mut().unwrap_or(&mut self.tree), &mut self.wrench);
            loops.correct(h, tree, &self.nodes, &self.places, |i, f| wrench[i] += f);
            self.loops = Some(loops);
        } else if self.light.is_empty() {
            let gravity = self.carried.is_none().then(|| self.first_kick(h));
            let kicked = gravity.is_some();
            self.correct_tree(gravity, |_, _| ());
            if kicked {
                return;
            }
        } else {
            self.correct_loaded(h);
        }
        self.kick(h);
    }

    /// The part of it that the tree does alone, with (1) where `gravity` is given; `twist(i, v)` gets the twists at the joint points.
    fn correct_tree(&mut self, gravity: Option<Gravity>, mut twist: impl FnMut(usize, &Twist)) {
        let (nodes, places, bias, along) = (&self.nodes, &self.places, &self.bias, &self.along);
        let (wrench, trial) = (&mut self.wrench, &mut self.trial);
        let add = |i: usize, v: &Twist, f: Wrench| {
            wrench[i] += f;
            if let Some(gravity) = &gravity {
                kick_joint(trial, nodes, places, i, gravity, &wrench[i]);
            }
            twist(i, v);
        };
        let tree = self.implicit.as_mut().unwrap_or(&mut self.tree);
        if self.forces.is_empty() {
            tree.correct(nodes, places, |i| bias[i], |_| Vector3::zeros(), add);
        } else {
            tree.correct(nodes, places, |i| bias[i], |i| along[i], add);
        }
    }

    /// The same where light bodies have impulses to balance.
    fn correct_loaded(&mut self, h: f64) {
        let mut tree = std::mem::replace(self.implicit.as_mut().unwrap_or(&mut self.tree), Tree::EMPTY);
        tree.load(&self.nodes, &self.places, |i| self.imbalance(i, h));
        let (bias, along, wrench) = (&self.bias, &self.along, &mut self.wrench);
        tree.correct_loaded(&self.nodes, &self.places, |i| bias[i], |i| along[i], |i, _, f| wrench[i] += f);
        self.correct_light(h, |rattle, i| tree.twist(i).twist_at(&-rattle.places[i].arm));
        *self.implicit.as_mut().unwrap_or(&mut self.tree) = tree;
    }

    /// (3): one round of Newton's method with the exact linearisation.
    pub(super) fn relinearise_and_correct(&mut self, h: f64) -> Result<(), Failure> {
        for i in 1..self.nodes.len() {
            let (node, place, trial) = (&self.nodes[i], &self.places[i], &self.trial[i]);
            let parent = &self.trial[node.parent].motion;
            let k = self.rules[i].derivative(&node.inertia, &trial.s, &trial.hm);
            self.newton.tried[i] = Tried {
                motion: trial.motion,
                inertia: turning_inertia(&self.pose[i].r, &trial.s, &k),
                turn: Moved::new(place, &self.places[node.parent].arm, &trial.motion, parent).turn,
                locked: self.bias[i].scaled(-h),
                along: self.along[i],
                implicit: node.force.map_or(0.0, |k| self.forces[k].implicit(h)),
                kick: self.imbalance(i, h),
            };
        }
        let (wrench, trial) = (&mut self.wrench, &self.trial);
        let (nodes, places, newton) = (&self.nodes, &self.places, &mut self.newton);
        let mut solved = newton.correct(nodes, places, h, |i, f| wrench[i] += f);
        if let (Ok(()), Some(loops)) = (solved, &mut self.loops) {
            let at = Trying { nodes, pose: &self.pose, places, motion: &|i| trial[i].motion };
            solved = loops.correct_exactly(h, newton, &at, |i, f| wrench[i] += f);
        }
        solved.map_err(|Singular { node }| Failure::Singular { joint: node - 1 })?;
        self.correct_light(h, |rattle, i| {
            let (arm, motion) = (&rattle.places[i].arm, &rattle.trial[i].motion);
            rattle.newton.motion(i).twist_at(&-(arm + motion.turned(arm)))
        });
        Ok(())
    }
}
