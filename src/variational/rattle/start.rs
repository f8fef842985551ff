//! How an integrator is made.

use nalgebra::SVector;

use super::failure::Failure;
use super::light;
use super::state::{Chain, Memory, Present, Rattle, Settings, Trial, bodies};
use super::switching::rules;
use crate::mechanics::{State, System};
use crate::numeric::Compensated;
use crate::variational::chain::{JointFrame, nodes};
use crate::variational::closing::counters::Counters;
use crate::variational::force::Parts;
use crate::variational::method::Method;
use crate::variational::predictor::{self, Predictor};
use crate::variational::rotation::Rotation;
use crate::variational::tree::Tree;
use crate::variational::tree::spatial::Spatial;

impl Rattle {
    /// Starts from the system's initial state. The momenta are projected onto (5).
    ///
    /// # Errors
    /// [`Failure::Singular`] where a joint can move without moving any mass.
    pub fn new(system: &System) -> Result<Rattle, Failure> {
        Rattle::from_state(system, &system.initial)
    }

    /// Starts from a state of the system.
    ///
    /// # Errors
    /// [`Failure::Singular`] where a joint can move without moving any mass.
    pub fn from_state(system: &System, state: &State) -> Result<Rattle, Failure> {
        let mut nodes = nodes(system);
        let n = nodes.len();
        let (bodies, pose) = bodies(system, state);
        let arms: f64 = nodes.iter().map(|node| node.mount.arm.norm().max(node.mount.parent_arm.norm())).sum();
        let length = if arms > 0.0 { arms / (n - 1) as f64 } else { 1.0 };
        let rows = &system.parts;
        let rows = !(rows.loops.is_empty() && rows.couplings.is_empty() && rows.point_springs.is_empty());
        light::mark(&mut nodes, length, !rows);
        let tree = Tree::new(&nodes);
        let parts = Parts::new(system, state, &mut nodes, &tree);
        let sprung = parts.as_ref().is_some_and(|parts| parts.implicit.is_some());
        let mut rattle = Rattle {
            now: Present {
                time: Compensated::new(SVector::zeros()),
                bodies,
                pose,
                frames: vec![JointFrame::GROUND; n],
                tree,
                gap0: vec![Spatial::ZERO; n],
                twist: vec![Spatial::ZERO; n],
            },
            trial: Trial::new(&nodes),
            memory: Memory {
                predictor: Predictor::new(n, if sprung { predictor::SPRUNG } else { predictor::FULL }),
                contraction: f64::INFINITY,
                counters: Counters::default(),
                rules: rules(&nodes, Rotation::MoserVeselov),
                switched: Vec::with_capacity(n),
            },
            settings: Settings { method: Method::Rattle, automatic: false, tolerance: 0.0, unbiased: false },
            chain: Chain { nodes, gravity: system.gravity, length },
            parts,
        };
        rattle.place_joints();
        rattle.factorise(0.0)?;
        rattle.start_parts();
        rattle.project_momenta(0.0);
        Ok(rattle)
    }

    /// Steps by another map than [`Method::Rattle`].
    pub fn with_method(mut self, method: Method) -> Rattle {
        if method != Method::Rattle {
            // Their dampers are those of (1) in `forces` alone.
            self.parts.iter_mut().flat_map(|parts| &mut parts.forces).for_each(|force| force.start(f64::INFINITY));
        }
        self.settings.method = method;
        self
    }

    /// Lets the constraint iteration stop at a residual (m; angles times the mean length of a link) instead of at
    /// roundoff. That costs the long-time behaviour: the energy drifts by what the residuals leave out, always to the
    /// same side.
    pub fn with_tolerance(mut self, tolerance: f64) -> Rattle {
        self.settings.tolerance = tolerance;
        self
    }

    /// Goes on with the constraint iteration far below roundoff. What the last correction leaves has the same sign for
    /// many steps; where the method errs less than roundoff does, as at high order, that is what the energy drifts by.
    /// It takes two thirds as many rounds more.
    pub fn with_unbiased_roundoff(mut self) -> Rattle {
        self.settings.unbiased = true;
        self
    }
}
