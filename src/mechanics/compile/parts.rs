//! Loops, couplings, springs and drives of a scene between the bodies of the system.

use nalgebra::{Isometry3, Translation3};

use super::assemble::Welded;
use super::error::CompileError;
use super::joints::from_z_to;
use super::principal::Principal;
use crate::mechanics::closure::Closure;
use crate::mechanics::parts::{Anchor, Coupling, Drive, JointSpring, PointSpring};
use crate::model::{self, Scene};

/// From the links and joints of the model to the bodies that they have become.
pub(super) struct BodyMap<'a> {
    pub(super) scene: &'a Scene,
    pub(super) welded: &'a Welded,
    pub(super) frames: &'a [Principal],
    /// Number of assemblies that are the ground: 0 or 1.
    pub(super) ground: usize,
}

impl BodyMap<'_> {
    /// The body that a link is part of, and a pose in the link's frame in that body's frame; for the ground in the
    /// world.
    fn in_body(&self, link: Option<usize>, pose: Isometry3<f64>) -> (Option<usize>, Isometry3<f64>) {
        let Some(link) = link else { return (None, pose) };
        let (assembly, link_pose) = self.welded.places[link];
        match assembly.checked_sub(self.ground) {
            Some(body) => (Some(body), self.frames[assembly].body_in_assembly.inverse() * link_pose * pose),
            None => (None, link_pose * pose),
        }
    }

    /// The child body of a joint that is not fixed.
    fn body_of(&self, joint: usize) -> usize {
        self.welded.places[self.scene.model.joints[joint].child].0 - self.ground
    }

    /// Refuses what connects a body with itself.
    fn between(&self, what: String, a: Option<usize>, b: Option<usize>) -> Result<(), CompileError> {
        if a != b {
            return Ok(());
        }
        let top = |body: usize| self.welded.assemblies[body + self.ground].top;
        let body = a.map_or("world", |body| &self.scene.model.links[top(body)].name).to_string();
        Err(CompileError::WithinOneBody { scene: self.scene.name.clone(), what, body })
    }

    pub(super) fn loops(&self) -> Result<Vec<Closure>, CompileError> {
        let closure = |closure: &model::scene::Loop| {
            let align = Isometry3::from_parts(Translation3::identity(), from_z_to(&closure.axis));
            let (parent, in_parent) = self.in_body(closure.parent.link, closure.parent.origin * align);
            let (child, in_child) = self.in_body(closure.child.link, closure.child.origin * align);
            self.between(format!("loop '{}'", closure.name), parent, child)?;
            Ok(Closure { name: closure.name.clone(), kind: closure.kind, parent, child, in_parent, in_child })
        };
        self.scene.loops.iter().map(closure).collect()
    }

    pub(super) fn couplings(&self) -> Result<Vec<Coupling>, CompileError> {
        let joints = &self.scene.model.joints;
        let mimics = joints.iter().enumerate().filter_map(|(j, joint)| joint.mimic.as_ref().map(|mimic| (j, mimic)));
        let coupling = |(j, mimic): (usize, &model::Mimic)| {
            if [j, mimic.source].iter().any(|&j| joints[j].kind.degrees_of_freedom() != 1) {
                let (scene, joint) = (self.scene.name.clone(), joints[j].name.clone());
                let source_joint = joints[mimic.source].name.clone();
                return Err(CompileError::MimicCoordinates { scene, joint, source_joint });
            }
            let (follower, source) = (self.body_of(j), self.body_of(mimic.source));
            Ok(Coupling { follower, source, multiplier: mimic.multiplier, offset: mimic.offset })
        };
        mimics.map(coupling).collect()
    }

    pub(super) fn joint_springs(&self) -> Vec<JointSpring> {
        let spring = |spring: &model::scene::Spring| match *spring {
            model::scene::Spring::Joint { joint, stiffness, damping, rest } => {
                Some(JointSpring { body: self.body_of(joint), stiffness, damping, rest })
            }
            model::scene::Spring::Points { .. } => None,
        };
        self.scene.springs.iter().filter_map(spring).collect()
    }

    pub(super) fn point_springs(&self) -> Result<Vec<PointSpring>, CompileError> {
        let anchor = |anchor: &model::scene::Anchor| {
            let (body, pose) = self.in_body(anchor.link, Isometry3::from(anchor.point));
            Anchor { body, point: pose.translation.vector }
        };
        let spring = |(i, spring): (usize, &model::scene::Spring)| match spring {
            model::scene::Spring::Points { from, to, stiffness, damping, rest_length } => {
                let (from, to) = (anchor(from), anchor(to));
                let between = self.between(format!("springs[{i}]"), from.body, to.body);
                Some(between.map(|()| PointSpring {
                    from,
                    to,
                    stiffness: *stiffness,
                    damping: *damping,
                    rest_length: *rest_length,
                }))
            }
            model::scene::Spring::Joint { .. } => None,
        };
        self.scene.springs.iter().enumerate().filter_map(spring).collect()
    }

    pub(super) fn drives(&self) -> Vec<Drive> {
        let drive = |drive: &model::scene::Drive| Drive {
            body: self.body_of(drive.joint),
            effort: drive.effort,
            amplitude: drive.amplitude,
            angular_frequency: std::f64::consts::TAU * drive.frequency_hz,
            phase: drive.phase,
        };
        self.scene.drives.iter().map(drive).collect()
    }
}
