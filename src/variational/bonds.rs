//! What holds between bodies beside the joints of the tree: loop closures, couplings and springs between points.
//!
//! Each is one or more scalar [`Row`]s. Loops and couplings are constraints like the joints: an impulse `nu` along their
//! rows in the first half kick makes them hold at `q1`, another in the second makes their velocities vanish there. A
//! spring with a damper has the discrete potential and force of the distance `d` at both ends of the step,
//!
//! ```text
//! nu = -h/2 k ((d0 + d1)/2 - rest) - c/2 (d1 - d0)      in both half kicks, along grad d(q0) and grad d(q1),
//! ```
//!
//! which is a row with the compliance `1 / (kappa h)`, `kappa = h k / 4 + c / 2`: a stiff spring costs what a soft one
//! costs and tends to a rod. Where its points coincide it has no direction and does not pull; and a spring so stiff and so
//! far stretched that without it the points would pass each other within a step may settle on the other side, which solves
//! the same equation. Distances and couplings are running sums of their changes over the steps; what a change is
//! follows from the motions of the bodies, so that small steps do not cancel.

use nalgebra::{Matrix3, SVector, Vector3};

use super::compensated::Compensated;
use super::joints::{Motion, Moved, Node, Place, Pose, mismatch};
use super::newton::closing_twist;
use super::rows::Row;
use super::spatial::{Spatial, Twist};
use crate::mechanics::{JointKind, System};
use crate::model::scene::LoopKind;

/// What a bond is.
#[derive(Clone, Debug)]
enum Kind {
    /// A joint between two nodes of the tree. `ball` is the same as a ball joint where all motion is locked: the linear part
    /// of the lock is the ball joint's then, the angular part that of `joint`, a slider.
    Loop { kind: LoopKind, joint: Box<Node>, ball: Option<Box<Node>> },
    /// `theta(follower) - multiplier theta(source)` stays what it is.
    Coupling { source: usize, multiplier: f64 },
    /// A spring from the parent's point to the child's.
    Spring { from: Vector3<f64>, to: Vector3<f64>, stiffness: f64, damping: f64, rest: f64 },
}

/// A bond, and where it is at the start of the step.
#[derive(Clone, Debug)]
pub(super) struct Bond {
    kind: Kind,
    child: usize,
    parent: usize,
    /// The rows `first..first + count`.
    first: usize,
    count: usize,
    /// From the bodies' centres of mass to the joint point or the springs' points, and the joint's axes.
    arm: Vector3<f64>,
    parent_arm: Vector3<f64>,
    axes: Matrix3<f64>,
    /// The part of a loop's mismatch that the next step takes away.
    gap0: Twist,
    /// The way from a spring's first point to its second, m.
    span: Vector3<f64>,
    /// Of a spring how far it is stretched, m; of a coupling what it is open by, rad or m.
    length: Compensated<1>,
    /// Change of `length` over the step that is being tried.
    change: f64,
}

/// A step that is being tried: where it starts, and the motions of the nodes.
pub(super) struct Trying<'a> {
    pub nodes: &'a [Node],
    pub pose: &'a [Pose],
    pub places: &'a [Place],
    pub motion: &'a dyn Fn(usize) -> Motion,
}

/// The bonds of a system: loops, couplings, springs, in this order, so that the rows of springs come last.
pub(super) fn bonds(system: &System, nodes: &[Node]) -> Vec<Bond> {
    let node = |body: Option<usize>| body.map_or(0, |b| b + 1);
    let parts = &system.parts;
    let loops = parts.loops.iter().map(|closure| {
        let joint = |kind| {
            Box::new(Node {
                parent: node(closure.parent),
                kind,
                arm: closure.in_child.translation.vector,
                frame: closure.in_child.rotation.to_rotation_matrix().into_inner(),
                parent_arm: closure.in_parent.translation.vector,
                parent_frame: closure.in_parent.rotation.to_rotation_matrix().into_inner(),
                ..nodes[0].clone()
            })
        };
        let (kind, ball) = match closure.kind {
            LoopKind::Revolute => (JointKind::Revolute, None),
            LoopKind::Spherical => (JointKind::Spherical, None),
            LoopKind::Prismatic => (JointKind::Prismatic, None),
            LoopKind::Fixed => (JointKind::Prismatic, Some(joint(JointKind::Spherical))),
        };
        let count = closure.locked().iter().filter(|locked| **locked).count();
        let kind = Kind::Loop { kind: closure.kind, joint: joint(kind), ball };
        (kind, node(closure.child), node(closure.parent), count)
    });
    let couplings = parts.couplings.iter().map(|coupling| {
        let kind = Kind::Coupling { source: coupling.source + 1, multiplier: coupling.multiplier };
        (kind, coupling.follower + 1, nodes[coupling.follower + 1].parent, 1)
    });
    let springs = parts.point_springs.iter().filter(|spring| spring.stiffness > 0.0 || spring.damping > 0.0);
    let springs = springs.map(|spring| {
        let kind = Kind::Spring {
            from: spring.from.point,
            to: spring.to.point,
            stiffness: spring.stiffness,
            damping: spring.damping,
            rest: spring.rest_length,
        };
        (kind, node(spring.to.body), node(spring.from.body), 1)
    });
    let mut first = 0;
    let bond = |(kind, child, parent, count)| {
        first += count;
        Bond {
            kind,
            child,
            parent,
            first: first - count,
            count,
            arm: Vector3::zeros(),
            parent_arm: Vector3::zeros(),
            axes: Matrix3::identity(),
            gap0: Spatial::ZERO,
            span: Vector3::zeros(),
            length: Compensated::new(SVector::zeros()),
            change: 0.0,
        }
    };
    loops.chain(couplings).chain(springs).map(bond).collect()
}

