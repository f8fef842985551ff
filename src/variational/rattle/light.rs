//! Links without mass or moments of inertia that move, and links whose mass or moments are tiny beside what they carry:
//! the empty links of a ball joint made of three hinges, a point mass, a gear of 1e-7 kg before an arm.
//!
//! Large impulses nearly cancel on such a *light* body, and what is left would be divided by almost nothing. So it is
//! not its momentum that moves it: its motion over the step (`dx`, `s`) is an unknown of its own, and the equation for
//! it is (1) and (2) of [`super`] the other way round, with the rule
//! [`Rotation::Cayley`](crate::variational::Rotation::Cayley) for the turn,
//!
//! ```text
//! m dx / h                                 = p0  + h/2 (f(q0)   + G(q0)^T lambda0)
//! R0 2/h (J s + s x J s + s (s . J s))     = pi0 + h/2 (tau(q0) + G(q0)^T lambda0)
//! ```
//!
//! whose left-hand sides are zero where there is no inertia: the impulses balance. What they lack is the right-hand
//! side of a correction, and the twist that the recursion finds moves the body. Momenta are set from the motion and,
//! after the projection (5), from the twist. It works as long as the articulated inertia, the bodies behind included,
//! is regular along the body's joint.

use nalgebra::Vector3;

use super::project::world_inertia;
use super::state::Rattle;
use crate::numeric::Compensated;
use crate::variational::chain::Node;
use crate::variational::tree::spatial::{Spatial, Twist, Wrench};

/// Mass or moments, over those of the heaviest body behind, below which a body counts as light; and moments over mass
/// times the square of the system's length.
const LIGHT: f64 = 1e-5;

/// Articulated inertia along a light body's joint, over that of all that hangs on it, that counts as none.
const NONE: f64 = 1e-12;

/// Mass and moment of inertia: of all bodies behind a node, and of the heaviest of them.
#[derive(Clone, Copy, Default)]
struct Behind {
    sum: (f64, f64),
    most: (f64, f64),
}

/// Marks light bodies, and says below which inertia along their joint they move without moving any mass. `all` is false
/// where only bodies without moments can be treated so.
pub(super) fn mark(nodes: &mut [Node], length: f64, all: bool) {
    let mut behind = vec![Behind::default(); nodes.len()];
    for i in (1..nodes.len()).rev() {
        let Behind { sum, most } = behind[i];
        let (mass, moment) = (nodes[i].mass, nodes[i].inertia.max());
        let own = moment + mass * length * length;
        let whole = (sum.0 + mass, sum.1 + own);
        let node = &mut nodes[i];
        let bob = !node.is_free() && moment < LIGHT * mass * length * length;
        node.light = moment == 0.0 || (all && (bob || mass < LIGHT * most.0 || moment < LIGHT * most.1));
        if node.light {
            node.least = NONE * if node.slides() { whole.0 } else { whole.1 };
        }
        let parent = &mut behind[node.parent];
        parent.sum = (parent.sum.0 + whole.0, parent.sum.1 + whole.1);
        parent.most = (parent.most.0.max(most.0).max(mass), parent.most.1.max(most.1).max(moment));
    }
}

impl Rattle {
    /// Nodes with no or very little inertia.
    fn light(&self) -> &[usize] {
        self.parts.as_ref().map_or(&[], |parts| &parts.light)
    }

    /// The momentum of a light body's motion.
    pub(in crate::variational) fn momentum_of_motion(&self, i: usize, h: f64) -> Wrench {
        let (node, trial) = (&self.chain.nodes[i], &self.trial.bodies[i]);
        let js = node.inertia.component_mul(&trial.s);
        let hm = 2.0 * (js + trial.s.cross(&js) + trial.s * trial.s.dot(&js));
        Spatial::new(trial.motion.dx * (node.mass / h), self.now.pose[i].r * hm / h)
    }

    /// By how much the impulses on a light body exceed the momentum of its motion; zero for all others.
    pub(in crate::variational) fn imbalance(&self, i: usize, h: f64) -> Wrench {
        if !self.chain.nodes[i].light {
            return Spatial::ZERO;
        }
        let (body, kick) = (&self.now.bodies[i], &self.trial.bodies[i].kick);
        Spatial::new(body.p.plus(&kick.linear), body.pi.plus(&kick.angular)) - self.momentum_of_motion(i, h)
    }

