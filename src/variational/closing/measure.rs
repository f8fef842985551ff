//! The drift of a trial, and what it leaves open of the constraints.

use nalgebra::Vector3;

use super::progress::Measured;
use crate::variational::chain::{RelativeMotion, coordinates_of};
use crate::variational::force::Parts;
use crate::variational::rattle::failure::Open;
use crate::variational::rattle::project::RETURN;
use crate::variational::rattle::{Failure, Rattle};

impl Rattle {
    /// (2) after the last correction. Springs, drives and loops keep what they measure for the second half kick.
    pub(super) fn drift_at_last(&mut self, h: f64) -> Result<(), Failure> {
        match &self.parts {
            None => self.drift(h),
            Some(_) => self.drift_and_measure(h).map(drop),
        }
    }

    /// (2), and what it leaves open of (3).
    pub(super) fn drift_and_measure(&mut self, h: f64) -> Result<Measured, Failure> {
        let measured = match &self.parts {
            None => {
                self.drift(h)?;
                self.measure_joints(h, |rattle, i| rattle.roundoff_of_motion(h, i))
            }
            Some(_) => {
                self.drift_heavy(h)?;
                let mut measured = self.measure_joints(h, |rattle, i| {
                    if rattle.chain.nodes[i].light { 0.0 } else { rattle.roundoff_of_motion(h, i) }
                });
                self.measure_parts(h, &mut measured);
                measured
            }
        };
        if measured.residual.is_finite() {
            return Ok(measured);
        }
        match measured.place {
            Open::Joint(body) => Err(Failure::NotFinite { body }),
            Open::Loop(_) => Err(Failure::NotFinite { body: 0 }),
        }
    }

    /// (2) for all nodes.
    fn drift(&mut self, h: f64) -> Result<(), Failure> {
        (1..self.chain.nodes.len()).try_for_each(|i| self.drift_body(h, i))
    }

    /// The same but for light bodies, which are moved by their twists.
    fn drift_heavy(&mut self, h: f64) -> Result<(), Failure> {
        for i in 1..self.chain.nodes.len() {
            if !self.chain.nodes[i].light {
                self.drift_body(h, i)?;
            }
        }
        Ok(())
    }

    /// The joints' mismatch over `-h`; `roundoff` is what it may do to the motion of a body, over `f64::EPSILON`, m.
    #[inline(always)]
    fn measure_joints(&mut self, h: f64, roundoff_of: impl Fn(&Rattle, usize) -> f64) -> Measured {
        // Of a system at rest, what is taken back of the mismatch is all that there is to be resolved.
        let (mut worst, mut joint, mut roundoff) = (0.0, 0, RETURN * self.chain.length);
        for i in 1..self.chain.nodes.len() {
            let (size, noise) = (self.measure_joint(h, i), roundoff_of(self, i));
            // What is not a number stays the worst.
            if size > worst || !(size + noise).is_finite() {
                (worst, joint) = (size + 0.0 * noise, i - 1);
            }
            roundoff = noise.max(roundoff);
        }
        Measured { place: Open::Joint(joint), residual: worst, roundoff: f64::EPSILON * roundoff }
    }

    /// (2)
    #[inline(always)]
    fn drift_body(&mut self, h: f64, i: usize) -> Result<(), Failure> {
        let (node, body, pose) = (&self.chain.nodes[i], &self.now.bodies[i], &self.now.pose[i]);
        let trial = &mut self.trial.bodies[i];
        trial.motion.dx = body.p.plus(&trial.kick.linear) * (h / node.mass);
        let hm = h * pose.r.tr_mul(&body.pi.plus(&trial.kick.angular));
        let start = trial.s + 0.5 * (hm - trial.hm).component_div(&node.inertia);
        trial.s = match self.memory.rules[i].solve(&node.inertia, &hm, &start) {
            Some(s) => s,
            None => {
                let angle = hm.component_div(&node.inertia).norm();
                (trial.s, trial.hm) = (Vector3::zeros(), Vector3::zeros());
                return Err(Failure::Rotation { body: i - 1, angle });
            }
        };
        trial.hm = hm;
        trial.motion.s = pose.r * trial.s;
        Ok(())
    }

