//! The reversibility defect of a map of states.

use super::failure::{Failure, StateMap};
use super::phase::{Phase, scale_at, turned};
use crate::mechanics::{State, System};

/// The largest entry of `R Phi R Phi z - z` at a state.
///
/// # Errors
/// Those of the map.
pub fn reversibility(system: &System, state: &State, lag: f64, map: &StateMap) -> Result<f64, Failure> {
    let scale = scale_at(system, state)?;
    let here = Phase::about(system, state, &scale, lag)?;
    let start = here.point(state)?;
    let end = map(&here.system(&start)?)?;
    let there = Phase::about(system, &end, &scale, lag)?;
    let back = map(&there.system(&turned(&there.point(&end)?))?)?;
    Ok((turned(&here.point(&back)?) - start).amax())
}
