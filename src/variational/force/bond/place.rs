//! Where a bond is, and its rows there.

use nalgebra::{Matrix3, Vector3};

use super::state::{Bond, Kind};
use crate::model::scene::LoopKind;
use crate::variational::chain::{JointFrame, Motion, Node, Pose, mismatch};
use crate::variational::tree::row::Row;
use crate::variational::tree::spatial::Spatial;

/// A step that is being tried: where it starts, and the motions of the nodes.
pub(in crate::variational) struct Trying<'a> {
    pub nodes: &'a [Node],
    pub pose: &'a [Pose],
    pub frames: &'a [JointFrame],
    pub motion: &'a dyn Fn(usize) -> Motion,
}

impl Bond {
    /// Places the bond in a configuration and writes its rows there. `back` is the part of a mismatch that one step
    /// takes away.
    pub(in crate::variational) fn place(
        &mut self,
        nodes: &[Node],
        pose: &[Pose],
        frames: &[JointFrame],
        back: f64,
        rows: &mut [Row],
    ) {
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
        let arms = |i: usize| frames[i].arm;
        let axes = |i: usize| frames[i].axes;
        self.write_rows(nodes, &Configuration { arm: &arms, axes: &axes, moved: None }, pose, rows);
    }

    /// The rows at the end of the motions that are being tried.
    pub(in crate::variational) fn rows_after(&self, at: &Trying, rows: &mut [Row]) {
        let turned = |i: usize, v: Vector3<f64>| v + (at.motion)(i).turned(&v);
        let arms = |i: usize| turned(i, at.frames[i].arm);
        let axes = |i: usize| {
            let (axes, parent) = (at.frames[i].axes, at.nodes[i].parent);
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
                    let (force, torque) =
                        if nodes[node].slides() { (axis, Vector3::zeros()) } else { (Vector3::zeros(), axis) };
                    let wrench = Spatial::new(force, torque);
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

    /// The part of a small rotation that the loop's angular rows see.
    fn keep_reached(&self, angular: Vector3<f64>) -> Vector3<f64> {
        let Kind::Loop { kind, .. } = &self.kind else { return angular };
        let reached = locked_axes(*kind).filter(|(slot, _)| *slot == Slot::Angular);
        reached.map(|(_, axis)| self.axes.column(axis) * self.axes.column(axis).dot(&angular)).sum()
    }
}

/// Whether a row pushes or turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    Linear,
    Angular,
}

/// The rows of a loop: along or about which axes of the parent's joint frame.
pub(super) fn locked_axes(kind: LoopKind) -> impl Iterator<Item = (Slot, usize)> {
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
    pub(super) arm: &'a dyn Fn(usize) -> Vector3<f64>,
    pub(super) axes: &'a dyn Fn(usize) -> Matrix3<f64>,
    /// Where it is the end of a step: the motions that lead there.
    pub(super) moved: Option<&'a dyn Fn(usize) -> Motion>,
}
