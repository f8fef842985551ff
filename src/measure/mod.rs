//! Figures taken from the states that engines return, by one implementation for all of them.
//!
//! | module | holds |
//! | --- | --- |
//! | [`horizon`], [`outcome`], [`run`] | how many steps of which size, how they end, and all that was measured in them |
//! | [`trace`] | one run, stepped once: energy, joint residuals and momentum after every step |
//! | [`truth`] | the trajectory that positions are judged by, and their errors |
//! | [`cost`] | processor time of the stepping alone, the sweep of settings, what an accuracy costs each engine |
//! | [`growth`], [`convergence`] | how an error grows with time and falls with the step |
//! | [`structure`] | what a few steps preserve of the structure of the motion |
//! | [`parity`] | whether engines were given one mechanical system |
//! | [`comparison`], [`study`] | several engines and steps, and that with truth, parity and sweep |
//! | [`stability`] | cells of scenes along a parameter against the step |
//! | `theory` | figures and tables of the sources of the theory |
//! | `threads`, `scales` | the one queue of work, and lengths that errors are divided by |

mod batch;
pub mod comparison;
pub mod convergence;
pub mod cost;
pub mod growth;
pub mod horizon;
pub mod outcome;
pub mod parity;
pub mod run;
pub(crate) mod scales;
pub mod stability;
pub mod structure;
pub mod study;
pub(crate) mod theory;
pub(crate) mod threads;
pub mod trace;
pub mod truth;

#[cfg(test)]
pub(crate) mod synthetic;

pub use horizon::{Horizon, HorizonError};
pub use outcome::{Limits, Outcome};
pub use run::Run;
pub use trace::Trace;