impl Bond {
    pub(super) fn is_spring(&self) -> bool {
        matches!(self.kind, Kind::Spring { .. })
    }

    pub(super) fn rows(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.count
    }

    /// The compliance of a spring's row over a step.
    pub(super) fn compliance(&self, h: f64) -> f64 {
        1.0 / (self.kappa(h) * h)
    }

    fn kappa(&self, h: f64) -> f64 {
        match self.kind {
            Kind::Spring { stiffness, damping, .. } => 0.25 * h * stiffness + 0.5 * damping,
            _ => f64::INFINITY,
        }
    }

    /// Takes the stretch of a spring from the positions, before the first step. It is summed up and not the distance, whose
    /// roundoff would be a force of a stiff spring.
    pub(super) fn start(&mut self) {
        self.length = Compensated::new(SVector::from([self.stretch()]));
    }

    /// Places the bond in a configuration and writes its rows there. `back` is the part of a mismatch that one step
    /// takes away.
    pub(super) fn place(&mut self, nodes: &[Node], pose: &[Pose], places: &[Place], back: f64, rows: &mut [Row]) {
        let (child, parent) = (pose[self.child], pose[self.parent]);
        match &self.kind {
            Kind::Loop { joint, ball, .. } => {
                self.arm = child.r * joint.arm;
                self.parent_arm = (child.x - parent.x) + self.arm;
                self.axes = parent.r * joint.parent_frame;
                let gap = mismatch(joint, &child, &parent);
                let linear = ball.as_ref().map_or(gap.linear, |ball| mismatch(ball, &child, &parent).linear);
                let angular = self.keep_reached(gap.angular);
                self.gap0 = Spatial::new(linear, angular).scaled(back);
            }
            Kind::Coupling { .. } => self.gap0.linear.x = back * self.length.value.x,
            Kind::Spring { from, to, .. } => {
                self.arm = child.r * to;
                self.parent_arm = parent.r * from;
                self.span = (child.x - parent.x) + (self.arm - self.parent_arm);
            }
        }
        let arms = |i: usize| places[i].arm;
        let axes = |i: usize| places[i].axes;
        self.write_rows(nodes, &Configuration { arm: &arms, axes: &axes, moved: None }, pose, rows);
    }

    /// The rows at the end of the motions that are being tried.
    pub(super) fn rows_after(&self, at: &Trying, rows: &mut [Row]) {
        let turned = |i: usize, v: Vector3<f64>| v + (at.motion)(i).turned(&v);
        let arms = |i: usize| turned(i, at.places[i].arm);
        let axes = |i: usize| {
            let (axes, parent) = (at.places[i].axes, at.nodes[i].parent);
            Matrix3::from_columns(&[0, 1, 2].map(|k| turned(parent, axes.column(k).into_owned())))
        };
        self.write_rows(at.nodes, &Configuration { arm: &arms, axes: &axes, moved: Some(at.motion) }, at.pose, rows);
    }

