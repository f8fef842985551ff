//! What the motions of a step leave a bond short of.

use nalgebra::Vector3;

use super::place::{Slot, locked_axes};
use super::state::{Bond, Kind};
use crate::variational::chain::{JointFrame, Motion, Node, RelativeMotion};
use crate::variational::tree::newton::closing_twist;
use crate::variational::tree::spatial::{Spatial, Twist};

impl Bond {
    /// What the motions of a step leave the bond short of: writes one figure a row (m, rad) into `gap`. `nu` are the
    /// rows' impulses, `grip` by how much the gap of a spring moves the bodies, over the gap. Returns what roundoff may
    /// do to the motion, over `f64::EPSILON`.
    pub(in crate::variational) fn measure(
        &mut self,
        h: f64,
        nodes: &[Node],
        frames: &[JointFrame],
        motion: &dyn Fn(usize) -> Motion,
        (nu, grip): (&[f64], f64),
        gap: &mut [f64],
    ) -> f64 {
        let (child, parent) = (motion(self.child), motion(self.parent));
        match &self.kind {
            Kind::Loop { kind, .. } => {
                let twist = self.locked(&child, &parent).0;
                for (gap, (slot, axis)) in gap.iter_mut().zip(locked_axes(*kind)) {
                    let axis = self.axes.column(axis);
                    *gap = match slot {
                        Slot::Linear => axis.dot(&twist.linear),
                        Slot::Angular => axis.dot(&twist.angular),
                    };
                }
                self.moved_by(nu, h, nodes)
            }
            Kind::Coupling { source, multiplier } => {
                let travel = |node: usize| {
                    let (frame, above) = (&frames[node], nodes[node].parent);
                    let carried = motion(above);
                    let moved = RelativeMotion::new(frame, &frames[above].arm, &motion(node), &carried);
                    moved.travel(&nodes[node], frame, &carried).x
                };
                let (follower, followed) = (travel(self.child), travel(*source));
                self.change[0] = follower - multiplier * followed;
                gap[0] = self.change[0] + self.gap0.linear.x;
                follower.abs() + (multiplier * followed).abs()
            }
            Kind::Spring { .. } | Kind::Pull { .. } => {
                let moved = (child.dx - parent.dx) + (child.turned(&self.arm) - parent.turned(&self.parent_arm));
                grip * self.measure_spring(h, &moved, nu, gap) + self.moved_by(nu, h, nodes)
            }
        }
    }

    /// The same for a spring whose points move by `moved` from each other.
    fn measure_spring(&mut self, h: f64, moved: &Vector3<f64>, nu: &[f64], gap: &mut [f64]) -> f64 {
        let (before, after) = (self.span.norm(), (self.span + moved).norm());
        let far = self.stiff && self.span.dot(&(self.span + moved)) < 0.0;
        let sum = before + after;
        let longer = if sum > 0.0 { (2.0 * self.span.dot(moved) + moved.norm_squared()) / sum } else { 0.0 };
        let (stiffness, damping) = match self.kind {
            Kind::Spring { stiffness, damping, .. } => {
                self.passed = if far { after } else { 0.0 };
                self.change[0] = if far { -sum } else { longer };
                (stiffness, damping)
            }
            Kind::Pull { stiffness, .. } => {
                self.change = [moved.x, moved.y, moved.z, longer];
                (stiffness, 0.0)
            }
            Kind::Loop { .. } | Kind::Coupling { .. } => return 0.0,
        };
        let mut noise = 0.0_f64;
        for row in 0..self.count {
            let (kappa, change) = (self.kappa(row, h), self.change[row]);
            // The fourth row is that of a damper alone.
            let stretch = if row < 3 { self.length.value[row] + 0.5 * change } else { 0.0 };
            let resist = if row < 3 { damping } else { 2.0 * kappa };
            gap[row] = (nu[row] + 0.5 * h * stiffness * stretch + 0.5 * resist * change) / kappa;
            noise = noise.max((nu[row] / kappa).abs() + stretch.abs());
        }
        noise + moved.norm()
    }

    /// How large the gap of the bond's rows is, m; angles times `length`.
    pub(in crate::variational) fn size(&self, nodes: &[Node], gap: &[f64], length: f64) -> f64 {
        match &self.kind {
            Kind::Loop { kind, .. } => {
                let part = |which: Slot| {
                    let rows = locked_axes(*kind).zip(gap).filter(|((slot, _), _)| *slot == which);
                    rows.map(|(_, gap)| gap * gap).sum::<f64>().sqrt()
                };
                part(Slot::Linear) + length * part(Slot::Angular)
            }
            Kind::Coupling { .. } => gap[0].abs() * if nodes[self.child].slides() { 1.0 } else { length },
            Kind::Spring { .. } | Kind::Pull { .. } => gap.iter().map(|gap| gap * gap).sum::<f64>().sqrt(),
        }
    }

    /// The relative twists that close a loop in `h`, along its rows at the end of the motions: the target of the exact
    /// linearisation. Couplings and springs have theirs in `gap`.
    pub(in crate::variational) fn targets_after(
        &self,
        h: f64,
        motion: &dyn Fn(usize) -> Motion,
        gap: &[f64],
        target: &mut [f64],
    ) {
        let Kind::Loop { kind, .. } = &self.kind else {
            target.iter_mut().zip(gap).for_each(|(target, gap)| *target = -gap / h);
            return;
        };
        let (child, parent) = (motion(self.child), motion(self.parent));
        let (locked, turn) = self.locked(&child, &parent);
        let bias = closing_twist(&locked.scaled(-1.0 / h), &turn, &parent);
        for (target, (slot, axis)) in target.iter_mut().zip(locked_axes(*kind)) {
            let axis = self.axes.column(axis).into_owned();
            let axis = axis + parent.turned(&axis);
            *target = match slot {
                Slot::Linear => axis.dot(&bias.linear),
                Slot::Angular => axis.dot(&bias.angular),
            };
        }
    }

    /// How far the impulses move the lighter body in a step, m: a stiff pull and the momentum that it turns round
    /// cancel.
    fn moved_by(&self, nu: &[f64], h: f64, nodes: &[Node]) -> f64 {
        let pull = nu.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let mass = [self.child, self.parent].map(|i| nodes[i].mass).into_iter().filter(|m| *m > 0.0);
        let lightest = mass.fold(f64::INFINITY, f64::min);
        pull * h.abs() / lightest
    }

    /// What a loop does not allow of the motions, with what is taken back, and its relative Cayley vector.
    fn locked(&self, child: &Motion, parent: &Motion) -> (Twist, Vector3<f64>) {
        let Kind::Loop { joint, ball, .. } = &self.kind else { return (Spatial::ZERO, Vector3::zeros()) };
        let frame = JointFrame { arm: self.arm, offset: self.parent_arm, axes: self.axes };
        let moved = RelativeMotion::new(&frame, &Vector3::zeros(), child, parent);
        let locked = moved.locked(joint, &frame, parent);
        let linear = ball.as_ref().map_or(locked.linear, |ball| moved.locked(ball, &frame, parent).linear);
        (Spatial::new(linear, locked.angular) + self.gap0, moved.turn)
    }
}
