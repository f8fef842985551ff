//! Joints of the tree between assemblies, with their initial coordinates.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::assemble::Welded;
use super::error::CompileError;
use super::principal::Principal;
use crate::mechanics::joint::{Joint, JointCoordinates};
use crate::mechanics::joint_kind::JointKind;
use crate::model::{self, Base, Scene};

/// A joint of the model between two assemblies, with its initial coordinates.
pub(super) fn tree_joint(
    scene: &Scene,
    index: usize,
    welded: &Welded,
    frames: &[Principal],
    ground: usize,
) -> (Joint, JointCoordinates) {
    let joint = &scene.model.joints[index];
    let kind = match joint.kind {
        model::JointKind::Revolute | model::JointKind::Continuous => JointKind::Revolute,
        model::JointKind::Prismatic => JointKind::Prismatic,
        model::JointKind::Planar => JointKind::Planar,
        model::JointKind::Spherical => JointKind::Spherical,
        // A fixed joint has been welded: none is left in the tree.
        model::JointKind::Floating | model::JointKind::Fixed => JointKind::Floating,
    };
    let align = if kind.has_axis() {
        Isometry3::from_parts(Translation3::identity(), from_z_to(&joint.axis))
    } else {
        Isometry3::identity()
    };
    let (above, parent_link) = welded.places[joint.parent];
    let (below, child_link) = welded.places[joint.child];
    let in_parent_assembly = parent_link * joint.origin * align;
    let parent = above.checked_sub(ground);
    let in_parent = match parent {
        Some(_) => frames[above].body_in_assembly.inverse() * in_parent_assembly,
        None => in_parent_assembly,
    };
    let in_child = frames[below].body_in_assembly.inverse() * child_link * align;
    let initial = &scene.initial[index];
    let compiled = Joint { name: joint.name.clone(), kind, parent, in_parent, in_child, damping: joint.damping };
    (compiled, padded(&initial.position, &initial.velocity))
}

/// The floating joint between the ground and a free root.
pub(super) fn base_joint(base: &Base, frame: &Principal) -> (Joint, JointCoordinates) {
    let theta = match base {
        Base::Fixed => JointCoordinates::default(),
        Base::Floating { pose, linear_velocity: v, angular_velocity: w } => {
            let (x, r) = (pose.translation.vector, pose.rotation.scaled_axis());
            padded(&[x.x, x.y, x.z, r.x, r.y, r.z], &[v.x, v.y, v.z, w.x, w.y, w.z])
        }
    };
    let joint = Joint {
        name: "base".to_string(),
        kind: JointKind::Floating,
        parent: None,
        in_parent: Isometry3::identity(),
        in_child: frame.body_in_assembly.inverse(),
        damping: 0.0,
    };
    (joint, theta)
}

fn padded(position: &[f64], velocity: &[f64]) -> JointCoordinates {
    let fill = |values: &[f64]| std::array::from_fn(|i| values.get(i).copied().unwrap_or(0.0));
    JointCoordinates { position: fill(position), velocity: fill(velocity) }
}

/// The shortest rotation that turns z to the axis; half a turn about x where the axis is -z.
pub(super) fn from_z_to(axis: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(&Vector3::z(), axis)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
}

pub(super) fn check(scene: &Scene, link: &str, joint: &Joint, frame: &Principal) -> Result<(), CompileError> {
    let (scene, link, name) = (scene.name.clone(), link.to_string(), joint.name.clone());
    let (least, most) = (frame.moments.min(), frame.moments.max());
    if !(frame.mass > 0.0) && most > 0.0 {
        return Err(CompileError::Massless { scene, link, joint: name });
    }
    if !(least > 0.0) && most > 0.0 {
        return Err(CompileError::NoInertia { scene, link, joint: name, moment: least });
    }
    if joint.kind.is_free() && joint.damping > 0.0 {
        return Err(CompileError::FloatingDamping { scene, joint: name, damping: joint.damping });
    }
    Ok(())
}
