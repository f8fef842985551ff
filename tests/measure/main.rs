//! Measuring, judging and reporting.

mod accuracy;
mod check;
#[path = "../common/mod.rs"]
mod common;
mod growth;
mod report;
mod stability;
mod structure;
