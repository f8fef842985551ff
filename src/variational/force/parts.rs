//! What acts beside gravity and the joints of a tree.

use nalgebra::Vector3;

use super::joint::{JointForce, joint_forces};
use super::loops::Loops;
use crate::mechanics::{State, System};
use crate::variational::chain::Node;
use crate::variational::tree::Tree;

/// Springs, dampers and drives along the coordinates of joints, rows across the tree, and bodies with next to no
/// inertia.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Parts {
    /// What acts along the joints' coordinates.
    pub forces: Vec<JointForce>,
    /// Where that depends on the motion: the factorisation with its implicit part, which (3) needs and (5) must not
    /// have.
    pub implicit: Option<Tree>,
    /// By how much `S . wrench` of a joint exceeds the impulse of its own forces.
    pub excess: Vec<Vector3<f64>>,
    /// Loops, couplings and springs between points.
    pub loops: Option<Box<Loops>>,
    /// Nodes with no or very little inertia.
    pub light: Vec<usize>,
}

impl Parts {
    /// `None` for a plain tree under gravity. Notes in the nodes which joints have forces of their own.
    pub(in crate::variational) fn new(
        system: &System,
        state: &State,
        nodes: &mut [Node],
        tree: &Tree,
    ) -> Option<Box<Parts>> {
        let forces = joint_forces(system, state, nodes);
        let implicit = forces.iter().any(JointForce::is_implicit).then(|| tree.clone());
        let loops = Loops::new(system, nodes, tree, implicit.is_some());
        let light: Vec<usize> = (1..nodes.len()).filter(|&i| nodes[i].light).collect();
        let plain = forces.is_empty() && loops.is_none() && light.is_empty();
        let excess = vec![Vector3::zeros(); nodes.len()];
        (!plain).then(|| Box::new(Parts { forces, implicit, excess, loops, light }))
    }

    /// The factorisation that (3) needs, where `plain` is that of (5).
    pub(in crate::variational) fn tree<'a>(&'a self, plain: &'a Tree) -> &'a Tree {
        self.implicit.as_ref().unwrap_or(plain)
    }

    /// Takes over the state of the same parts in another copy of the integrator.
    pub(in crate::variational) fn copy_from(&mut self, other: &Parts) {
        self.forces.iter_mut().zip(&other.forces).for_each(|(force, from)| force.copy_from(from));
        if let (Some(loops), Some(from)) = (&mut self.loops, &other.loops) {
            loops.copy_from(from);
        }
    }

    /// Whether there is nothing but light bodies among them.
    pub(in crate::variational) fn is_tree_under_gravity(&self) -> bool {
        self.forces.is_empty() && self.loops.is_none()
    }

    /// What the force of joint `i` adds to `D` at the end of a step of size `h`.
    #[inline(always)]
    pub(in crate::variational) fn late(&self, nodes: &[Node], i: usize, h: f64) -> f64 {
        if self.implicit.is_some() { nodes[i].force.map_or(0.0, |k| self.forces[k].late(h)) } else { 0.0 }
    }

    /// The joints with forces of their own, and the places of these in the list.
    pub(in crate::variational) fn forced(nodes: &[Node]) -> impl Iterator<Item = (usize, usize)> + '_ {
        nodes.iter().enumerate().skip(1).filter_map(|(i, node)| Some((i, node.force?)))
    }
}
