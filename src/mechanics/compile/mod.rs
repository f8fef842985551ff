//! From a scene to a system: welding, principal frames, joint frames, parts, consistent initial values.

mod assemble;
mod closing;
mod error;
mod joints;
mod parts;
mod principal;
mod scene;

pub use error::CompileError;
