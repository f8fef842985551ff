//! What an engine holds of a system in data of its own.

use nalgebra::{UnitQuaternion, Vector3};

use crate::mechanics::{Body, State, System, energy};

/// What an engine holds of a system, in double precision and our terms.
#[derive(Clone, Debug)]
pub struct Held {
    /// m/s^2, world axes
    pub gravity: Vector3<f64>,
    /// In the order of [`System::bodies`].
    pub bodies: Vec<HeldBody>,
    pub state: State,
    /// Whether the engine keeps all this in single precision.
    pub single: bool,
}

/// Mass properties of one of the engine's bodies.
#[derive(Clone, Debug)]
pub struct HeldBody {
    /// kg; what the solver uses for each world axis.
    pub mass: Vector3<f64>,
    /// Principal moments about the centre of mass, kg m^2.
    pub inertia: Vector3<f64>,
    /// Principal axes to body axes.
    pub axes: UnitQuaternion<f64>,
    /// Centre of mass in the body's frame, m.
    pub com: Vector3<f64>,
}

impl Held {
    /// Our system with the engine's masses, moments, gravity and state in the place of ours, so that energy and
    /// momentum of what it holds come from the functions that measure every engine. Joints are ours.
    pub fn as_system(&self, system: &System) -> System {
        let bodies = system.bodies.iter().zip(&self.bodies).map(|(ours, held)| Body {
            mass: held.mass.x,
            inertia: held.inertia,
            ..ours.clone()
        });
        let mut held =
            System { bodies: bodies.collect(), gravity: self.gravity, initial: self.state.clone(), ..system.clone() };
        held.energy_scale = energy::scale(&held);
        held
    }
}
