//! The adapter compiled for double precision.

use rapier3d_f64 as rapier;

use rapier::math::Real;

/// For messages.
const PRECISION: &str = "double precision";

fn narrow(x: f64) -> Real {
    x
}

fn widen(x: Real) -> f64 {
    x
}

#[path = "adapter/mod.rs"]
#[allow(clippy::duplicate_mod, reason = "one source for both precisions, whose types have the same names")]
mod adapter;

pub(super) use adapter::World;
