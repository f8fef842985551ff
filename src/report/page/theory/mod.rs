//! The sections of the theory, one file a topic, and their page.

mod energy;
mod long_time;
mod orders;
mod page;
mod section;
mod small_steps;
mod table;

pub(in crate::report) use page::{html, markdown, section};
