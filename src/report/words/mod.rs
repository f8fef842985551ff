//! Figures and findings in words, for the terminal and the page.

pub mod borders;
pub mod cost;
pub mod expectation;
pub mod finding;
pub mod number;
pub mod summary;
pub mod table;
