//! The constraints at the end of the drift, (1) to (3) of [`super`]: predict, drift, measure, correct, until roundoff.

use nalgebra::Vector3;

use super::decline::Decline;
use super::failure::Open;
use super::leaps::KICKED;
use super::tail::Tail;
use super::{Failure, Gravity, RETURN, Rattle, blocks, kick_joint};
use crate::mechanics::JointKind;
use crate::variational::joints::{Moved, coordinates_of, keep_locked};
use crate::variational::loops::Worst;
use crate::variational::spatial::Spatial;

/// Rounds of the chord iteration after which a step is given up.
pub(in crate::variational) const MOST_ROUNDS: usize = 60;

/// The iteration ends with a correction that is predicted to leave this part of the roundoff of the motions. That is estimated
/// for the thinnest axes, and what is left has the same sign for many steps.
const NEGLIGIBLE: f64 = 1e-4;

/// Or, on a tree, with the correction of a residual that is this part of roundoff. A linkage, which repeats its motion, lost
/// 2.2e-20 of its energy scale a solve by that on average; with [`NEGLIGIBLE`] alone it loses at most 1.3e-21.
const SETTLED: f64 = 0.3;

/// Stagnation is one of roundoff where the residual is at most so many times the estimate of it. The exact linearisation stops contracting
/// at roundoff only, wherever the estimate puts that.
pub(super) fn stagnation(exact: bool) -> f64 {
    if exact { 1e4 } else { 64.0 }
}

impl Rattle {
    /// Finds the wrenches with which the joints hold at the end of the drift: (1) to (3).
    pub(super) fn solve_constraints(&mut self, h: f64) -> Result<(), Failure> {
        // A high degree starts closer, a low one survives a violent moment.
        let mut degree = self.predictor.degree().filter(|_| self.carried.is_none());
        loop {
            if let Some(loops) = &mut self.loops {
                loops.predict(self.time.value.x, h, degree);
            }
            self.predict(h, degree);
            match (self.iterate(h, if degree.is_some() { KICKED.0 } else { KICKED.1 }), degree) {
                (Err(_), Some(used)) => degree = (used > 0).then_some(used / 2),
                (result, _) => return result,
            }
        }
    }

    /// (1) with wrenches extrapolated by a polynomial of the given degree, or with none.
    fn predict(&mut self, h: f64, degree: Option<usize>) {
        let (gravity, nodes, wrench) = (self.first_kick(h), &self.nodes, &mut self.wrench);
        let weights = degree.map(|degree| self.predictor.weights(self.time.value.x, h, degree));
        for block in blocks(1..nodes.len()) {
            for i in block.clone() {
                wrench[i] = weights.map_or(Spatial::ZERO, |w| self.predictor.impulse(&w, i, &self.pose[i]));
            }
            for i in block.clone().filter(|&i| nodes[i].force.is_none()) {
                keep_locked(&nodes[i], &self.places[i], &mut wrench[i]);
            }
            block.for_each(|i| kick_joint(&mut self.trial, nodes, &self.places, i, &gravity, &wrench[i]));
        }
        self.kick_more();
    }

