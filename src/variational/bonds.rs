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
//! costs and tends to a rod. Distances and couplings are running sums of their changes over the steps; what a change is
//! follows from the motions of the bodies, so that small steps do not cancel.
//!
//! On a line, with `beta = kappa h T` for the mobility `T` of the row, the end `y1` of the way between the points obeys
//!
//! ```text
//! y1 + beta |y1| = b .
//! ```
//!
//! Where `beta > 1` there are two solutions for `b > 0`, of which the one with `y1 < 0` is false, and none for `b < 0`. Where
//! `beta < 1` there is one, but with `y1 < 0` the direction turns round within the step and each such pass errs in energy by
//! about `beta` of what the spring holds. So beyond `beta` of [`PASS`] a distance on the far side counts as negative, which
//! leads the iteration back, and a step that ends there all the same is refused.
//!
//! A spring with the rest length 0 needs no direction: `V = k/2 |D|^2` for the way `D` from point to point, and
//!
//! ```text
//! nu = -h/2 k (D0 + D1)/2
//! ```
//!
//! is three rows along the world's axes. A damper beside it is a row of its own, along the way; where the points coincide
//! it has no direction and does not pull, as any spring.

use nalgebra::{Matrix3, Vector3};

use super::compensated::Compensated3;
use super::joints::{Motion, Mount, Moved, Node, Place, Pose, mismatch};
use super::newton::closing_twist;
use super::rows::Row;
use super::spatial::{Spatial, Twist};
use crate::mechanics::{JointKind, PointSpring, System};
use crate::model::scene::LoopKind;

/// What a bond is.
#[derive(Clone, Debug)]
enum Kind {
    /// A joint between two nodes of the tree. `ball` is the same as a ball joint where all motion is locked: the linear part
    /// of the lock is the ball joint's then, the angular part that of `joint`, a slider.
    Loop { kind: LoopKind, joint: Box<Node>, ball: Option<Box<Node>> },
    /// `theta(follower) - multiplier theta(source)` stays what it is.
    Coupling { source: usize, multiplier: f64 },
    /// A spring from the parent's point to the child's: one row along the way between them.
    Spring { from: Vector3<f64>, to: Vector3<f64>, stiffness: f64, damping: f64, rest: f64 },
    /// The same with the rest length 0: three rows along the world's axes, and one along the way if there is a damper.
    Pull { from: Vector3<f64>, to: Vector3<f64>, stiffness: f64, damping: f64 },
}

/// The largest `beta` with which the points of a spring may pass each other within a step: two bodies that pass on a line for
/// 20 000 steps change their energy by up to 0.2 at a `beta` of 0.01, by up to 0.05 at 1e-4, and without bound from 0.16 on.
const PASS: f64 = 0.01;

/// The largest compliance of a row, m/(N s^2): its square root stays a number.
const SLACK: f64 = 1e200;

/// Rows of a spring, at most.
const SPRING_ROWS: usize = 4;

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
    /// Of a spring how far it is stretched, m, as a vector if its rest length is 0; of a coupling what it is open by, rad or m.
    length: Compensated3,
    /// Change of what each row sees over the step that is being tried. The first three belong to `length`.
    change: [f64; SPRING_ROWS],
    /// A spring whose points must not pass each other, and how far apart they are on the far side in the step that is being
    /// tried, m.
    stiff: bool,
    passed: f64,
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
                mount: Box::new(Mount {
                    arm: closure.in_child.translation.vector,
                    frame: closure.in_child.rotation.to_rotation_matrix().into_inner(),
                    parent_arm: closure.in_parent.translation.vector,
                    parent_frame: closure.in_parent.rotation.to_rotation_matrix().into_inner(),
                }),
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
    let springs = parts.point_springs.iter().map(|spring| {
        let (from, to) = (spring.from.point, spring.to.point);
        let PointSpring { stiffness, damping, rest_length: rest, .. } = *spring;
        let (kind, count) = match (stiffness > 0.0, damping > 0.0) {
            (false, false) => (Kind::Spring { from, to, stiffness, damping, rest }, 0),
            (true, _) if rest == 0.0 => (Kind::Pull { from, to, stiffness, damping }, 3 + usize::from(damping > 0.0)),
            _ => (Kind::Spring { from, to, stiffness, damping, rest }, 1),
        };
        (kind, node(spring.to.body), node(spring.from.body), count)
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
            length: Vector3::zeros().into(),
            change: [0.0; SPRING_ROWS],
            stiff: false,
            passed: 0.0,
        }
    };
    loops.chain(couplings).chain(springs).map(bond).collect()
}

impl Bond {
    pub(super) fn is_spring(&self) -> bool {
        matches!(self.kind, Kind::Spring { .. } | Kind::Pull { .. })
    }

    pub(super) fn rows(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.count
    }

    /// The compliances of a spring's rows over a step.
    pub(super) fn compliances(&self, h: f64) -> impl Iterator<Item = f64> {
        (0..self.count).map(move |row| (1.0 / (self.kappa(row, h) * h)).min(SLACK))
    }

    fn kappa(&self, row: usize, h: f64) -> f64 {
        match self.kind {
            Kind::Spring { stiffness, damping, .. } => 0.25 * h * stiffness + 0.5 * damping,
            Kind::Pull { stiffness, .. } if row < 3 => 0.25 * h * stiffness,
            Kind::Pull { damping, .. } => 0.5 * damping,
            _ => f64::INFINITY,
        }
    }

    /// Takes the mobility of a spring's first row, for a step of size `h`.
    pub(super) fn measure_stiffness(&mut self, h: f64, mobility: f64) {
        self.stiff = self.kappa(0, h) * h * mobility > PASS;
    }

