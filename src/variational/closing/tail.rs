//! Rounds of the constraint iteration on the base of a chain, while its tail waits.
//!
//! Where a long chain bends, near its base, extrapolation errs most and the chord iteration contracts slowest: of 10 000 rods in their
//! first 0.2 s the first 50 joints need four or five rounds, the others two. So once the next correction of a tail is its
//! last, by the rule for the whole, the rounds before that one are taken on the nodes before it, the head.
//!
//! The tail's answer to them, by which tension passes to its end, is not left out. The articulated inertia of the tail is in that
//! of the head, and the correction is linear: the tail takes in the sum of the twists that have carried it along together
//! with its own mismatch, in the last correction, which is one of all nodes. What the chord iteration leaves of that is
//! predicted as of a residual (`still_settled`); where it is too much the rounds go on over all nodes.

use super::stop::last_round;
use crate::variational::rattle::Rattle;
use crate::variational::rattle::kick::kick_joint;
use crate::variational::tree::spatial::{Spatial, Twist, Wrench};

/// Joints of the head that need no more rounds themselves. From rod to rod a correction across a chain falls to a half; what reaches the tail
/// must be small beside what it has to correct itself.
const MARGIN: usize = 12;

/// The nodes from `first` on, which all hang on that one and wait for those before it.
pub(super) struct Tail {
    pub first: usize,
    /// How far its joints are open, m, that over the round before, and the roundoff of that, m.
    pub residual: f64,
    contraction: f64,
    roundoff: f64,
    /// The wrench in the joint of `first` without the corrections that the tail has missed.
    wrench: Wrench,
    /// The sum of the twists of its parent in these.
    missed: Twist,
}

/// What a round with a waiting tail was.
pub(super) enum Waited {
    /// One on the head.
    On,
    /// One on all nodes, after which the tail waits no more.
    TooLong,
    /// The last.
    ToTheEnd,
}

impl Rattle {
    /// Whether parts of the system may wait for others: a tree with nothing but gravity, and rounds that end at roundoff.
    pub(super) fn may_wait(&self) -> bool {
        !self.settings.unbiased && self.parts.is_none()
    }

    /// A tail whose next correction is its last, where there is one of at least half of the nodes: [`MARGIN`] shorter than the longest.
    pub(super) fn settled_tail(&self, roundoff: f64) -> Option<Tail> {
        let (now, before) = (&self.trial.open, &self.trial.open_before);
        let (mut residual, mut last, mut longest) = (0.0_f64, 0.0_f64, None);
        for i in (2..now.len()).rev() {
            (residual, last) = (residual.max(now[i]), last.max(before[i]));
            if last_round(true, residual, residual / last, roundoff).is_some() {
                longest = Some(i);
            }
        }
        let first = longest? + MARGIN;
        if 2 * first > now.len() || !self.chain.stem[first] {
            return None;
        }
        let most = |open: &[f64]| open[first..].iter().fold(0.0, |most: f64, open| most.max(*open));
        let residual = most(now);
        let contraction = residual / most(before);
        last_round(true, residual, contraction, roundoff).map(|_| Tail {
            first,
            residual,
            contraction,
            roundoff,
            wrench: self.trial.wrench[first],
            missed: Spatial::ZERO,
        })
    }

    /// A round on the head alone, or on all nodes where that is the last or the tail may wait no longer; `ends` is whether the head
    /// needs no more rounds after it.
    pub(super) fn correct_head_or_all(
        &mut self,
        tail: &mut Tail,
        h: f64,
        roundoff: f64,
        ends: bool,
        falls: bool,
    ) -> Waited {
        let rests = self.still_settled(tail, h, roundoff);
        if rests && ends {
            self.correct_all(tail, h);
            return Waited::ToTheEnd;
        }
        if !rests || !falls {
            self.correct_all(tail, h);
            return Waited::TooLong;
        }
        self.correct_head(tail, h);
        Waited::On
    }

    /// Whether its next correction is still the last of a tail, which has been carried along by those that it has missed.
    pub(super) fn still_settled(&self, tail: &Tail, h: f64, roundoff: f64) -> bool {
        let missed = tail.missed.twist_at(&self.now.frames[tail.first].offset);
        let carried = h.abs() * (missed.linear.norm() + self.chain.length * missed.angular.norm());
        last_round(true, tail.residual + carried, tail.contraction, roundoff.max(tail.roundoff)).is_some()
    }

