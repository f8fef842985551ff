//! Records with a schema version, charts and the page.
//!
//! A [`Report`] is what a comparison leaves behind, as JSON. Charts, page and table are drawn from it alone,
//! so that they can be drawn again without simulating. [`files::write`] writes the whole folder.

pub mod charts;
pub mod cost;
pub mod environment;
pub mod evidence;
pub mod expectation;
pub mod files;
pub mod finding;
pub mod front;
pub mod metrics;
pub mod number;
pub mod page;
pub mod record;
pub mod stability;
mod structure;
pub mod summary;
pub mod table;
pub mod theory;

pub use record::Report;
