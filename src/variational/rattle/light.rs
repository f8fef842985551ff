//! Links without mass, or with mass and no moments of inertia, that move: the empty links of a ball joint made of three
//! hinges, a point mass.
//!
//! Such a body is *light*: it has no momentum to drift with. Where it has none, its motion over the step is an unknown of its
//! own, and the equation for it is that the impulses on it balance,
//!
//! ```text
//! linear:   0 = h/2 (f(q0) + G(q0)^T lambda0)      where the mass is zero
//! angular:  0 = h/2 (tau(q0) + G(q0)^T lambda0)    where the moments are zero
//! ```
//!
//! which is (1) and (2) of [`super`] as mass and moments tend to zero. In the recursion its inertia is zero: the twist of a
//! correction follows from its joint, and what the impulses lack for balance is the right-hand side. That works as long as
//! the articulated inertia, the bodies behind it included, is regular along its joint.

use nalgebra::Vector3;

use super::super::joints::Node;
use super::super::spatial::{Spatial, Twist, Wrench};
use super::Rattle;

/// Articulated inertia along a light body's joint, over that of all that hangs on it, that counts as none.
const NONE: f64 = 1e-12;

/// Marks light bodies, and says below which inertia along their joint they move without moving any mass.
pub(super) fn mark(nodes: &mut [Node], length: f64) {
    let mut behind = vec![(0.0, 0.0); nodes.len()];
    for i in (1..nodes.len()).rev() {
        let (mass, moment) = (nodes[i].mass, nodes[i].inertia.max() + nodes[i].mass * length * length);
        behind[i] = (behind[i].0 + mass, behind[i].1 + moment);
        let (all, parent) = (behind[i], nodes[i].parent);
        behind[parent] = (behind[parent].0 + all.0, behind[parent].1 + all.1);
        let node = &mut nodes[i];
        if node.inertia.max() == 0.0 {
            let slides = node.kind == crate::mechanics::JointKind::Prismatic;
            node.light = true;
            node.least = NONE * if slides { all.0 } else { all.1 };
        }
    }
}

/// The part of an impulse that a light body has no inertia for.
fn unanswered(node: &Node, kick: &Wrench) -> Wrench {
    Spatial::new(if node.mass == 0.0 { kick.linear } else { Vector3::zeros() }, kick.angular)
}

impl Rattle {
    /// What light bodies lack for balance with the present wrenches; zero for all others.
    pub(super) fn imbalance(&self, i: usize) -> Wrench {
        if self.nodes[i].light { unanswered(&self.nodes[i], &self.trial[i].kick) } else { Spatial::ZERO }
    }

    /// Starts the motions of light bodies from their twists at the beginning of the step.
    pub(super) fn start_light(&mut self, h: f64) {
        for k in 0..self.light.len() {
            let i = self.light[k];
            let v = self.twist[i].twist_at(&-self.places[i].arm);
            self.trial[i].motion.dx = h * v.linear;
            self.turn_light(i, &Vector3::zeros(), &(h * v.angular));
        }
    }

    /// (2) for light bodies: those with mass follow their linear momentum, the rest stays as the last correction left it.
    pub(super) fn drift_light(&mut self, h: f64) {
        for &i in &self.light {
            let (node, trial) = (&self.nodes[i], &mut self.trial[i]);
            let mut noise = 0.0;
            if node.mass > 0.0 {
                trial.motion.dx = self.bodies[i].p.plus(&trial.kick.linear) * (h / node.mass);
                noise = self.wrench[i].linear.norm() * (h.abs() / node.mass);
            }
            trial.roundoff = trial.motion.dx.norm() + 2.0 * self.length * trial.motion.s.norm() + noise;
        }
    }

    /// The light body whose impulses are farthest from balance: how far that moves it, m, and what roundoff may do.
    pub(super) fn measure_imbalance(&self, h: f64) -> (usize, f64, f64) {
        let (mut joint, mut worst, mut roundoff) = (0, 0.0, 0.0_f64);
        for &i in &self.light {
            let (mass, moment) = self.tree.mean_inertia(i);
            let moved = |f: f64, tau: f64| h.abs() * (f / mass + self.length * tau / moment);
            let (short, f) = (self.imbalance(i), self.wrench[i].linear.norm());
            let size = moved(short.linear.norm(), short.angular.norm());
            if size > worst || !size.is_finite() {
                (joint, worst) = (i - 1, size);
            }
            let lever = self.places[i].arm.norm() + self.length;
            let sum = moved(if self.nodes[i].mass == 0.0 { f } else { 0.0 }, self.wrench[i].angular.norm() + lever * f);
            roundoff = roundoff.max(sum);
        }
        (joint, worst, f64::EPSILON * roundoff)
    }

    /// Moves the light bodies by the twists of a correction at their centres of mass, for a time `h`.
    pub(super) fn correct_light(&mut self, h: f64, twist: impl Fn(&Rattle, usize) -> Twist) {
        for k in 0..self.light.len() {
            let i = self.light[k];
            let v = twist(self, i);
            if self.nodes[i].mass == 0.0 {
                self.trial[i].motion.dx += h * v.linear;
            }
            let s = self.trial[i].motion.s;
            self.turn_light(i, &s, &(h * v.angular));
        }
    }

    /// Sets the rotation of a light body to that with the Cayley vector `s`, turned further by a small rotation vector.
    fn turn_light(&mut self, i: usize, s: &Vector3<f64>, by: &Vector3<f64>) {
        // (1, a) (1, s) = (1 - a.s, a + s + a x s)
        let a = 0.5 * by;
        let turned = (s + a + a.cross(s)) / (1.0 - a.dot(s));
        self.trial[i].motion.s = turned;
        self.trial[i].s = self.pose[i].r.tr_mul(&turned);
    }

    /// Takes the roundoff off the impulses of light bodies, which have no momentum.
    pub(super) fn settle_light(&mut self) {
        for &i in &self.light {
            let kick = self.trial[i].kick;
            self.trial[i].kick -= unanswered(&self.nodes[i], &kick);
        }
    }
}
