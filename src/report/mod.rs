//! Records with a schema version, charts and the page.
//!
//! A [`Report`] is what a comparison leaves behind, as JSON. Charts, page and table are drawn from it alone,
//! so that they can be drawn again without simulating.
//!
//! | module | holds |
//! | --- | --- |
//! | [`record`] | what is written as JSON and read back |
//! | [`words`] | what is said of it, for the terminal and the pages |
//! | [`charts`] | how it looks |
//! | [`page`] | pages of words, tables and charts |
//! | `folder` | which files they make, written whole or not at all |

pub mod charts;
pub(crate) mod folder;
pub mod page;
pub mod record;
pub mod words;

pub use record::report::Report;
