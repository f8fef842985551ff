//! (1) and (2): the chord iteration that closes the joints at all stages.

use nalgebra::Vector3;

use super::integrator::Lobatto;
use crate::variational::chain::RelativeMotion;
use crate::variational::closing::stop::LIMITS;
use crate::variational::rattle::{Failure, RETURN, world_inertia};
use crate::variational::tree::Singular;
use crate::variational::tree::spatial::{Spatial, Twist, Wrench};

/// Rounds without progress after which the iteration is at roundoff.
const STALLED: usize = 3;

impl Lobatto {
    /// (1) and (2): the chord iteration, down to roundoff.
    pub(super) fn iterate(&mut self, h: f64) -> Result<(), Failure> {
        let (mut best, mut stalled) = (f64::INFINITY, 0);
        for rounds in 0.. {
            self.place_and_load();
            self.move_stages(h)?;
            let (joint, residual, roundoff) = self.measure(h);
            if !residual.is_finite() {
                return Err(Failure::NotFinite { body: joint });
            }
            // The contraction alternates, and the forces are much larger than the gaps that they close: only a residual
            // that has not fallen for several rounds is roundoff.
            stalled = if residual < 0.5 * best { 0 } else { stalled + 1 };
            best = residual.min(best);
            if residual == 0.0 || (stalled >= STALLED && best <= 64.0 * roundoff) {
                return Ok(());
            }
            if rounds == LIMITS.rounds {
                return Err(Failure::Constraint { joint, rounds, residual });
            }
            // The first round puts the bodies where the prediction has them; one that hardly helps calls for another
            // look.
            if rounds == 0 || stalled >= STALLED {
                self.factorise_stages()?;
            }
            self.correct(h);
        }
        Ok(())
    }

    /// The joint where a stage is farthest from holding, how far (m; angles times the system's length), and how
    /// small roundoff lets that become.
    fn measure(&mut self, h: f64) -> (usize, f64, f64) {
        let s = self.tableau.stages;
        let (mut worst, mut joint, mut roundoff) = (0.0, 0, RETURN * self.length);
        for k in 1..s {
            for i in 1..self.nodes.len() {
                let (node, parent) = (&self.nodes[i], self.nodes[i].parent);
                let (motion, above) = (self.motion(i, k), self.motion(parent, k));
                let moved = RelativeMotion::new(&self.frames[i], &self.frames[parent].arm, &motion, &above);
                let gap = moved.locked(node, &self.frames[i], &above) + self.gap0[i].scaled(self.tableau.c[k]);
                let size = gap.linear.norm() + self.length * gap.angular.norm();
                let load = &self.stages[i * s + k].load;
                // A turn is known to the roundoff of the momentum, which weighs most about the thinnest axis.
                let spin = h * self.bodies[i].pi.value.norm() / node.inertia.min();
                let limit = motion.dx.norm() + self.length * spin.abs() + (load.linear.norm() / node.mass) * (h * h);
                if size > worst || !(size + limit).is_finite() {
                    (worst, joint) = (size + 0.0 * limit, i - 1);
                }
                roundoff = limit.max(roundoff);
                let axes = &self.frames[i].axes;
                let gap = Spatial::new(axes.tr_mul(&gap.linear), axes.tr_mul(&gap.angular));
                self.stages[i * s + k].closing = gap.scaled(-1.0 / h);
            }
        }
        (joint, worst, f64::EPSILON * roundoff)
    }

    /// Factorises at the inner stages as they stand.
    fn factorise_stages(&mut self) -> Result<(), Failure> {
        let s = self.tableau.stages;
        let mut inner = std::mem::take(&mut self.inner);
        let mut result = Ok(());
        for (k, (frames, tree)) in (1..).zip(&mut inner) {
            for (i, frame) in frames.iter_mut().enumerate().skip(1) {
                *frame = self.stages[i * s + k].frame;
            }
            let inertia = |i: usize| world_inertia(&self.nodes[i], &self.pose_at(i, k));
            result = result.and(tree.factorise(&self.nodes, frames, inertia, |_| 0.0));
        }
        self.inner = inner;
        result.map_err(|Singular { node }| Failure::Singular { joint: node - 1 })
    }

    /// One round: the gaps of all stages, combined into those that the forces at one stage have to close, close them
    /// with the factorisation at that stage.
    fn correct(&mut self, h: f64) {
        let s = self.tableau.stages;
        for k in 0..s - 1 {
            let (frames, tree) = match k.checked_sub(1) {
                None => (&self.frames, &mut self.tree),
                Some(inner) => {
                    let (frames, tree) = &mut self.inner[inner];
                    (&*frames, tree)
                }
            };
            for i in 1..self.nodes.len() {
                let mut bias = Spatial::ZERO;
                for row in 1..s {
                    bias += self.stages[i * s + row].closing.scaled(self.tableau.inverse[k][row - 1] / h);
                }
                let axes = &frames[i].axes;
                self.bias[i] = Spatial::new(axes * bias.linear, axes * bias.angular);
            }
            let (bias, stages) = (&self.bias, &mut self.stages);
            let add = |i: usize, _: &Twist, f: Wrench| {
                let axes = &frames[i].axes;
                stages[i * s + k].wrench += Spatial::new(axes.tr_mul(&f.linear), axes.tr_mul(&f.angular));
            };
            tree.correct(frames, |i| bias[i], |_| Vector3::zeros(), add);
        }
    }
}
