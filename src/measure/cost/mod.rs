//! What a step and an accuracy cost: processor time, the sweep of settings, and ranks among engines.

pub mod clock;
pub mod expectation;
pub mod front;
pub mod ranking;
pub mod scaling;
pub mod sweep;
