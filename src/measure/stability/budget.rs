//! What a run costs, in nominal microseconds: a formula of each engine in bodies and steps, never a clock, so that a
//! suite finds the same cells over budget everywhere.

use crate::engines::Spec;
use crate::mechanics::System;

/// A run that would cost more than this is not begun, nominal s.
pub(crate) const ALLOWANCE: f64 = 100.0;

/// Nominal time of a step of the reference, s: twelve mass matrices with their factors, and what the loops add.
pub(crate) fn reference_step_seconds(system: &System) -> f64 {
    let freedoms: usize = system.bodies.iter().map(|body| body.joint.kind.degrees_of_freedom()).sum();
    let (n, rows) = (freedoms as f64, 6.0 * system.parts.loops.len() as f64);
    12e-6 * (0.5 * n + 0.05 * n * n + 2e-4 * n.powi(3) + 0.05 * rows * n + 2e-3 * rows.powi(3))
}

/// Nominal time of a run, s.
pub(crate) fn seconds(engine: &Spec, bodies: usize, steps: u64) -> f64 {
    1e-6 * engine.nominal_cost(bodies) * steps as f64
}

/// Whether a run may be begun; else says why not.
pub fn check(engine: &Spec, bodies: usize, steps: u64) -> Result<(), String> {
    let cost = seconds(engine, bodies, steps);
    if cost <= ALLOWANCE {
        return Ok(());
    }
    Err(format!(
        "{steps} steps of {bodies} bodies would cost about {cost:.0} s; the allowance of a run is {ALLOWANCE} s"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cube_of_reduced_coordinates_is_over_budget_and_says_so() {
        let spec = |text| Spec::parse(text).expect("a spec");
        assert_eq!(check(&spec("rattle"), 2000, 10_000), Ok(()));
        let refused = check(&spec("rapier:joints=multibody,precision=f64"), 200, 1000);
        let message = "1000 steps of 200 bodies would cost about 481 s; the allowance of a run is 100 s";
        assert_eq!(refused, Err(message.to_string()));
    }
}
