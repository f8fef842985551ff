//! The adapter compiled for single precision.

use rapier3d as rapier;

use rapier::math::Real;

/// For messages.
const PRECISION: &str = "single precision";

fn narrow(x: f64) -> Real {
    x as Real
}

fn widen(x: Real) -> f64 {
    f64::from(x)
}

#[path = "adapter/mod.rs"]
#[allow(clippy::duplicate_mod, reason = "one source for both precisions, whose types have the same names")]
mod adapter;

pub(super) use adapter::World;
