//! Comparisons of states.

use rattlebench::mechanics::{BodyState, State, System, constraint, energy};

/// Largest difference of positions (m) and attitudes (rad).
pub fn distance(a: &State, b: &State) -> f64 {
    let of = |(a, b): (&BodyState, &BodyState)| {
        // The sine of half the angle: its cosine cannot tell small angles from none.
        let turn = a.attitude.inverse() * b.attitude;
        (a.position - b.position).norm().max(2.0 * turn.imag().norm())
    };
    a.bodies.iter().zip(&b.bodies).map(of).fold(0.0, f64::max)
}

/// Change of the energy from the start, over the energy scale; with its sign.
pub fn energy_error(system: &System, state: &State) -> f64 {
    let start = energy::energy(system, &system.initial).total();
    (energy::energy(system, state).total() - start) / system.energy_scale
}

/// The state with all velocities turned round.
pub fn reversed(mut state: State) -> State {
    for body in &mut state.bodies {
        body.velocity.neg_mut();
        body.angular_velocity.neg_mut();
    }
    state
}

/// The largest residuals of joints and loops over the states of a run: m or rad, m/s or rad/s.
#[derive(Clone, Copy, Debug, Default)]
pub struct Open {
    pub position: f64,
    pub velocity: f64,
}

impl Open {
    /// Takes in a state, whose residuals are finite.
    pub fn see(&mut self, system: &System, state: &State) {
        let here = constraint::residual(system, state);
        assert!(here.position.is_finite() && here.velocity.is_finite(), "{here:?}");
        (self.position, self.velocity) = (self.position.max(here.position), self.velocity.max(here.velocity));
    }

    pub fn at_most(&self, position: f64, velocity: f64) -> bool {
        self.position <= position && self.velocity <= velocity
    }
}
