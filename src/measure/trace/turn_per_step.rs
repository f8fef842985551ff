//! How far bodies turn in a step, and the program's warning where that is too far for energy bounds.

use nalgebra::UnitQuaternion;

use crate::engines::Engine;
use crate::mechanics::{State, System};

/// A body that turns further than this in a step, rad, is beyond what the energy bounds of fixed-step methods are for:
/// they need `h omega` below about 1 for every frequency, and that of a body that turns is felt several times over.
pub(crate) const FAR_TURN: f64 = 0.3;

/// The largest turn of a body in a step so far: by its angular velocity, `h |Omega|`, and by the attitudes before and
/// after.
///
/// Every command that runs an engine warns by [`TurnPerStep::warning`]. Engines that choose steps of their own are not
/// warned of turns.
#[derive(Clone, Debug)]
pub(crate) struct TurnPerStep {
    /// Step of the run, s.
    step: f64,
    before: Vec<UnitQuaternion<f64>>,
    /// rad
    largest: f64,
    body: usize,
    fixed: bool,
}

impl TurnPerStep {
    /// Starts at the initial state.
    pub fn new(system: &System, engine: &dyn Engine, step: f64) -> TurnPerStep {
        let before = system.initial.bodies.iter().map(|body| body.attitude).collect();
        TurnPerStep { step, before, largest: 0.0, body: 0, fixed: !engine.chooses_its_steps() }
    }

    /// Takes in the state after the next step.
    pub fn add(&mut self, state: &State) {
        for (i, (body, before)) in state.bodies.iter().zip(&mut self.before).enumerate() {
            let turn = (self.step * body.angular_velocity.norm()).max(before.angle_to(&body.attitude));
            *before = body.attitude;
            if turn > self.largest {
                (self.largest, self.body) = (turn, i);
            }
        }
    }

    /// rad
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// Why the figures of the run may mislead although it went through: bodies that turn far in a step.
    pub fn warning(&self, system: &System) -> Option<String> {
        let far = self.fixed && self.largest > FAR_TURN;
        far.then(|| {
            let below = self.step * FAR_TURN / self.largest;
            format!(
                "body '{}' turns by {:.2} rad in a step; energy bounds are for less than about {FAR_TURN}: take a step \
                 below {below:.1e} s",
                system.bodies[self.body].name, self.largest
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::synthetic::{Scripted, flywheel};

    #[test]
    fn a_body_that_turns_far_in_a_step_is_named_with_the_step_that_would_do() {
        let system = flywheel(1.0, 0.0, 10.0);
        let warning = |speed: f64| {
            let mut engine = Scripted::new(move |_| speed);
            let mut turn = TurnPerStep::new(&system, &engine, 0.01);
            let mut state = system.initial.clone();
            engine.step().expect("scripted");
            engine.write_state(&mut state);
            turn.add(&state);
            assert_eq!(turn.largest(), 0.01 * speed);
            turn.warning(&system)
        };
        assert_eq!(warning(29.0), None);
        let words = "body 'wheel' turns by 0.60 rad in a step; energy bounds are for less than about 0.3: take a step \
                     below 5.0e-3 s";
        assert_eq!(warning(60.0).as_deref(), Some(words));
    }
}