    fn write_rows(&self, nodes: &[Node], at: &Configuration, pose: &[Pose], rows: &mut [Row]) {
        let turned = |i: usize, v: Vector3<f64>| at.moved.map_or(v, |motion| v + motion(i).turned(&v));
        // About the joint point of a node, a wrench at the point `arm` away from its centre of mass.
        let about = |i: usize, wrench: &Spatial, arm: &Vector3<f64>| wrench.wrench_from(&(arm - (at.arm)(i)));
        let rows = &mut rows[self.rows()];
        rows.fill(Row::NONE);
        let drift = at.moved.map_or(Vector3::zeros(), |motion| motion(self.child).dx - motion(self.parent).dx);
        match &self.kind {
            Kind::Loop { kind, .. } => {
                let arm = turned(self.child, self.arm);
                let between = pose[self.child].x - pose[self.parent].x + drift;
                let parent_arm = between + arm;
                for (row, (slot, axis)) in rows.iter_mut().zip(locked_axes(*kind)) {
                    let axis = turned(self.parent, self.axes.column(axis).into_owned());
                    let wrench = match slot {
                        Slot::Linear => Spatial::new(axis, Vector3::zeros()),
                        Slot::Angular => Spatial::new(Vector3::zeros(), axis),
                    };
                    row.push(self.child, about(self.child, &wrench, &arm));
                    row.push(self.parent, -about(self.parent, &wrench, &parent_arm));
                }
            }
            Kind::Coupling { source, multiplier } => {
                for (node, factor) in [(self.child, 1.0), (*source, -multiplier)] {
                    let axis = (at.axes)(node).column(2).into_owned() * factor;
                    let wrench = match nodes[node].kind {
                        JointKind::Prismatic => Spatial::new(axis, Vector3::zeros()),
                        _ => Spatial::new(Vector3::zeros(), axis),
                    };
                    let parent = nodes[node].parent;
                    let drift = at.moved.map_or(Vector3::zeros(), |motion| motion(node).dx - motion(parent).dx);
                    let to_point = pose[node].x - pose[parent].x + drift + (at.arm)(node);
                    rows[0].push(node, wrench);
                    rows[0].push(parent, -about(parent, &wrench, &to_point));
                }
            }
            Kind::Spring { .. } => {
                let (arm, parent_arm) = (turned(self.child, self.arm), turned(self.parent, self.parent_arm));
                let span = (pose[self.child].x - pose[self.parent].x) + drift + (arm - parent_arm);
                let direction = span.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
                let wrench = Spatial::new(direction, Vector3::zeros());
                rows[0].push(self.child, about(self.child, &wrench, &arm));
                rows[0].push(self.parent, -about(self.parent, &wrench, &parent_arm));
            }
        }
    }

