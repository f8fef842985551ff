//! Records with a schema version, charts and the page.
