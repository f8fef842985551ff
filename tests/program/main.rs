//! The program from outside: its command line, its messages, and input that is bad or random.

mod bad_input;
mod check;
mod cli;
#[path = "../common/mod.rs"]
mod common;
mod fuzz;
mod theory;
