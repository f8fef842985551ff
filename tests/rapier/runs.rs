//! Running an engine from a spec.

use rattlebench::engines::{self, Engine, Spec};
use rattlebench::mechanics::{State, System};

pub fn spec(text: &str) -> Spec {
    Spec::parse(text).expect("a valid spec")
}

pub fn engine(text: &str, system: &System, step: f64) -> Box<dyn Engine> {
    engines::build(&spec(text), system, step).expect("the engine takes the system")
}

/// The state that an engine reaches in so many steps.
pub fn after(text: &str, system: &System, step: f64, steps: u32) -> State {
    let mut engine = engine(text, system, step);
    for _ in 0..steps {
        engine.step().expect("a step can be taken");
    }
    let mut state = system.initial.clone();
    engine.write_state(&mut state);
    state
}

/// The largest difference of a position, an attitude (angle) or a velocity, this relative to the speed if it exceeds 1.
pub fn difference(one: &State, other: &State) -> f64 {
    let pairs = one.bodies.iter().zip(&other.bodies);
    let differences = pairs.flat_map(|(a, b)| {
        [
            (a.position - b.position).norm(),
            a.attitude.angle_to(&b.attitude),
            (a.velocity - b.velocity).norm() / a.velocity.norm().max(1.0),
            (a.angular_velocity - b.angular_velocity).norm() / a.angular_velocity.norm().max(1.0),
        ]
    });
    differences.fold(0.0, f64::max)
}
