//! What a scene asks of an engine, in a few words each.

use super::data::{Base, Scene};
use super::parts::{LoopKind, Spring};
use crate::model::joint::{Joint, JointKind};

impl Scene {
    /// What an engine must have to run this scene, such as `revolute joints` or `damping`; the same words for the same
    /// need in every scene, in a fixed order.
    pub fn needs(&self) -> Vec<String> {
        let joints = &self.model.joints;
        let any = |test: &dyn Fn(&Joint) -> bool| joints.iter().any(test);
        let kind = |kinds: &[JointKind]| any(&|j: &Joint| kinds.contains(&j.kind));
        let closes = |kind| self.loops.iter().any(|l| l.kind == kind);
        let mut children = vec![0_usize; self.model.links.len()];
        joints.iter().for_each(|j| children[j.parent] += 1);
        [
            (kind(&[JointKind::Revolute, JointKind::Continuous]), "revolute joints"),
            (kind(&[JointKind::Prismatic]), "prismatic joints"),
            (kind(&[JointKind::Planar]), "planar joints"),
            (kind(&[JointKind::Spherical]), "ball joints"),
            (kind(&[JointKind::Floating]), "floating joints"),
            (kind(&[JointKind::Fixed]), "welded links"),
            (children.iter().any(|n| *n > 1), "branches"),
            (matches!(self.base, Base::Floating { .. }), "floating base"),
            (self.gravity.norm() > 0.0, "gravity"),
            (any(&|j| j.damping > 0.0 && j.kind != JointKind::Fixed), "damping"),
            (any(&|j| j.mimic.is_some()), "mimic joints"),
            (closes(LoopKind::Revolute), "revolute loops"),
            (closes(LoopKind::Spherical), "ball loops"),
            (closes(LoopKind::Fixed), "fixed loops"),
            (closes(LoopKind::Prismatic), "prismatic loops"),
            (self.springs.iter().any(|s| matches!(s, Spring::Joint { .. })), "joint springs"),
            (self.springs.iter().any(|s| matches!(s, Spring::Points { .. })), "point springs"),
            (!self.drives.is_empty(), "drives"),
        ]
        .into_iter()
        .filter(|(needed, _)| *needed)
        .map(|(_, need)| need.to_owned())
        .collect()
    }

    /// Number of coordinates that the tree leaves free, before loops take some away.
    pub fn tree_degrees_of_freedom(&self) -> usize {
        let base = if matches!(self.base, Base::Floating { .. }) { 6 } else { 0 };
        base + self.model.joints.iter().map(|j| j.kind.degrees_of_freedom()).sum::<usize>()
    }
}
