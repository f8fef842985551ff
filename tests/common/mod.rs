//! What several tests share: models built in code and shipped, runs, comparisons of
//! states, and (`discrete`) the problems of the theory.

#![allow(dead_code, unused_imports, reason = "each test program and bench uses a part")]

pub mod discrete;
mod fit;
mod models;
mod program;
mod runs;
mod states;

pub use fit::*;
pub use models::*;
pub use program::*;
pub use runs::*;
pub use states::*;
