//! Figures taken from the states that engines return, by one implementation for all of them.
//!
//! A [`Horizon`] says how many steps of which size a run takes. [`trace`](trace::trace) steps an engine over it once and
//! computes energy, joint residuals and momentum after every step; [`clock`] measures the processor time of the stepping
//! alone; [`comparison`] does both for several engines and step sizes. [`growth`] judges how an error grows;
//! [`structure`] what a few steps preserve of the structure of the motion.

pub mod clock;
pub mod comparison;
pub mod growth;
pub mod horizon;
mod quadrature;
pub mod series;
pub mod stability;
pub mod structure;
pub mod trace;
mod work;

#[cfg(test)]
mod synthetic;

pub use horizon::{Horizon, HorizonError};
pub use trace::{Outcome, Trace};
