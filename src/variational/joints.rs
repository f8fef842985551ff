//! Bodies and joints in the layout of the core: index 0 is the ground, body `b` of the system is node `b + 1`.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3, Vector4};

use super::compensated::Compensated3;
use super::spatial::{Spatial, Twist, Wrench};
use crate::mechanics::{JointKind, System};

/// A body and the joint that it hangs on. Constant over a run.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub parent: usize,
    pub kind: JointKind,
    /// kg
    pub mass: f64,
    /// Principal moments, kg m^2.
    pub inertia: Vector3<f64>,
    /// One over the smallest of them, 1/(kg m^2).
    pub thinnest: f64,
    /// Where the joint sits. Elsewhere, so that rounds of the constraint iteration, which read nodes many times, do not fetch it.
    pub mount: Box<Mount>,
    /// Where springs, dampers and drives act along the joint's coordinates: their place in the list of forces.
    pub force: Option<usize>,
    /// With no or very little inertia.
    pub light: bool,
    /// Articulated inertia along the joint that counts as none, kg or kg m^2; 0 unless light.
    pub least: f64,
}

/// The joint frame in the frames of the two bodies.
#[derive(Clone, Debug)]
pub(super) struct Mount {
    /// Its origin in the body frame, m.
    pub arm: Vector3<f64>,
    /// Its axes in the body frame.
    pub frame: Matrix3<f64>,
    /// Its origin in the parent's body frame, m.
    pub parent_arm: Vector3<f64>,
    /// Its axes in the parent's body frame.
    pub parent_frame: Matrix3<f64>,
}

/// The system's bodies behind a node for the ground.
pub(super) fn nodes(system: &System) -> Vec<Node> {
    let ground = Node {
        parent: 0,
        kind: JointKind::Floating,
        mass: f64::INFINITY,
        inertia: Vector3::repeat(f64::INFINITY),
        thinnest: 0.0,
        mount: Box::new(Mount {
            arm: Vector3::zeros(),
            frame: Matrix3::identity(),
            parent_arm: Vector3::zeros(),
            parent_frame: Matrix3::identity(),
        }),
        force: None,
        light: false,
        least: 0.0,
    };
    let bodies = system.bodies.iter().map(|body| {
        let joint = &body.joint;
        let (mut arm, mut parent_arm) = (joint.in_child.translation.vector, joint.in_parent.translation.vector);
        if joint.kind == JointKind::Prismatic {
            // A slider is the same wherever its rail is: the joint point is put at the centre of mass, so that a rail that is
            // far away has no leverage. Frames that are moved by the same vector keep every position.
            parent_arm -= joint.in_parent.rotation * (joint.in_child.rotation.inverse() * arm);
            arm = Vector3::zeros();
        }
        Node {
            parent: joint.parent.map_or(0, |p| p + 1),
            kind: joint.kind,
            mass: body.mass,
            inertia: body.inertia,
            thinnest: 1.0 / body.inertia.min(),
            mount: Box::new(Mount {
                arm,
                frame: joint.in_child.rotation.to_rotation_matrix().into_inner(),
                parent_arm,
                parent_frame: joint.in_parent.rotation.to_rotation_matrix().into_inner(),
            }),
            force: None,
            light: false,
            least: 0.0,
        }
    });
    std::iter::once(ground).chain(bodies).collect()
}

/// Where a body is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    /// Centre of mass, m, and what did not fit into it.
    pub x: Vector3<f64>,
    rest: Vector3<f64>,
    /// Attitude, quaternion coordinates (i, j, k, w).
    pub q: Vector4<f64>,
    /// The same as a matrix, body axes to world axes.
    pub r: Matrix3<f64>,
}

impl Pose {
    pub(super) const GROUND: Pose = Pose {
        x: Vector3::new(0.0, 0.0, 0.0),
        rest: Vector3::new(0.0, 0.0, 0.0),
        q: Vector4::new(0.0, 0.0, 0.0, 1.0),
        r: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
    };

    #[inline(always)]
    pub(super) fn new(x: &Compensated3, q: Vector4<f64>) -> Pose {
        let r = UnitQuaternion::new_unchecked(Quaternion::from(q)).to_rotation_matrix().into_inner();
        Pose { x: x.value, rest: *x.rest(), q, r }
    }

