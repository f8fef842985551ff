//! Bodies and joints in the layout of the core: index 0 is the ground, body `b` of the system is node `b + 1`.

use nalgebra::{Matrix3, Vector3};

use crate::mechanics::{JointKind, System};

/// A body and the joint that it hangs on. Constant over a run.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Node {
    pub parent: usize,
    pub kind: JointKind,
    /// kg
    pub mass: f64,
    /// Principal moments, kg m^2.
    pub inertia: Vector3<f64>,
    /// One over the smallest of them, 1/(kg m^2).
    pub thinnest: f64,
    /// Where the joint sits. Elsewhere, so that rounds of the constraint iteration, which read nodes many times, do not
    /// fetch it.
    pub mount: Box<Mount>,
    /// Where springs, dampers and drives act along the joint's coordinates: their place in the list of forces.
    pub force: Option<usize>,
    /// With no or very little inertia.
    pub light: bool,
    /// Articulated inertia along the joint that counts as none, kg or kg m^2; 0 unless light.
    pub least: f64,
}

impl Node {
    /// Whether the joint's coordinate is a length, in m, and no angle.
    pub(in crate::variational) fn slides(&self) -> bool {
        match self.kind {
            JointKind::Prismatic => true,
            JointKind::Revolute | JointKind::Spherical | JointKind::Planar | JointKind::Floating => false,
        }
    }

    /// Whether the joint allows all motion, so that nothing passes to the parent.
    pub(in crate::variational) fn is_free(&self) -> bool {
        match self.kind {
            JointKind::Floating => true,
            JointKind::Revolute | JointKind::Prismatic | JointKind::Spherical | JointKind::Planar => false,
        }
    }
}

/// The joint frame in the frames of the two bodies.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Mount {
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
pub(in crate::variational) fn nodes(system: &System) -> Vec<Node> {
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
            // A slider is the same wherever its rail is: the joint point is put at the centre of mass, so that a rail
            // that is far away has no leverage. Frames that are moved by the same vector keep every position.
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
