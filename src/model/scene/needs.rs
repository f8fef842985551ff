//! What a scene asks of an engine, in a few words each.

use super::data::Scene;
use super::parts::{LoopKind, Spring};
use crate::model::joint::{Joint, JointKind};

impl Scene {
    /// What an engine must have to run this scene, such as `revolute joints` or `damping`; the same words for the same
    /// need in every scene, in a fixed order.
    pub fn needs(&self) -> Vec<String> {
        let joints = &self.model.joints;
        let any = |test: &dyn Fn(&Joint) -> bool| joints.iter().any(test);
        let mut children = vec![0_usize; self.model.links.len()];
        joints.iter().for_each(|j| children[j.parent] += 1);
        let moving = JointKind::ALL.into_iter().filter(|kind| !kind.is_weld());
        let welds = JointKind::ALL.into_iter().filter(|kind| kind.is_weld());
        let of_joints = moving.chain(welds).map(|kind| (any(&|j| j.kind == kind), kind.need()));
        let of_loops = LoopKind::ALL.map(|kind| (self.loops.iter().any(|l| l.kind == kind), kind.need()));
        let of_springs = Spring::NEEDS.map(|need| (self.springs.iter().any(|spring| spring.need() == need), need));
        let all = of_joints
            .chain([
                (children.iter().any(|n| *n > 1), "branches"),
                (self.base.is_floating(), "floating base"),
                (self.gravity.norm() > 0.0, "gravity"),
                (any(&|j| j.damping > 0.0 && !j.kind.is_weld()), "damping"),
                (any(&|j| j.mimic.is_some()), "mimic joints"),
            ])
            .chain(of_loops)
            .chain(of_springs)
            .chain([(!self.drives.is_empty(), "drives")]);
        let mut needs: Vec<String> = all.filter(|(needed, _)| *needed).map(|(_, need)| need.to_owned()).collect();
        needs.dedup();
        needs
    }

    /// Number of coordinates that the tree leaves free, before loops take some away.
    pub(crate) fn tree_degrees_of_freedom(&self) -> usize {
        let base = if self.base.is_floating() { 6 } else { 0 };
        base + self.model.joints.iter().map(|j| j.kind.degrees_of_freedom()).sum::<usize>()
    }
}
