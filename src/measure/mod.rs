//! Figures taken from the states that engines return, by one implementation for all of them.
//!
//! A [`Horizon`] says how many steps of which size a run takes. [`trace`](trace::trace) steps an engine over it once
//! and computes energy, joint residuals and momentum after every step; [`clock`] measures the processor time of the
//! stepping alone; [`comparison`] does both for several engines and step sizes. [`growth`] judges how an error grows;
//! [`structure`] what a few steps preserve of the structure of the motion. [`truth`] is the trajectory that
//! [`accuracy`] is judged by, [`ranking`] what an accuracy costs each engine, and [`study`] a comparison with all that
//! belongs to it.

mod batch;
pub mod comparison;
pub mod convergence;
pub mod cost;
pub mod growth;
pub mod horizon;
pub mod outcome;
pub mod parity;
pub mod run;
pub mod scales;
pub mod stability;
pub mod structure;
pub mod study;
pub mod theory;
pub mod threads;
pub mod trace;
pub mod truth;

#[cfg(test)]
pub(crate) mod synthetic;

pub use horizon::{Horizon, HorizonError};
pub use outcome::{Limits, Outcome};
pub use run::Run;
pub use trace::Trace;