    /// The chord iteration, down to roundoff; `kicked` is the bound of [`Rattle::refuse_leap`].
    fn iterate(&mut self, h: f64, kicked: f64) -> Result<(), Failure> {
        let (mut last, mut rounds, mut exact) = (f64::INFINITY, 0, false);
        let mut decline = self.unbiased.then(|| Decline::new(self.contraction * h.abs()));
        // Where the joints of a long chain have closed but for those near its base, the others wait; see `tail`.
        let (mut tail, mut whole): (Option<Tail>, bool) = (None, !self.may_wait());
        self.start_light(h);
        loop {
            let end = tail.as_ref().map_or(self.nodes.len(), |tail| tail.first);
            let (mut place, mut residual, mut roundoff) = self.drift_and_measure(h, end)?;
            if let Some(worst) = self.measure_loops(h) {
                roundoff = roundoff.max(f64::EPSILON * worst.roundoff);
                if !(worst.size <= residual) {
                    (place, residual) = (Open::Loop(worst.bond), worst.size);
                }
            }
            if !residual.is_finite() {
                let body = if let Open::Joint(body) = place { body } else { 0 };
                return Err(Failure::NotFinite { body });
            }
            let (closed, last_round, hidden) = match &mut decline {
                Some(decline) => {
                    decline.follow(residual, roundoff, exact);
                    if let Some(rate) = decline.seen().filter(|_| !exact) {
                        self.contraction = rate / h.abs();
                    }
                    let ends = decline.ends() || (decline.hidden() && rounds + 1 >= MOST_ROUNDS);
                    (residual <= self.tolerance, ends, decline.hidden())
                }
                None => {
                    let stagnant = residual > 0.3 * last && residual <= stagnation(exact) * roundoff;
                    // What a residual at roundoff leaves out has the same sign for many steps: the energy drifts unless it is corrected.
                    let contraction = if rounds == 0 { 1.0 } else { residual / last };
                    (stagnant || residual <= self.tolerance, self.is_last(residual, contraction, roundoff), false)
                }
            };
            if closed && tail.is_none() {
                return self.refuse_false_solutions(h, rounds, exact.then_some(kicked));
            }
            let slow = residual > 0.2 * last && !hidden;
            if rounds == MOST_ROUNDS || (exact && rounds > 8 && residual > 0.9 * last && !hidden) {
                return Err(place.failure(rounds, residual));
            }
            if tail.is_none() && !(whole || exact || last_round || rounds == 0) {
                tail = self.settled_tail(roundoff);
            }
            if let Some(waiting) = &mut tail {
                (rounds, self.rounds) = (rounds + 1, self.rounds + 1);
                let rests = self.still_settled(waiting, h, roundoff);
                if rests && (last_round || closed) {
                    self.correct_all(waiting, h);
                    return self.drift(h);
                }
                if !rests || residual > 0.3 * last {
                    self.correct_all(waiting, h);
                    last = residual.max(waiting.residual);
                    (tail, whole) = (None, true);
                } else {
                    self.correct_head(waiting, h);
                    last = residual;
                }
                continue;
            }
            exact |= slow && rounds >= 3;
            if exact {
                // A block that has no inverse there says nothing about the system, only that the step is too long.
                self.relinearise_and_correct(h).map_err(|_| place.failure(rounds, residual))?;
                self.kick(h);
            } else {
                self.correct(h);
            }
            (last, rounds) = (residual, rounds + 1);
            self.rounds += 1;
            if last_round {
                // Springs, drives and loops keep what they measured for the second half kick.
                if self.forces.is_empty() {
                    self.drift(h)?;
                } else {
                    self.drift_and_measure(h, self.nodes.len())?;
                }
                self.measure_loops(h);
                return self.refuse_false_solutions(h, rounds, exact.then_some(kicked));
            }
        }
    }

    /// Whether the correction of a residual is the last: it is at roundoff, or what it is predicted to leave is negligible.
    pub(super) fn is_last(&self, residual: f64, contraction: f64, roundoff: f64) -> bool {
        let settled = self.loops.is_none() && residual <= SETTLED * roundoff;
        settled || residual * contraction <= NEGLIGIBLE * roundoff
    }

    /// Gravity in the first half kick.
    pub(super) fn first_kick(&self, h: f64) -> Gravity {
        Gravity { time: self.method.parts().0 * h, field: self.gravity }
    }

    /// (1) with the present wrenches.
    pub(super) fn kick(&mut self, h: f64) {
        let (gravity, wrench) = (self.first_kick(h), &self.wrench);
        // Parents come before their children.
        for i in 1..self.nodes.len() {
            kick_joint(&mut self.trial, &self.nodes, &self.places, i, &gravity, &wrench[i]);
        }
        self.kick_more();
    }

    /// What (1) has beside gravity and the joints of the tree.
    fn kick_more(&mut self) {
        if let Some(loops) = &self.loops {
            loops.push(&self.places, |i, impulse| self.trial[i].kick += impulse);
        }
        if let Some(carried) = &self.carried {
            self.trial.iter_mut().zip(carried).for_each(|(trial, impulse)| trial.kick += *impulse);
        }
    }

    /// (2) for all nodes.
    fn drift(&mut self, h: f64) -> Result<(), Failure> {
        (1..self.nodes.len()).try_for_each(|i| self.drift_body(h, i))
    }