    /// Takes the stretch of a spring from the positions, before the first step. It is summed up and not the distance, whose
    /// roundoff would be a force of a stiff spring.
    pub(super) fn start(&mut self) {
        self.length = self.stretch().into();
    }

    /// Places the bond in a configuration and writes its rows there. `back` is the part of a mismatch that one step
    /// takes away.
    pub(super) fn place(&mut self, nodes: &[Node], pose: &[Pose], places: &[Place], back: f64, rows: &mut [Row]) {
        let (child, parent) = (pose[self.child], pose[self.parent]);
        match &self.kind {
            Kind::Loop { joint, ball, .. } => {
                self.arm = child.r * joint.mount.arm;
                self.parent_arm = (child.x - parent.x) + self.arm;
                self.axes = parent.r * joint.mount.parent_frame;
                let gap = mismatch(joint, &child, &parent);
                let linear = ball.as_ref().map_or(gap.linear, |ball| mismatch(ball, &child, &parent).linear);
                let angular = self.keep_reached(gap.angular);
                self.gap0 = Spatial::new(linear, angular).scaled(back);
            }
            Kind::Coupling { .. } => self.gap0.linear.x = back * self.length.value.x,
            Kind::Spring { from, to, .. } | Kind::Pull { from, to, .. } => {
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
            Kind::Spring { .. } | Kind::Pull { .. } => {
                let (arm, parent_arm) = (turned(self.child, self.arm), turned(self.parent, self.parent_arm));
                let span = (pose[self.child].x - pose[self.parent].x) + drift + (arm - parent_arm);
                let side = if at.moved.is_some() && self.passed > 0.0 { -1.0 } else { 1.0 };
                let along = side * span.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
                let axes = matches!(self.kind, Kind::Pull { .. }).then(|| [0, 1, 2].map(|k| Vector3::ith(k, 1.0)));
                for (row, axis) in rows.iter_mut().zip(axes.into_iter().flatten().chain([along])) {
                    let wrench = Spatial::new(axis, Vector3::zeros());
                    row.push(self.child, about(self.child, &wrench, &arm));
                    row.push(self.parent, -about(self.parent, &wrench, &parent_arm));
                }
            }
        }
    }

    /// What the motions of a step leave the bond short of: writes one figure a row (m, rad) into `gap`. `nu` are the rows'
    /// impulses, `grip` by how much the gap of a spring moves the bodies, over the gap. Returns what roundoff may do to the motion,
    /// over `f64::EPSILON`.
    pub(super) fn measure(
        &mut self,
        h: f64,
        nodes: &[Node],
        places: &[Place],
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
                    let (place, above) = (&places[node], nodes[node].parent);
                    let carried = motion(above);
                    let moved = Moved::new(place, &places[above].arm, &motion(node), &carried);
                    moved.travel(&nodes[node], place, &carried).x
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
            _ => return 0.0,
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
            Kind::Coupling { .. } => gap[0].abs(),
            Kind::Spring { .. } | Kind::Pull { .. } => gap.iter().map(|gap| gap * gap).sum::<f64>().sqrt(),
        }
    }

    /// The relative twists that close a loop in `h`, along its rows at the end of the motions: the target of the exact
    /// linearisation. Couplings and springs have theirs in `gap`.
    pub(super) fn targets_after(&self, h: f64, motion: &dyn Fn(usize) -> Motion, gap: &[f64], target: &mut [f64]) {
        let Kind::Loop { kind, .. } = &self.kind else {
            target.iter_mut().zip(gap).for_each(|(target, gap)| *target = -gap / h);
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
    fn stretch(&self) -> Vector3<f64> {
        match self.kind {
            Kind::Spring { rest, .. } => Vector3::new(self.span.norm() - rest, 0.0, 0.0),
            Kind::Pull { .. } => self.span,
            _ => Vector3::zeros(),
        }
    }

    /// How fast what a spring's row sees changes over the step that is being tried, m/s.
    pub(super) fn rate(&self, row: usize, h: f64) -> f64 {
        self.change[row] / h
    }

    /// By how much the points of a spring pass each other in the step that is being tried where they must not, m.
    pub(super) fn passed(&self) -> f64 {
        self.passed
    }

    /// The potential of a spring in the middle of the last step, `k/2 |(D0 + D1)/2|^2` of its stretch `D`, J.
    pub(super) fn potential(&self) -> f64 {
        let (stiffness, change) = match self.kind {
            Kind::Spring { stiffness, .. } => (stiffness, Vector3::new(self.change[0], 0.0, 0.0)),
            Kind::Pull { stiffness, .. } => (stiffness, Vector3::new(self.change[0], self.change[1], self.change[2])),
            _ => return 0.0,
        };
        0.5 * stiffness * (self.length.value - 0.5 * change).norm_squared()
    }

    /// Takes over the state of the same bond in another copy of the integrator.
    pub(super) fn copy_from(&mut self, other: &Bond) {
        (self.length, self.change) = (other.length, other.change);
    }

    /// Takes over what the accepted step has changed.
    pub(super) fn accept(&mut self, back: f64) {
        let [x, y, z, _] = self.change;
        let change = match self.kind {
            Kind::Loop { .. } => return,
            Kind::Coupling { .. } => Vector3::new(x, 0.0, 0.0),
            Kind::Spring { .. } => Vector3::new(x, 0.0, 0.0) + back * (self.stretch() - self.length.value),
            Kind::Pull { .. } => Vector3::new(x, y, z) + back * (self.stretch() - self.length.value),
        };
        self.length.add(&change);
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