    /// Hands what the impulses on light bodies lack for balance to the exact linearisation.
    pub(in crate::variational) fn load_light(&mut self, h: f64) {
        for k in 0..self.light().len() {
            let i = self.light()[k];
            let lacking = self.imbalance(i, h);
            self.trial.newton.load(i, lacking.wrench_from(&-self.now.frames[i].arm));
        }
    }

    /// Starts the motions of light bodies from their twists at the beginning of the step.
    pub(in crate::variational) fn start_light(&mut self, h: f64) {
        for k in 0..self.light().len() {
            let i = self.light()[k];
            let v = self.now.twist[i].twist_at(&-self.now.frames[i].arm);
            self.trial.bodies[i].motion.dx = h * v.linear;
            self.turn_light(i, &Vector3::zeros(), &(h * v.angular));
        }
    }

    /// The light body whose impulses are farthest from its motion: how far that moves it, m, and what roundoff may do.
    pub(in crate::variational) fn measure_imbalance(&self, h: f64) -> (usize, f64, f64) {
        let (mut joint, mut worst, mut roundoff) = (0, 0.0, 0.0_f64);
        for k in 0..self.light().len() {
            let i = self.light()[k];
            let (mass, moment) = self.now.tree.mean_inertia(i);
            let moved = |f: f64, tau: f64| h.abs() * (f / mass + self.chain.length * tau / moment);
            let (excess, f) = (self.imbalance(i, h), self.trial.wrench[i].linear.norm());
            let size = moved(excess.linear.norm(), excess.angular.norm());
            if size > worst || !size.is_finite() {
                (joint, worst) = (i - 1, size);
            }
            let lever = self.now.frames[i].arm.norm() + self.chain.length;
            let impulses = moved(f, self.trial.wrench[i].angular.norm() + lever * f);
            let motion = &self.trial.bodies[i].motion;
            roundoff = roundoff.max(impulses).max(motion.dx.norm() + 2.0 * self.chain.length * motion.s.norm());
        }
        (joint, worst, f64::EPSILON * roundoff)
    }

    /// Moves the light bodies by the twists of a correction at their centres of mass, for a time `h`.
    pub(in crate::variational) fn correct_light(&mut self, h: f64, twist: impl Fn(&Rattle, usize) -> Twist) {
        for k in 0..self.light().len() {
            let i = self.light()[k];
            let (v, s) = (twist(self, i), self.trial.bodies[i].motion.s);
            self.trial.bodies[i].motion.dx += h * v.linear;
            self.turn_light(i, &s, &(h * v.angular));
        }
    }

    /// Sets the rotation of a light body to that with the Cayley vector `s`, turned further by a small rotation vector.
    fn turn_light(&mut self, i: usize, s: &Vector3<f64>, by: &Vector3<f64>) {
        // (1, a) (1, s) = (1 - a.s, a + s + a x s)
        let a = 0.5 * by;
        let turned = (s + a + a.cross(s)) / (1.0 - a.dot(s));
        let trial = &mut self.trial.bodies[i];
        trial.motion.s = turned;
        trial.s = self.now.pose[i].r.tr_mul(&turned);
        let js = self.chain.nodes[i].inertia.component_mul(&trial.s);
        trial.hm = 2.0 * (js + trial.s.cross(&js) + trial.s * trial.s.dot(&js));
    }

    /// (1) for light bodies: their momenta from their motions.
    pub(super) fn kick_light(&mut self, h: f64) {
        for k in 0..self.light().len() {
            let i = self.light()[k];
            let momentum = self.momentum_of_motion(i, h);
            self.trial.bodies[i].kick = Spatial::ZERO;
            self.set_momentum(i, &momentum);
        }
    }

    /// (4) and (5) for light bodies: their momenta from their twists.
    pub(super) fn project_light(&mut self) {
        for k in 0..self.light().len() {
            let i = self.light()[k];
            let v = self.now.twist[i].twist_at(&-self.now.frames[i].arm);
            let spin = world_inertia(&self.chain.nodes[i], &self.now.pose[i]) * v.angular;
            self.trial.bodies[i].kick = Spatial::ZERO;
            self.set_momentum(i, &Spatial::new(v.linear * self.chain.nodes[i].mass, spin));
        }
    }

    fn set_momentum(&mut self, i: usize, momentum: &Wrench) {
        self.now.bodies[i].p = Compensated::new(momentum.linear);
        self.now.bodies[i].pi = Compensated::new(momentum.angular);
    }
}
