//! A system as rapier holds and steps it.

use super::super::rapier::math::Real;
use super::super::rapier::prelude::PhysicsWorld;
use super::super::{PRECISION, widen};
use super::build::build;
use super::convert::{attitude_of, body_state, vector_of};
use super::drive::{DrivenJoint, apply, driven_joints};
use super::seat::{Motion, Seat};
use crate::engines::engine::{Engine, StepFailure, Unsupported};
use crate::engines::held::{Held, HeldBody};
use crate::engines::rapier::settings::Settings;
use crate::mechanics::{State, System};

/// A system as rapier holds it.
pub(in super::super::super) struct World {
    physics: PhysicsWorld,
    /// In the order of the system's bodies.
    bodies: Vec<Seat>,
    driven: Vec<DrivenJoint>,
    /// The last state that was finite.
    present: Vec<Motion>,
    /// Where the next state is read into; swapped with `present` where it is finite.
    next: Vec<Motion>,
    /// s
    step_size: f64,
    substeps: usize,
    steps: u64,
    failure: Option<StepFailure>,
}

impl World {
    /// Builds the world at the system's initial state.
    ///
    /// # Errors
    /// A number of the system that the precision cannot hold, or that rapier would take for something else.
    pub(in super::super::super) fn new(system: &System, settings: &Settings, step: f64) -> Result<World, Unsupported> {
        let (physics, bodies) = build(system, settings, step)?;
        let present: Vec<Motion> = bodies.iter().map(|seat| seat.motion(&physics)).collect();
        if let Some((seat, _)) = bodies.iter().zip(&present).find(|(_, motion)| !motion.is_finite()) {
            let what = format!("the initial motion of body '{}': it is out of the range of {PRECISION}", seat.name);
            return Err(Unsupported { engine: settings.spec.clone(), what });
        }
        let next = present.clone();
        let (substeps, step_size) = (settings.substeps, step);
        let driven = driven_joints(system, &bodies);
        Ok(World { physics, bodies, driven, present, next, step_size, substeps, steps: 0, failure: None })
    }

    /// What rapier's own bodies say.
    pub(in super::super::super) fn held(&self) -> Held {
        let state = State { bodies: self.present.iter().map(body_state).collect() };
        let bodies = self.bodies.iter().map(|seat| {
            let properties = self.physics.bodies[seat.body].mass_properties();
            let local = &properties.local_mprops;
            HeldBody {
                mass: vector_of(properties.effective_mass()),
                inertia: vector_of(local.principal_inertia()),
                axes: attitude_of(local.principal_inertia_local_frame),
                com: vector_of(local.local_com),
            }
        });
        let single = size_of::<Real>() < size_of::<f64>();
        Held { gravity: vector_of(self.physics.gravity), bodies: bodies.collect(), state, single }
    }

    /// The first body, in our order, that rapier took out or whose state is not finite.
    fn first_lost(&self) -> Option<&Seat> {
        let taken = self.physics.quarantine().bodies();
        let mut all = self.bodies.iter().zip(&self.next);
        all.find(|(seat, motion)| taken.contains(&seat.body) || !motion.is_finite()).map(|(seat, _)| seat)
    }
}

impl Engine for World {
    fn step(&mut self) -> Result<(), StepFailure> {
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        let middle = (self.steps as f64 + 0.5) * self.step_size;
        apply(&self.driven, middle, &mut self.physics);
        self.physics.step();
        for (seat, motion) in self.bodies.iter().zip(&mut self.next) {
            *motion = seat.motion(&self.physics);
        }
        if let Some(seat) = self.first_lost() {
            let time = self.steps as f64 * self.step_size;
            let detail = format!(
                "the motion of body '{}' is no longer finite in the step after t = {time} s; a smaller step may help",
                seat.name
            );
            let failure = StepFailure::Diverged { detail };
            self.failure = Some(failure.clone());
            return Err(failure);
        }
        std::mem::swap(&mut self.present, &mut self.next);
        self.steps += 1;
        Ok(())
    }

    fn write_state(&self, out: &mut State) {
        for (motion, body) in self.present.iter().zip(&mut out.bodies) {
            *body = body_state(motion);
        }
    }

    /// Half a substep: `v1 = v0 + h a(x0)`, `x1 = x0 + h v1`.
    fn position_lag_s(&self) -> f64 {
        0.5 * widen(self.physics.integration_parameters.dt) / self.substeps as f64
    }
}
