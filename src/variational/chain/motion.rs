//! How a body and a joint move over a step.

use nalgebra::Vector3;

use super::frame::JointFrame;
use super::node::Node;
use crate::mechanics::JointKind;
use crate::variational::tree::spatial::{Spatial, Twist};

/// How a body has moved over a step.
#[derive(Clone, Copy, Debug)]
pub(in crate::variational) struct Motion {
    /// Change of the centre of mass, m.
    pub dx: Vector3<f64>,
    /// Cayley vector of the rotation, world axes.
    pub s: Vector3<f64>,
}

impl Motion {
    pub(in crate::variational) const NONE: Motion =
        Motion { dx: Vector3::new(0.0, 0.0, 0.0), s: Vector3::new(0.0, 0.0, 0.0) };

    /// Change of a vector that turns with the body: `(F - 1) r = 2 / (1 + |s|^2) (s x r + s x (s x r))`, with the
    /// factor as `2 - 2 |s|^2 / (1 + |s|^2)`: rounded next to a power of two it would be too small on average.
    #[inline(always)]
    pub(in crate::variational) fn turned(&self, r: &Vector3<f64>) -> Vector3<f64> {
        let once = self.s.cross(r);
        let (twice, square) = (2.0 * (once + self.s.cross(&once)), self.s.norm_squared());
        twice - twice * (square / (1.0 + square))
    }
}

/// What a step has done to a joint that held at its start, computed from the motions alone: small steps do not cancel.
pub(in crate::variational) struct RelativeMotion {
    /// Change of the relative position of the joint point, seen from the parent's moved body, m.
    pub(super) gap: Vector3<f64>,
    /// Cayley vector of the relative rotation `F_parent^-1 F_child`.
    pub turn: Vector3<f64>,
}

impl RelativeMotion {
    /// `parent_arm` is the [`JointFrame::arm`] of the parent.
    #[inline(always)]
    pub(in crate::variational) fn new(
        frame: &JointFrame,
        parent_arm: &Vector3<f64>,
        child: &Motion,
        parent: &Motion,
    ) -> RelativeMotion {
        let gap = (child.dx - parent.dx) + (child.turned(&frame.arm) - parent.turned(&(parent_arm + frame.offset)));
        // (1, -b) (1, a) = (1 + a.b, a - b - b x a)
        let (a, b) = (&child.s, &parent.s);
        RelativeMotion { gap, turn: (a - b - b.cross(a)) * (1.0 / (1.0 + a.dot(b))) }
    }

    /// The part that the joint does not allow; zero exactly where the joint still holds.
    #[inline(always)]
    pub(in crate::variational) fn locked(&self, node: &Node, frame: &JointFrame, parent: &Motion) -> Twist {
        let z = frame.axes.column(2);
        let across = |v: &Vector3<f64>, z: &Vector3<f64>| v - z * z.dot(v);
        match node.kind {
            JointKind::Revolute => Spatial::new(self.gap, 2.0 * across(&self.turn, &z.into_owned())),
            JointKind::Spherical => Spatial::new(self.gap, Vector3::zeros()),
            JointKind::Prismatic => {
                let z = z + parent.turned(&z.into_owned());
                Spatial::new(across(&self.gap, &z), 2.0 * self.turn)
            }
            JointKind::Planar => {
                let turned = z + parent.turned(&z.into_owned());
                Spatial::new(turned * turned.dot(&self.gap), 2.0 * across(&self.turn, &z.into_owned()))
            }
            JointKind::Floating => Spatial::ZERO,
        }
    }

    /// Change of the coordinates of a joint with at most three of them. For a ball joint it is the rotation vector of
    /// the change, in the parent's joint frame.
    pub(in crate::variational) fn travel(&self, node: &Node, frame: &JointFrame, parent: &Motion) -> Vector3<f64> {
        let along = |k: usize| {
            let axis = frame.axes.column(k).into_owned();
            (axis + parent.turned(&axis)).dot(&self.gap)
        };
        let turn = frame.axes.tr_mul(&self.turn);
        match node.kind {
            JointKind::Revolute => Vector3::new(2.0 * turn.z.atan(), 0.0, 0.0),
            JointKind::Prismatic => Vector3::new(along(2), 0.0, 0.0),
            JointKind::Planar => Vector3::new(along(0), along(1), 2.0 * turn.z.atan()),
            JointKind::Spherical => {
                let length = turn.norm();
                if length > 0.0 { turn * (2.0 * length.atan() / length) } else { turn }
            }
            JointKind::Floating => Vector3::zeros(),
        }
    }
}
