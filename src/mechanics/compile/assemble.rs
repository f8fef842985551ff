//! Links that fixed joints hold together become one body.

use nalgebra::Isometry3;

use crate::model::Model;

/// Links that fixed joints hold together. Its frame is that of its link nearest to the root.
pub(super) struct Assembly {
    pub(super) top: usize,
    /// The model's joint above the top link, `None` for the root's assembly.
    pub(super) joint: Option<usize>,
    /// Each link with its pose in the assembly's frame.
    pub(super) links: Vec<(usize, Isometry3<f64>)>,
}

/// A model's links, grouped: the root's group first, and a parent's group before its child's.
pub(super) struct Welded {
    pub(super) assemblies: Vec<Assembly>,
    /// For each link its group and its pose in the group's frame.
    pub(super) places: Vec<(usize, Isometry3<f64>)>,
}

pub(super) fn weld(model: &Model) -> Welded {
    let mut places = vec![(0, Isometry3::identity()); model.links.len()];
    let mut assemblies = vec![Assembly { top: 0, joint: None, links: vec![(0, Isometry3::identity())] }];
    for (j, joint) in model.joints.iter().enumerate() {
        if joint.kind.is_weld() {
            let (group, pose) = places[joint.parent];
            places[joint.child] = (group, pose * joint.origin);
            assemblies[group].links.push((joint.child, pose * joint.origin));
        } else {
            places[joint.child] = (assemblies.len(), Isometry3::identity());
            let links = vec![(joint.child, Isometry3::identity())];
            assemblies.push(Assembly { top: joint.child, joint: Some(j), links });
        }
    }
    Welded { assemblies, places }
}
