//! Drives, as forces from outside that are set anew for each step.

use nalgebra::{Isometry3, Vector3};

use super::super::rapier::prelude::{PhysicsWorld, RigidBodyHandle};
use super::convert::{attitude_of, vector, vector_of};
use super::seat::Seat;
use crate::mechanics::{Drive, System};

/// The drives of one joint.
pub(super) struct DrivenJoint {
    child: RigidBodyHandle,
    parent: Option<RigidBodyHandle>,
    /// The joint frame in the parent body (in the world for the ground), and in the child body.
    in_parent: Isometry3<f64>,
    in_child: Vector3<f64>,
    turns: bool,
    drives: Vec<Drive>,
}

pub(super) fn driven_joints(system: &System, seats: &[Seat]) -> Vec<DrivenJoint> {
    let driven = |(i, seat): (usize, &Seat)| {
        let joint = &system.bodies[i].joint;
        let drives: Vec<Drive> = system.parts.drives.iter().filter(|drive| drive.body == i).cloned().collect();
        (!drives.is_empty()).then(|| DrivenJoint {
            child: seat.body,
            parent: joint.parent.map(|parent| seats[parent].body),
            in_parent: joint.in_parent,
            in_child: joint.in_child.translation.vector,
            turns: joint.kind.angle_index().is_some(),
            drives,
        })
    };
    seats.iter().enumerate().filter_map(driven).collect()
}

/// Puts the efforts at `time` (s) on the bodies, in the place of those of the step before.
pub(super) fn apply(joints: &[DrivenJoint], time: f64, physics: &mut PhysicsWorld) {
    for handle in joints.iter().flat_map(|joint| [Some(joint.child), joint.parent]).flatten() {
        let body = &mut physics.bodies[handle];
        body.reset_forces(true);
        body.reset_torques(true);
    }
    for joint in joints {
        let effort: f64 = joint.drives.iter().map(|drive| drive.at(time)).sum();
        let frame = joint.parent.map_or(Isometry3::identity(), |parent| placed(physics, parent));
        let along = frame * (joint.in_parent.rotation * (effort * Vector3::z()));
        let point = placed(physics, joint.child) * nalgebra::Point3::from(joint.in_child);
        for (handle, force) in [(Some(joint.child), along), (joint.parent, -along)] {
            let Some(body) = handle.map(|handle| &mut physics.bodies[handle]) else { continue };
            if joint.turns {
                body.add_torque(vector(&force), true);
            } else {
                body.add_force_at_point(vector(&force), vector(&point.coords), true);
            }
        }
    }
}

fn placed(physics: &PhysicsWorld, handle: RigidBodyHandle) -> Isometry3<f64> {
    let pose = physics.bodies[handle].position();
    Isometry3::from_parts(vector_of(pose.translation).into(), attitude_of(pose.rotation))
}