    /// (2)
    #[inline(always)]
    fn drift_body(&mut self, h: f64, i: usize) -> Result<(), Failure> {
        let (node, body, trial, pose) = (&self.nodes[i], &self.bodies[i], &mut self.trial[i], &self.pose[i]);
        if node.light {
            return Ok(());
        }
        trial.motion.dx = body.p.plus(&trial.kick.linear) * (h / node.mass);
        let hm = h * pose.r.tr_mul(&body.pi.plus(&trial.kick.angular));
        let start = trial.s + 0.5 * (hm - trial.hm).component_div(&node.inertia);
        trial.s = match self.rules[i].solve(&node.inertia, &hm, &start) {
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

    /// (2), and the joints' mismatch over `-h`, of the nodes before `end`. Returns the joint where it is largest, how large it is
    /// (m; angles times the system's length), and how small roundoff lets it become.
    fn drift_and_measure(&mut self, h: f64, end: usize) -> Result<(Open, f64, f64), Failure> {
        // Of a system at rest, what is taken back of the mismatch is all that there is to be resolved.
        let (mut worst, mut joint, mut roundoff) = (0.0, 0, RETURN * self.length);
        if end == self.nodes.len() {
            self.openings.begin();
        }
        for block in blocks(1..end) {
            block.clone().try_for_each(|i| self.drift_body(h, i))?;
            block.for_each(|i| {
                let (size, noise) = self.measure_joint(h, i);
                // What is not a number stays the worst.
                if size > worst || !(size + noise).is_finite() {
                    (worst, joint) = (size + 0.0 * noise, i - 1);
                }
                roundoff = noise.max(roundoff);
            });
        }
        if !self.forces.is_empty() {
            self.measure_excess(h, (&mut joint, &mut worst), &mut roundoff);
        }
        if !self.light.is_empty() {
            let (body, size, noise) = self.measure_imbalance(h);
            roundoff = roundoff.max(noise / f64::EPSILON);
            if !(size <= worst) {
                (worst, joint) = (size, body);
            }
        }
        Ok((Open::Joint(joint), worst, f64::EPSILON * roundoff))
    }

    /// A joint's mismatch: how large it is, and what roundoff may do to the motion, m.
    #[inline(always)]
    fn measure_joint(&mut self, h: f64, i: usize) -> (f64, f64) {
        let (node, place, trial) = (&self.nodes[i], &self.places[i], &self.trial[i]);
        let parent = &self.trial[node.parent].motion;
        let moved = Moved::new(place, &self.places[node.parent].arm, &trial.motion, parent);
        let gap = moved.locked(node, place, parent) + self.gap0[i];
        let size = gap.linear.norm() + self.length * gap.angular.norm();
        self.bias[i] = gap.scaled(-1.0 / h);
        self.openings.now[i] = size;
        if node.light {
            return (size, 0.0);
        }
        let pull = self.wrench[i].linear.norm() * (h.abs() / node.mass);
        (size, trial.motion.dx.norm() + self.length * trial.hm.norm() * node.thinnest + pull)
    }

    fn measure_loops(&mut self, h: f64) -> Option<Worst> {
        let trial = &self.trial;
        let loops = self.loops.as_mut()?;
        Some(loops.measure(h, &self.nodes, &self.places, &|i| trial[i].motion, self.length))
    }

    /// The same for what acts along the joints: by how far the joint would move if the impulse were right.
    fn measure_excess(&mut self, h: f64, (joint, worst): (&mut usize, &mut f64), roundoff: &mut f64) {
        for (i, k) in (1..self.nodes.len()).filter_map(|i| Some((i, self.nodes[i].force?))) {
            let (node, place, parent) = (&self.nodes[i], &self.places[i], self.nodes[i].parent);
            let (motion, carried) = (&self.trial[i].motion, &self.trial[parent].motion);
            let travel = Moved::new(place, &self.places[parent].arm, motion, carried).travel(node, place, carried);
            let impulse = coordinates_of(node, place, &self.wrench[i]);
            self.along[i] = self.forces[k].excess(travel, impulse);
            let effect = h.abs() * self.compliance(i);
            let size = effect * self.along[i].norm();
            if size > *worst || !size.is_finite() {
                (*worst, *joint) = (size, i - 1);
            }
            *roundoff = roundoff.max(effect * impulse.norm());
        }
    }

    /// By how much a unit impulse along a joint changes its velocity, times the system's length for an angle.
    fn compliance(&self, i: usize) -> f64 {
        let weight = if self.nodes[i].kind == JointKind::Prismatic { 1.0 } else { self.length };
        weight * self.implicit.as_ref().unwrap_or(&self.tree).compliance(i)
    }
}
