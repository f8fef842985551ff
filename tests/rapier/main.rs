//! Rapier is given the same system as the variational core, and behaves as the documentation of the adapter says.

#[path = "../common/mod.rs"]
mod common;
mod forward_dynamics;
mod parity;
mod pitfalls;
mod runs;
mod scenes;
