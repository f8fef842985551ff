//! Runs of engines by their names.

use rattlebench::engines::{self, Engine, Spec};
use rattlebench::mechanics::{State, System};

pub fn engine(text: &str, system: &System, step: f64) -> Box<dyn Engine> {
    let spec = Spec::parse(text).unwrap_or_else(|e| panic!("{e}"));
    engines::build(&spec, system, step).unwrap_or_else(|e| panic!("{e}"))
}

/// The state after so many steps.
pub fn run_engine(text: &str, system: &System, step: f64, steps: usize) -> State {
    let mut engine = engine(text, system, step);
    for _ in 0..steps {
        engine.step().unwrap_or_else(|e| panic!("{text} on {}: {e}", system.name));
    }
    let mut state = system.initial.clone();
    engine.write_state(&mut state);
    state
}