    /// The same somewhere else.
    pub(super) fn moved(&self, dx: &Vector3<f64>, r: Matrix3<f64>) -> Pose {
        Pose { x: self.x + dx, r, ..*self }
    }

    /// The way from another body's centre of mass, to the roundoff of that way and not of the positions.
    #[inline(always)]
    pub(super) fn way_from(&self, other: &Pose) -> Vector3<f64> {
        (self.x - other.x) + (self.rest - other.rest)
    }
}

/// A joint's place in a configuration, world axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// From the body's centre of mass to its joint point, the origin of the child's joint frame.
    pub arm: Vector3<f64>,
    /// From the parent's joint point to this one.
    pub offset: Vector3<f64>,
    /// Axes of the joint frame that is fixed in the parent.
    pub axes: Matrix3<f64>,
}

impl Place {
    pub(super) const GROUND: Place =
        Place { arm: Vector3::new(0.0, 0.0, 0.0), offset: Vector3::new(0.0, 0.0, 0.0), axes: Pose::GROUND.r };

    /// `parent_arm_at` is the [`Place::arm`] of the parent.
    #[inline(always)]
    pub(super) fn new(node: &Node, pose: &Pose, parent: &Pose, parent_arm_at: &Vector3<f64>) -> Place {
        let arm = pose.r * node.mount.arm;
        let offset = match node.kind {
            JointKind::Revolute | JointKind::Spherical => parent.r * node.mount.parent_arm - parent_arm_at,
            JointKind::Prismatic | JointKind::Planar | JointKind::Floating => {
                pose.way_from(parent) + (arm - parent_arm_at)
            }
        };
        Place { arm, offset, axes: parent.r * node.mount.parent_frame }
    }
}

/// What of a relative pose the joint does not allow: the twist that would build it up in one second. World axes; the
/// rotation part is exact to first order, and zero exactly where the joint holds.
#[inline(always)]
pub(super) fn mismatch(node: &Node, pose: &Pose, parent: &Pose) -> Twist {
    let gap = || pose.way_from(parent) + (pose.r * node.mount.arm - parent.r * node.mount.parent_arm);
    // The z axes of both joint frames: their cross product turns the parent's into the child's.
    let axis = || parent.r * node.mount.parent_frame.column(2);
    let tilt = |axis: &Vector3<f64>| axis.cross(&(pose.r * node.mount.frame.column(2)));
    match node.kind {
        JointKind::Revolute => Spatial::new(gap(), tilt(&axis())),
        JointKind::Spherical => Spatial::new(gap(), Vector3::zeros()),
        JointKind::Prismatic => {
            let (gap, axis) = (gap(), axis());
            let (child, parent_axes) = (pose.r * node.mount.frame, parent.r * node.mount.parent_frame);
            let turn = (0..3).map(|k| parent_axes.column(k).cross(&child.column(k))).sum::<Vector3<f64>>();
            // Twice: a long stroke leaves roundoff of its own length along the axis, where the joint cannot answer it.
            let across = gap - axis * axis.dot(&gap);
            Spatial::new(across - axis * axis.dot(&across), 0.5 * turn)
        }
        JointKind::Planar => {
            let axis = axis();
            Spatial::new(axis * axis.dot(&gap()), tilt(&axis))
        }
        JointKind::Floating => Spatial::ZERO,
    }
}

/// Takes away what a wrench about the joint point has along the joint's free directions: roundoff of a difference, or of
/// an extrapolation. Kept in the projection it cost order 8 on a pendulum a factor 60 in energy over 34 000 substeps.
#[inline(always)]
pub(super) fn keep_locked(node: &Node, place: &Place, wrench: &mut Wrench) {
    let z = place.axes.column(2);
    match node.kind {
        JointKind::Revolute => wrench.angular -= z * z.dot(&wrench.angular),
        JointKind::Prismatic => wrench.linear -= z * z.dot(&wrench.linear),
        JointKind::Planar => {
            wrench.linear = z * z.dot(&wrench.linear);
            wrench.angular -= z * z.dot(&wrench.angular);
        }
        JointKind::Spherical => wrench.angular = Vector3::zeros(),
        JointKind::Floating => *wrench = Spatial::ZERO,
    }
}

