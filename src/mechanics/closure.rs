//! Joints that close loops of the tree.

use nalgebra::Isometry3;

use super::joint::Joint;
use super::joint_kind::JointKind;
use super::relative::RelativeMotion;
use super::state::{BodyState, State};
use crate::model::scene::LoopKind;

/// A joint that closes a loop between two bodies which the tree already connects; `None` is the ground.
#[derive(Clone, Debug)]
pub struct Closure {
    pub name: String,
    pub kind: LoopKind,
    pub parent: Option<usize>,
    pub child: Option<usize>,
    /// Pose of the joint frame in the parent body's frame (in the world for the ground); its z axis is the joint's
    /// axis.
    pub in_parent: Isometry3<f64>,
    /// Pose of the joint frame in the child body's frame (in the world for the ground).
    pub in_child: Isometry3<f64>,
}

impl Closure {
    /// Which components of a relative twist (linear x, y, z, angular x, y, z) the closure does not allow.
    pub fn locked(&self) -> [bool; 6] {
        self.joint_kind().map_or([true; 6], |kind| kind.free().map(|free| !free))
    }

    /// What the closure does not allow of the relative pose (m, rad) and of the relative twist (m/s, rad/s): the
    /// [`Closure::locked`] components, in the axes of the parent's joint frame.
    pub fn residual(&self, state: &State) -> (Vec<f64>, Vec<f64>) {
        let body = |index: Option<usize>| index.map_or(BodyState::ground(), |b| state.bodies[b]);
        let joint = Joint {
            name: self.name.clone(),
            kind: self.joint_kind().unwrap_or(JointKind::Floating),
            parent: self.parent,
            in_parent: self.in_parent,
            in_child: self.in_child,
            damping: 0.0,
        };
        let placed = RelativeMotion::new(&joint, &body(self.child), self.parent.map(|p| &state.bodies[p]));
        let pose = match self.joint_kind() {
            Some(kind) => kind.decompose(&placed.relative).1,
            None => position_and_rotation(&placed.relative),
        };
        let (v, w) = placed.twist;
        let twist = [v.x, v.y, v.z, w.x, w.y, w.z];
        let locked = self.locked();
        let pick = |values: [f64; 6]| (0..6).filter(|&i| locked[i]).map(|i| values[i]).collect();
        (pick(pose), pick(twist))
    }

    /// The joint that leaves the same motions free; `None` where it leaves none.
    fn joint_kind(&self) -> Option<JointKind> {
        match self.kind {
            LoopKind::Revolute => Some(JointKind::Revolute),
            LoopKind::Prismatic => Some(JointKind::Prismatic),
            LoopKind::Spherical => Some(JointKind::Spherical),
            LoopKind::Fixed => None,
        }
    }
}

/// A relative pose as a position and a rotation vector.
fn position_and_rotation(relative: &Isometry3<f64>) -> [f64; 6] {
    let (t, r) = (relative.translation.vector, relative.rotation.scaled_axis());
    [t.x, t.y, t.z, r.x, r.y, r.z]
}
