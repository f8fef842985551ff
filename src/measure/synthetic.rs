//! What tests are made of: a flywheel whose angular velocity follows a script, an engine whose errors are known, and
//! runs of known cost and error.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::Horizon;
use super::cost::clock::Timing;
use super::outcome::Outcome;
use super::run::Run;
use super::trace::Trace;
use super::truth::accuracy::{Accuracy, Spread};
use crate::engines::{Engine, Spec, StepFailure};
use crate::mechanics::coordinates::{JointCoordinates, forward_kinematics};
use crate::mechanics::{Body, Joint, JointKind, Mobility, Parts, State, System, energy};

/// A flywheel of the given moment of inertia (kg m^2), damping (N m s/rad) and speed (rad/s) about the world's z axis.
pub(crate) fn flywheel(inertia: f64, damping: f64, speed: f64) -> System {
    let joint = Joint {
        name: "axle".into(),
        kind: JointKind::Revolute,
        parent: None,
        in_parent: Isometry3::identity(),
        in_child: Isometry3::identity(),
        damping,
    };
    let bodies = vec![Body { name: "wheel".into(), mass: 1.0, inertia: Vector3::repeat(inertia), joint }];
    let mut coordinates = JointCoordinates::default();
    coordinates.velocity[0] = speed;
    let gravity = Vector3::zeros();
    let initial = forward_kinematics(&bodies, &[coordinates]);
    let mut system = System {
        name: "flywheel".into(),
        energy_scale: 1.0,
        bodies,
        gravity,
        initial,
        initial_coordinates: vec![coordinates],
        floating_base: None,
        parts: Parts::default(),
        mobility: Mobility::default(),
    };
    system.energy_scale = energy::scale(&system);
    system
}

/// Turns the flywheel with the angular velocity `speed(n)` after `n` steps, and fails at step `fails_at`.
pub(crate) struct Scripted<F> {
    pub speed: F,
    pub taken: u64,
    pub fails_at: Option<(u64, StepFailure)>,
}

impl<F: Fn(u64) -> f64> Scripted<F> {
    pub(super) fn new(speed: F) -> Scripted<F> {
        Scripted { speed, taken: 0, fails_at: None }
    }
}

impl<F: Fn(u64) -> f64> Engine for Scripted<F> {
    fn step(&mut self) -> Result<(), StepFailure> {
        if let Some((at, failure)) = &self.fails_at
            && *at == self.taken + 1
        {
            return Err(failure.clone());
        }
        self.taken += 1;
        Ok(())
    }

    fn write_state(&self, out: &mut State) {
        out.bodies[0].position = Vector3::zeros();
        out.bodies[0].velocity = Vector3::zeros();
        out.bodies[0].attitude = UnitQuaternion::identity();
        out.bodies[0].angular_velocity = Vector3::new(0.0, 0.0, (self.speed)(self.taken));
    }
}

/// A completed run of one step of 0.1 s with a cost (processor seconds a simulated second) and a joint position error.
pub(crate) fn timed_run(engine: &str, cost: f64, error: f64) -> Run {
    let spread = Spread { max: error, at: 1.0, rms: error };
    let accuracy = Accuracy { joint: spread, position: spread, attitude: spread, samples: 1, until: 1.0 };
    let (step, low) = (0.1, 0.1 * cost);
    Run {
        engine: Spec::parse(engine).expect("a spec"),
        horizon: Horizon { step, steps: 10, end: 1.0 },
        trace: Trace { outcome: Outcome::Completed, accuracy: Some(accuracy), ..Trace::unsupported(String::new()) },
        structure: None,
        timing: Some(Timing { median: low, low, min: low, max: low, rounds: 5, steps: 1, passes: 1 }),
    }
}
