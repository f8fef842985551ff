//! Lengths of a system that errors of position are divided by.

use crate::mechanics::System;
use crate::mechanics::path::{distance_to_parent, path_lengths};

/// The reach of a system, m: the longest path along the tree from the ground's joint to a centre of mass or, where all
/// of them are zero, the largest radius of gyration.
pub fn reach(system: &System) -> f64 {
    let paths = path_lengths(&system.bodies).into_iter().zip(&system.bodies);
    let longest = paths.map(|(path, body)| path + body.joint.in_child.translation.vector.norm()).fold(0.0, f64::max);
    if longest > 0.0 {
        return longest;
    }
    system.bodies.iter().map(|b| (b.inertia.max() / b.mass).sqrt()).fold(0.0, f64::max)
}

/// Lengths of the links of a system, m. A link is as long as the way from its joint to its centre of mass, or to the
/// joint of a link that it carries. A body whose joint is at its centre of mass counts with its radius of gyration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LinkLengths {
    pub mean: f64,
    /// The longest path along the tree from the ground, the last link included.
    pub longest_path: f64,
}

impl LinkLengths {
    pub fn of(system: &System) -> LinkLengths {
        let bodies = &system.bodies;
        let (mut sum, mut longest_path) = (0.0, 0.0f64);
        for (body, path) in bodies.iter().zip(path_lengths(bodies)) {
            let radius = if body.mass > 0.0 { (body.inertia.max() / body.mass).sqrt() } else { 0.0 };
            let arm = body.joint.in_child.translation.vector.norm().max(radius);
            sum += arm.max(distance_to_parent(bodies, body));
            longest_path = longest_path.max(path + arm);
        }
        LinkLengths { mean: sum / bodies.len() as f64, longest_path }
    }
}
