//! What the methods hold, and where they start.

use nalgebra::{Matrix3, Vector3};

use super::attitude::Attitude;
use super::tableau::Tableau;
use crate::mechanics::{State, System};
use crate::variational::chain::{JointFrame, Node, Pose, nodes};
use crate::variational::rattle::{Body, Failure, bodies};
use crate::variational::tree::Tree;
use crate::variational::tree::spatial::{Spatial, Twist, Wrench};

/// A body and its joint at a stage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stage {
    /// Change of the position, m.
    pub dx: Vector3<f64>,
    pub frame: JointFrame,
    /// The joint's force on the child about its joint point, axes of the joint frame in the parent, N and N m.
    pub wrench: Wrench,
    /// Force of the joints on the body (N) and what they exert on it beside the moments of these forces (N m), world
    /// axes.
    pub load: Wrench,
    /// `sum f r^T` over the forces at points `r` of the body, in the body's frame at the start, N m. It does not change
    /// while the body turns.
    pub virial: Matrix3<f64>,
    /// The twist that closes the joint at this stage in a time `h`, axes of the joint frame in the parent.
    pub closing: Spatial,
}

/// Why a system cannot be advanced by these methods.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    #[error("joint {joint} is damped")]
    Damped { joint: usize },
    #[error("body {body} has no mass along a principal axis (Jd = {least:e} kg m^2)")]
    Flat { body: usize, least: f64 },
    #[error("{0:?}")]
    Failure(Failure),
}

/// The integrator. Nothing is allocated after [`Lobatto::new`]. Arrays run over the nodes as in
/// [`crate::variational::Rattle`].
#[derive(Clone, Debug)]
pub struct Lobatto {
    pub(super) tableau: Tableau,
    pub(super) nodes: Vec<Node>,
    pub(super) gravity: Vector3<f64>,
    pub(super) bodies: Vec<Body>,
    pub(super) pose: Vec<Pose>,
    pub(super) frames: Vec<JointFrame>,
    /// The factorisation at `q0`.
    pub(super) tree: Tree,
    /// Joints' frames and factorisations at the stages `2 ... s-1`, for the chord iteration.
    pub(super) inner: Vec<(Vec<JointFrame>, Tree)>,
    /// The part of the joints' mismatch at the start that the step takes away.
    pub(super) gap0: Vec<Twist>,
    /// Twists that close the joints at one stage.
    pub(super) bias: Vec<Twist>,
    /// Node by node, `tableau.stages` entries each.
    pub(super) stages: Vec<Stage>,
    /// Attitudes at the stages, node by node.
    pub(super) attitudes: Vec<Attitude>,
    /// Twists at the joint points after the last projection.
    pub(super) twist: Vec<Twist>,
    /// Step of the multipliers in `stages`, s; 0 where there are none.
    pub(super) last_step: f64,
    pub(super) length: f64,
}

impl Lobatto {
    /// Starts from the system's initial state with 2 to 5 stages; other numbers are taken to the nearest.
    ///
    /// # Errors
    /// See [`Unfit`].
    pub fn new(system: &System, stages: usize) -> Result<Lobatto, Unfit> {
        Lobatto::from_state(system, &system.initial, stages)
    }

    /// Starts from a state of the system.
    ///
    /// # Errors
    /// See [`Unfit`].
    pub fn from_state(system: &System, state: &State, stages: usize) -> Result<Lobatto, Unfit> {
        let nodes = nodes(system);
        for (i, node) in nodes.iter().enumerate().skip(1) {
            if system.bodies[i - 1].joint.damping > 0.0 {
                return Err(Unfit::Damped { joint: i - 1 });
            }
            let least = 0.5 * node.inertia.sum() - node.inertia.max();
            if !(least > 1e-9 * node.inertia.max()) {
                return Err(Unfit::Flat { body: i - 1, least });
            }
        }
        let n = nodes.len();
        let tableau = Tableau::new(stages);
        let rest = Stage {
            dx: Vector3::zeros(),
            frame: JointFrame::GROUND,
            wrench: Spatial::ZERO,
            load: Spatial::ZERO,
            virial: Matrix3::zeros(),
            closing: Spatial::ZERO,
        };
        let (bodies, pose) = bodies(system, state);
        let arms: f64 = nodes.iter().map(|node| node.mount.arm.norm().max(node.mount.parent_arm.norm())).sum();
        let mut lobatto = Lobatto {
            gravity: system.gravity,
            bodies,
            pose,
            frames: vec![JointFrame::GROUND; n],
            tree: Tree::new(&nodes),
            inner: vec![(vec![JointFrame::GROUND; n], Tree::new(&nodes)); tableau.stages - 2],
            gap0: vec![Spatial::ZERO; n],
            bias: vec![Spatial::ZERO; n],
            stages: vec![rest; n * tableau.stages],
            attitudes: nodes.iter().map(|node| Attitude::new(&node.inertia, tableau.stages)).collect(),
            twist: vec![Spatial::ZERO; n],
            last_step: 0.0,
            length: if arms > 0.0 { arms / (n - 1) as f64 } else { 1.0 },
            tableau,
            nodes,
        };
        lobatto.factorise().map_err(Unfit::Failure)?;
        lobatto.project_momenta();
        Ok(lobatto)
    }

    /// Writes the present state: poses, and the twists that fit the joints.
    pub fn write_state(&self, out: &mut State) {
        for (i, b) in out.bodies.iter_mut().enumerate() {
            *b = self.bodies[i + 1].state(&self.twist[i + 1], &self.frames[i + 1]);
        }
    }
}
