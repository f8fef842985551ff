//! What is written as JSON, and read back to be drawn again.

pub mod cost;
pub mod environment;
pub mod expectation;
pub mod metrics;
pub mod parity;
pub mod reference;
pub mod report;
pub mod run;
pub mod scene;
pub mod series;
pub mod solver;
pub mod stability;
pub mod structure;
pub mod sweep;
pub mod theory;
pub mod time;