    /// One round of the chord iteration on the nodes before a tail, and (1) for them.
    pub(super) fn correct_head(&mut self, tail: &mut Tail, h: f64) {
        let gravity = self.first_kick(h);
        let (nodes, frames, bias) = (&self.chain.nodes, &self.now.frames, &self.trial.bias);
        let (wrench, trial) = (&mut self.trial.wrench, &mut self.trial.bodies);
        tail.missed += self.now.tree.correct_head(
            frames,
            tail.first,
            |i| bias[i],
            |i, _, f| {
                wrench[i] += f;
                kick_joint(trial, nodes, frames, i, &gravity, &wrench[i]);
            },
        );
    }

    /// One round on all nodes, in which a tail makes up for what it has missed, and (1).
    pub(super) fn correct_all(&mut self, tail: &Tail, h: f64) {
        let gravity = self.first_kick(h);
        let (nodes, frames, bias) = (&self.chain.nodes, &self.now.frames, &self.trial.bias);
        let (wrench, trial) = (&mut self.trial.wrench, &mut self.trial.bodies);
        wrench[tail.first] = tail.wrench;
        self.now.tree.correct_all(
            frames,
            (tail.first, &tail.missed),
            |i| bias[i],
            |i, _, f| {
                wrench[i] += f;
                kick_joint(trial, nodes, frames, i, &gravity, &wrench[i]);
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::mechanics::System;
    use crate::model::Inertial;
    use crate::model::assemble::{Assembly, Mount};

    /// Rods of 0.3 m with hinges about y and z in turn, released from horizontal.
    fn chain(links: usize) -> Rattle {
        let mut chain = Assembly::new("chain");
        for i in 0..links {
            let axis = if i % 2 == 0 { Vector3::y_axis() } else { Vector3::z_axis() };
            let at = Vector3::x() * if i == 0 { 0.0 } else { 0.3 };
            chain.add(i, Mount::hinge(axis, at), Some(Inertial::rod(0.3, 0.02, 1.0)));
        }
        Rattle::new(&System::compile(&chain.scene()).unwrap()).unwrap()
    }

    #[test]
    fn a_tail_that_has_waited_ends_where_it_would_have_been() {
        let mut whole = chain(200);
        for _ in 0..50 {
            whole.step(1e-3).unwrap();
        }
        let (mut waiting, before) = (whole.clone(), whole.counters().rounds);
        whole.chain.stem.fill(false);
        waiting.step(1e-3).unwrap();
        whole.step(1e-3).unwrap();
        assert!(whole.counters().rounds - before >= 3, "there were rounds to wait for");
        let (mut largest, mut same) = (0.0_f64, true);
        for (a, b) in waiting.now.twist.iter().zip(&whole.now.twist).skip(1) {
            largest = largest.max((a.linear - b.linear).norm()).max((a.angular - b.angular).norm());
            same &= a == b;
        }
        // measured 2.4e-15
        assert!(largest <= 6e-15, "{largest:e}");
        assert!(!same, "no tail has waited");
    }

    #[test]
    fn a_tail_makes_up_for_the_corrections_that_it_has_missed() {
        let mut rattle = chain(40);
        let (tail, frames) = (15, rattle.now.frames.clone());
        let bias = |i: usize| {
            let x = i as f64;
            Spatial::new(Vector3::new(x.sin(), x.cos(), 0.3), Vector3::new(0.1, x.sin(), 0.2))
        };
        let n = rattle.chain.nodes.len();
        let (mut expected, mut found) = (vec![Spatial::ZERO; n], vec![Spatial::ZERO; n]);
        let none = |_: usize| Vector3::zeros();
        rattle.now.tree.correct(&rattle.chain.nodes, &frames, bias, none, |i, _, f| expected[i] = f);
        let missed = rattle.now.tree.correct_head(&frames, tail, bias, |i, _, f| found[i] = f);
        found[tail] = Spatial::ZERO;
        let rest = |i: usize| if i < tail { Spatial::ZERO } else { bias(i) };
        rattle.now.tree.correct_all(&frames, (tail, &missed), rest, |i, _, f| found[i] += f);
        let size = expected.iter().map(|f| f.linear.norm()).fold(0.0, f64::max);
        for (i, (a, b)) in found.iter().zip(&expected).enumerate() {
            let error = (a.linear - b.linear).norm() + (a.angular - b.angular).norm();
            // measured 3.9e-16
            assert!(error <= 1e-15 * size, "{i}: {:e}", error / size);
        }
    }
}
