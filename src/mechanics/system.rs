//! Compiles a scene into a system.
