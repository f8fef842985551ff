//! A step that fails, taken in halves.
//!
//! Halves are halved again until they converge, down to [`MOST_HALVINGS`] times. The result is a solution of the same accuracy or
//! better, but a step whose size depends on whether it converged is no symplectic and no time-reversible map: the long-time
//! behaviour is given up wherever it happens.

use crate::variational::rattle::Failure;

/// How often a step is halved at most: down to 1/1024 of it.
pub const MOST_HALVINGS: u32 = 10;

/// Takes a step of size `h` by `step`, in halves where it fails. A `step` that fails must leave its state unchanged. Returns how
/// often the step was halved where it was halved most, 0 if it did not fail.
///
/// # Errors
/// The failure of the shortest step that was tried. What was taken before it stays taken.
pub fn step_in_halves(h: f64, step: &mut impl FnMut(f64) -> Result<(), Failure>) -> Result<u32, Failure> {
    halve(h, 0, step)
}

fn halve(h: f64, halvings: u32, step: &mut impl FnMut(f64) -> Result<(), Failure>) -> Result<u32, Failure> {
    match step(h) {
        Ok(()) => Ok(halvings),
        // A step that ends in a singular configuration has been taken when that is found.
        Err(failure) if halvings == MOST_HALVINGS || matches!(failure, Failure::Singular { .. }) => Err(failure),
        Err(_) => {
            let first = halve(0.5 * h, halvings + 1, step)?;
            Ok(first.max(halve(0.5 * h, halvings + 1, step)?))
        }
    }
}

/// The longest step `h / 2^k` by which a state advances over `h` without a failure, found by trying on copies of it; `None`
/// where `k` up to [`MOST_HALVINGS`] does not help.
pub fn step_that_works<S: Clone>(
    state: &S,
    h: f64,
    mut step: impl FnMut(&mut S, f64) -> Result<(), Failure>,
) -> Option<f64> {
    (1..=MOST_HALVINGS).find_map(|k| {
        let (parts, mut copy) = (1_u32 << k, state.clone());
        let part = h / f64::from(parts);
        (0..parts).all(|_| step(&mut copy, part).is_ok()).then_some(part)
    })
}