    /// A joint's mismatch, m; angles times the system's length.
    #[inline(always)]
    fn measure_joint(&mut self, h: f64, i: usize) -> f64 {
        let (node, frame, trial) = (&self.chain.nodes[i], &self.now.frames[i], &mut self.trial);
        let parent = &trial.bodies[node.parent].motion;
        let moved = RelativeMotion::new(frame, &self.now.frames[node.parent].arm, &trial.bodies[i].motion, parent);
        let gap = moved.locked(node, frame, parent) + self.now.gap0[i];
        let size = gap.linear.norm() + self.chain.length * gap.angular.norm();
        trial.bias[i] = gap.scaled(-1.0 / h);
        size
    }

    /// What roundoff may do to the motion of a body, over `f64::EPSILON`, m.
    #[inline(always)]
    fn roundoff_of_motion(&self, h: f64, i: usize) -> f64 {
        let (node, trial) = (&self.chain.nodes[i], &self.trial.bodies[i]);
        let pull = self.trial.wrench[i].linear.norm() * (h.abs() / node.mass);
        trial.motion.dx.norm() + self.chain.length * trial.hm.norm() * node.thinnest + pull
    }

    /// The same for springs, drives and light bodies, by how far they move what they act on, and for what holds across
    /// the tree.
    fn measure_parts(&mut self, h: f64, most: &mut Measured) {
        self.measure_joint_forces(h, most);
        if self.parts.as_ref().is_some_and(|parts| !parts.light.is_empty()) {
            let (body, size, roundoff) = self.measure_imbalance(h);
            most.roundoff = most.roundoff.max(roundoff);
            if !(size <= most.residual) {
                (most.residual, most.place) = (size, Open::Joint(body));
            }
        }
        let (bodies, chain) = (&self.trial.bodies, &self.chain);
        if let Some(loops) = self.parts.as_mut().and_then(|parts| parts.loops.as_mut()) {
            let worst = loops.measure(h, &chain.nodes, &self.now.frames, &|i| bodies[i].motion, chain.length);
            most.roundoff = most.roundoff.max(f64::EPSILON * worst.roundoff);
            if !(worst.size <= most.residual) {
                (most.residual, most.place) = (worst.size, Open::Loop(worst.bond));
            }
        }
    }

    /// What acts along the joints: by how far the joint would move if the impulse were right.
    fn measure_joint_forces(&mut self, h: f64, most: &mut Measured) {
        let (chain, now, trial) = (&self.chain, &self.now, &self.trial);
        let Some(parts) = &mut self.parts else { return };
        for (i, k) in Parts::forced(&chain.nodes) {
            let (node, frame) = (&chain.nodes[i], &now.frames[i]);
            let (motion, carried) = (&trial.bodies[i].motion, &trial.bodies[node.parent].motion);
            let travel =
                RelativeMotion::new(frame, &now.frames[node.parent].arm, motion, carried).travel(node, frame, carried);
            let impulse = coordinates_of(node, frame, &trial.wrench[i]);
            parts.excess[i] = parts.forces[k].excess(travel, impulse);
            // By how much a unit impulse along the joint moves it, times the system's length for an angle.
            let weight = if node.slides() { 1.0 } else { chain.length };
            let effect = h.abs() * (weight * parts.tree(&now.tree).compliance(i));
            let size = effect * parts.excess[i].norm();
            if size > most.residual || !size.is_finite() {
                (most.residual, most.place) = (size, Open::Joint(i - 1));
            }
            most.roundoff = most.roundoff.max(f64::EPSILON * (effect * impulse.norm()));
        }
    }
}