/// Components of a wrench along the coordinates of a joint with at most three of them.
pub(super) fn coordinates_of(node: &Node, place: &Place, wrench: &Wrench) -> Vector3<f64> {
    let (force, torque) = (place.axes.tr_mul(&wrench.linear), place.axes.tr_mul(&wrench.angular));
    match node.kind {
        JointKind::Revolute => Vector3::new(torque.z, 0.0, 0.0),
        JointKind::Prismatic => Vector3::new(force.z, 0.0, 0.0),
        JointKind::Planar => Vector3::new(force.x, force.y, torque.z),
        JointKind::Spherical => torque,
        JointKind::Floating => Vector3::zeros(),
    }
}

/// The wrench on the child about the joint point that has the given components along the joint's coordinates.
pub(super) fn along_joint(node: &Node, place: &Place, along: &Vector3<f64>) -> Wrench {
    let (force, torque) = match node.kind {
        JointKind::Revolute => (Vector3::zeros(), Vector3::new(0.0, 0.0, along.x)),
        JointKind::Prismatic => (Vector3::new(0.0, 0.0, along.x), Vector3::zeros()),
        JointKind::Planar => (Vector3::new(along.x, along.y, 0.0), Vector3::new(0.0, 0.0, along.z)),
        JointKind::Spherical => (Vector3::zeros(), *along),
        JointKind::Floating => (Vector3::zeros(), Vector3::zeros()),
    };
    Spatial::new(place.axes * force, place.axes * torque)
}

/// How a body has moved over a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    /// Change of the centre of mass, m.
    pub dx: Vector3<f64>,
    /// Cayley vector of the rotation, world axes.
    pub s: Vector3<f64>,
}

impl Motion {
    pub(super) const NONE: Motion = Motion { dx: Vector3::new(0.0, 0.0, 0.0), s: Vector3::new(0.0, 0.0, 0.0) };

    /// Change of a vector that turns with the body: `(F - 1) r = 2 / (1 + |s|^2) (s x r + s x (s x r))`, with the factor as
    /// `2 - 2 |s|^2 / (1 + |s|^2)`: rounded next to a power of two it would be too small on average.
    #[inline(always)]
    pub(super) fn turned(&self, r: &Vector3<f64>) -> Vector3<f64> {
        let once = self.s.cross(r);
        let (twice, square) = (2.0 * (once + self.s.cross(&once)), self.s.norm_squared());
        twice - twice * (square / (1.0 + square))
    }
}

/// What a step has done to a joint that held at its start, computed from the motions alone: small steps do not cancel.
pub(super) struct Moved {
    /// Change of the relative position of the joint point, seen from the parent's moved body, m.
    gap: Vector3<f64>,
    /// Cayley vector of the relative rotation `F_parent^-1 F_child`.
    pub turn: Vector3<f64>,
}

impl Moved {
    /// `parent_arm` is the [`Place::arm`] of the parent.
    #[inline(always)]
    pub(super) fn new(place: &Place, parent_arm: &Vector3<f64>, child: &Motion, parent: &Motion) -> Moved {
        let gap = (child.dx - parent.dx) + (child.turned(&place.arm) - parent.turned(&(parent_arm + place.offset)));
        // (1, -b) (1, a) = (1 + a.b, a - b - b x a)
        let (a, b) = (&child.s, &parent.s);
        Moved { gap, turn: (a - b - b.cross(a)) * (1.0 / (1.0 + a.dot(b))) }
    }

    /// The part that the joint does not allow; zero exactly where the joint still holds.
    #[inline(always)]
    pub(super) fn locked(&self, node: &Node, place: &Place, parent: &Motion) -> Twist {
        let z = place.axes.column(2);
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

    /// Change of the coordinates of a joint with at most three of them. For a ball joint it is the rotation vector of the
    /// change, in the parent's joint frame.
    pub(super) fn travel(&self, node: &Node, place: &Place, parent: &Motion) -> Vector3<f64> {
        let along = |k: usize| {
            let axis = place.axes.column(k).into_owned();
            (axis + parent.turned(&axis)).dot(&self.gap)
        };
        let turn = place.axes.tr_mul(&self.turn);
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