    /// What the motions of a step leave the bond short of: writes one figure a row (m, rad) into `gap`. `nu` are the rows'
    /// impulses. Returns what roundoff may do to the gap, over `f64::EPSILON`.
    pub(super) fn measure(
        &mut self,
        h: f64,
        nodes: &[Node],
        places: &[Place],
        motion: &dyn Fn(usize) -> Motion,
        nu: &[f64],
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
                    let (place, above) = (&places[node], nodes[node].parent);
                    let carried = motion(above);
                    let moved = Moved::new(place, &places[above].arm, &motion(node), &carried);
                    moved.travel(&nodes[node], place, &carried).x
                };
                let (follower, followed) = (travel(self.child), travel(*source));
                self.change = follower - multiplier * followed;
                gap[0] = self.change + self.gap0.linear.x;
                follower.abs() + (multiplier * followed).abs()
            }
            Kind::Spring { stiffness, damping, .. } => {
                let moved = (child.dx - parent.dx) + (child.turned(&self.arm) - parent.turned(&self.parent_arm));
                let span = self.span;
                let (before, after) = (span.norm(), (span + moved).norm());
                let sum = before + after;
                self.change = if sum > 0.0 { (2.0 * span.dot(&moved) + moved.norm_squared()) / sum } else { 0.0 };
                let stretch = self.length.value.x + 0.5 * self.change;
                let short = nu[0] + 0.5 * h * stiffness * stretch + 0.5 * damping * self.change;
                gap[0] = short / self.kappa(h);
                let force = (nu[0] / self.kappa(h)).abs();
                force + stretch.abs() + moved.norm() + self.moved_by(nu, h, nodes)
            }
        }
    }

    /// How large the gap of the bond's rows is, m; angles times `length`.
    pub(super) fn size(&self, nodes: &[Node], gap: &[f64], length: f64) -> f64 {
        match &self.kind {
            Kind::Loop { kind, .. } => {
                let part = |which: Slot| {
                    let rows = locked_axes(*kind).zip(gap).filter(|((slot, _), _)| *slot == which);
                    rows.map(|(_, gap)| gap * gap).sum::<f64>().sqrt()
                };
                part(Slot::Linear) + length * part(Slot::Angular)
            }
            Kind::Coupling { .. } if nodes[self.child].kind != JointKind::Prismatic => length * gap[0].abs(),
            Kind::Coupling { .. } | Kind::Spring { .. } => gap[0].abs(),
        }
    }

    /// The relative twists that close a loop in `h`, along its rows at the end of the motions: the target of the exact
    /// linearisation. Bonds of one row have theirs in `gap`.
    pub(super) fn targets_after(&self, h: f64, motion: &dyn Fn(usize) -> Motion, gap: &[f64], target: &mut [f64]) {
        let Kind::Loop { kind, .. } = &self.kind else {
            target[0] = -gap[0] / h;
            return;
        };
        let (child, parent) = (motion(self.child), motion(self.parent));
        let (locked, turn) = self.locked(&child, &parent);
        let bias = closing_twist(&locked, &turn, &parent, h);
        for (target, (slot, axis)) in target.iter_mut().zip(locked_axes(*kind)) {
            let axis = self.axes.column(axis).into_owned();
            let axis = axis + parent.turned(&axis);
            *target = match slot {
                Slot::Linear => axis.dot(&bias.linear),
                Slot::Angular => axis.dot(&bias.angular),
            };
        }
    }

    /// How far the impulses move the lighter body in a step, m: a stiff pull and the momentum that it turns round cancel.
    fn moved_by(&self, nu: &[f64], h: f64, nodes: &[Node]) -> f64 {
        let pull = nu.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let mass = [self.child, self.parent].map(|i| nodes[i].mass).into_iter().filter(|m| *m > 0.0);
        let lightest = mass.fold(f64::INFINITY, f64::min);
        pull * h.abs() / lightest
    }

    /// By how much a spring's points are farther apart than at rest, from the positions, m.
    fn stretch(&self) -> f64 {
        match self.kind {
            Kind::Spring { rest, .. } => self.span.norm() - rest,
            _ => 0.0,
        }
    }

    /// How fast a spring gets longer over the step that is being tried, m/s.
    pub(super) fn rate(&self, h: f64) -> f64 {
        self.change / h
    }

    /// Takes over the state of the same bond in another copy of the integrator.
    pub(super) fn copy_from(&mut self, other: &Bond) {
        (self.length, self.change) = (other.length, other.change);
    }

    /// Takes over what the accepted step has changed.
    pub(super) fn accept(&mut self, back: f64) {
        let correction = if self.is_spring() { back * (self.stretch() - self.length.value.x) } else { 0.0 };
        self.length.add(&SVector::from([self.change + correction]));
    }

    /// What a loop does not allow of the motions, with what is taken back, and its relative Cayley vector.
    fn locked(&self, child: &Motion, parent: &Motion) -> (Twist, Vector3<f64>) {
        let Kind::Loop { joint, ball, .. } = &self.kind else { return (Spatial::ZERO, Vector3::zeros()) };
        let place = Place { arm: self.arm, offset: self.parent_arm, axes: self.axes };
        let moved = Moved::new(&place, &Vector3::zeros(), child, parent);
        let locked = moved.locked(joint, &place, parent);
        let linear = ball.as_ref().map_or(locked.linear, |ball| moved.locked(ball, &place, parent).linear);
        (Spatial::new(linear, locked.angular) + self.gap0, moved.turn)
    }

    /// The part of a small rotation that the loop's angular rows see.
    fn keep_reached(&self, angular: Vector3<f64>) -> Vector3<f64> {
        let Kind::Loop { kind, .. } = &self.kind else { return angular };
        let reached = locked_axes(*kind).filter(|(slot, _)| *slot == Slot::Angular);
        reached.map(|(_, axis)| self.axes.column(axis) * self.axes.column(axis).dot(&angular)).sum()
    }
}

/// Whether a row pushes or turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slot {
    Linear,
    Angular,
}

/// The rows of a loop: along or about which axes of the parent's joint frame.
fn locked_axes(kind: LoopKind) -> impl Iterator<Item = (Slot, usize)> {
    let (linear, angular) = match kind {
        LoopKind::Revolute => (3, 2),
        LoopKind::Spherical => (3, 0),
        LoopKind::Prismatic => (2, 3),
        LoopKind::Fixed => (3, 3),
    };
    (0..linear).map(|axis| (Slot::Linear, axis)).chain((0..angular).map(|axis| (Slot::Angular, axis)))
}

/// Where the nodes are: from their centres of mass to their joint points, and the axes of their joints.
struct Configuration<'a> {
    arm: &'a dyn Fn(usize) -> Vector3<f64>,
    axes: &'a dyn Fn(usize) -> Matrix3<f64>,
    /// Where it is the end of a step: the motions that lead there.
    moved: Option<&'a dyn Fn(usize) -> Motion>,
}
