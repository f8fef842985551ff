//! From the text of a URDF file to a [`Model`](super::Model).

mod document;
mod error;
mod inertia;
mod order;
mod pose;
mod read;
mod shapes;
mod text;
mod walk;

pub use error::{ModelError, Position, Problem};
pub(super) use order::WORLD;
pub(super) use pose::{direction, pose_of};
pub use read::read_urdf;
pub(super) use read::read_urdf_with_density;
pub(super) use text::read_text;
