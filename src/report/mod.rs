//! Records with a schema version, charts and the page.
//!
//! A [`Report`] is what a comparison leaves behind, as JSON. Charts, page and table are drawn from it alone,
//! so that they can be drawn again without simulating. [`files::write`] writes the whole folder.

pub mod charts;
pub(crate) mod folder;
pub mod page;
pub mod record;
pub mod words;

pub use record::report::Report;
