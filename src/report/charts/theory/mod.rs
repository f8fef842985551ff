//! The charts of `rattlebench theory`, one file each, drawn from the records of `crate::report::theory`.

pub mod convergence;
pub mod energy_of_particle;
pub mod long_time;
pub mod order_table;
pub mod small_steps;
