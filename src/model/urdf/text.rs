//! Files as text.

use std::path::Path;

use super::error::Problem;

/// A whole text file.
pub(in crate::model) fn read_text(path: &Path) -> Result<String, Problem> {
    std::fs::read_to_string(path).map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => Problem::Missing,
        std::io::ErrorKind::InvalidData => Problem::NotText,
        _ => Problem::Unreadable(e),
    })
}
