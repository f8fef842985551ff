//! Lengths along the tree, from joint to joint.

use super::body::Body;

/// Distance from the joint of a body's parent to its own, m; 0 for a body that the ground carries.
pub(crate) fn distance_to_parent(bodies: &[Body], body: &Body) -> f64 {
    body.joint
        .parent
        .map_or(0.0, |p| (body.joint.in_parent.translation.vector - bodies[p].joint.in_child.translation.vector).norm())
}

/// Length of the path along the tree from the ground's joint to the joint of each body, m.
pub(crate) fn path_lengths(bodies: &[Body]) -> Vec<f64> {
    let mut lengths: Vec<f64> = Vec::with_capacity(bodies.len());
    for body in bodies {
        lengths.push(body.joint.parent.map_or(0.0, |p| lengths[p] + distance_to_parent(bodies, body)));
    }
    lengths
}
