//! Start values of the constraint iteration: joint wrenches extrapolated in the child's body frame.
//!
//! Seen from the child, a joint wrench changes slowly. The polynomial through the last wrenches, taken at the present
//! time, is a start from which the chord iteration needs one or two rounds less than from the last wrench. The wrench
//! is kept in the joint and not as an impulse on the bodies: an impulse of the last step does not lie in the range of
//! `G(q0)^T` and would pump energy in.

use super::chain::Pose;
use super::tree::spatial::{Spatial, Wrench};

/// Wrenches that are remembered: a polynomial of degree six. On chains of 10 and 100 rods at h = 1e-3 the iteration
/// takes 3.1 and 3.7 rounds with degree three, 2.0 and 2.3 with degree six.
const DEPTH: usize = 7;

/// The degree that they are enough for.
pub(super) const FULL: usize = DEPTH - 1;

/// The degree where steps go back and forth in time, as those of a composition: their wrenches differ by what depends
/// on the size of the step, and extrapolation would enlarge that.
const RESTLESS: usize = 2;

/// The degree in systems with springs in joints: that of a stiff one carries the roundoff of its angle, which a high
/// degree enlarges.
pub(super) const SPRUNG: usize = 3;

/// The last joint forces (N, N m about the joint point, child's body axes) and their times.
#[derive(Clone, Debug)]
pub(super) struct Predictor {
    /// Node by node, `DEPTH` entries each, at the places of `times`.
    history: Vec<[Wrench; DEPTH]>,
    times: [f64; DEPTH],
    /// How many entries are filled, and where the next one goes.
    filled: usize,
    next: usize,
    /// The degree of the polynomial is at most this.
    highest: usize,
}

impl Predictor {
    pub(super) fn new(nodes: usize, highest: usize) -> Predictor {
        Predictor { history: vec![[Spatial::ZERO; DEPTH]; nodes], times: [0.0; DEPTH], filled: 0, next: 0, highest }
    }

    /// Takes over what another one of the same size remembers, without allocation.
    pub(super) fn copy_from(&mut self, other: &Predictor) {
        self.history.copy_from_slice(&other.history);
        (self.times, self.filled, self.next) = (other.times, other.filled, other.next);
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        (self.filled, self.next) = (0, 0);
    }

    /// The highest polynomial degree that the history allows; `None` without one.
    pub(super) fn degree(&self) -> Option<usize> {
        let most = self.filled.checked_sub(1)?;
        let mut steps = (0..most).map(|k| self.times[newest(self.next, k)] - self.times[newest(self.next, k + 1)]);
        let steady = steps.next().is_none_or(|last| steps.all(|step| step * last > 0.0));
        Some(most.min(if steady { self.highest } else { RESTLESS }))
    }

    /// The force that was remembered last, child's body axes.
    pub(super) fn newest(&self, node: usize) -> &Wrench {
        &self.history[node][(self.next + DEPTH - 1) % DEPTH]
    }

    /// Writes the impulses of a half kick `h/2` at `time`, extrapolated by a polynomial of the given degree.
    pub(super) fn predict(&self, time: f64, h: f64, degree: usize, pose: &[Pose], out: &mut [Wrench]) {
        let weights = self.weights(time, h, degree);
        (1..out.len()).for_each(|i| out[i] = self.impulse(&weights, i, &pose[i]));
    }

    /// The impulse of joint `i` over a half kick, with the [`Predictor::weights`] of it.
    #[inline(always)]
    pub(super) fn impulse(&self, weights: &[f64; DEPTH], i: usize, pose: &Pose) -> Wrench {
        let mut impulse = Spatial::ZERO;
        for (weight, past) in weights.iter().zip(&self.history[i]) {
            impulse += past.scaled(*weight);
        }
        Spatial::new(pose.r * impulse.linear, pose.r * impulse.angular)
    }

    /// What the remembered forces count in the impulses of a half kick `h/2` at `time`, extrapolated by a polynomial of
    /// the given degree.
    pub(super) fn weights(&self, time: f64, h: f64, degree: usize) -> [f64; DEPTH] {
        self.lagrange(time, degree).map(|weight| 0.5 * h * weight)
    }

    /// Lagrange weights of the newest `degree + 1` entries at a time; zero for the others.
    fn lagrange(&self, time: f64, degree: usize) -> [f64; DEPTH] {
        let newest = |k: usize| newest(self.next, k);
        let mut weights = [0.0; DEPTH];
        let used = degree.min(self.filled.saturating_sub(1));
        for j in 0..=used {
            weights[newest(j)] = (0..=used)
                .filter(|&k| k != j)
                .map(|k| (time - self.times[newest(k)]) / (self.times[newest(j)] - self.times[newest(k)]))
                .product();
        }
        weights
    }

    /// Remembers the impulses of a half kick `h/2` at `time`.
    pub(super) fn record(&mut self, time: f64, h: f64, pose: &[Pose], wrench: &[Wrench]) {
        (1..wrench.len()).for_each(|i| self.write(h, i, &pose[i], &wrench[i]));
        self.advance(time);
    }

    /// Writes down the impulse of joint `i` over a half kick `h/2`; [`Predictor::advance`] follows.
    #[inline(always)]
    pub(super) fn write(&mut self, h: f64, i: usize, pose: &Pose, wrench: &Wrench) {
        let (r, per_force) = (&pose.r, 2.0 / h);
        self.history[i][self.next] =
            Spatial::new(r.tr_mul(&wrench.linear) * per_force, r.tr_mul(&wrench.angular) * per_force);
    }

    /// Remembers what was written down of all joints, at `time`.
    pub(super) fn advance(&mut self, time: f64) {
        self.times[self.next] = time;
        self.next = (self.next + 1) % DEPTH;
        self.filled = (self.filled + 1).min(DEPTH);
    }
}

/// The place of the entry before which `k` newer ones were written.
fn newest(next: usize, k: usize) -> usize {
    (next + DEPTH - 1 - k) % DEPTH
}
