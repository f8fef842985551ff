//! Scenes: a model with gravity, an initial state, loops, forces, a duration and bounds.

mod bounds;
mod data;
mod error;
mod file;
mod index;
mod json;
mod load;
mod needs;
mod parts;
mod resolve;

pub(crate) use bounds::read_bounds;
pub use bounds::{Bound, BoundFile, BoundsFile, Limit};
pub use data::{Base, JointInitial, Scene};
pub(super) use error::not_negative;
pub use error::{SceneError, SceneProblem, positive};
pub(crate) use file::SceneFile;
pub use parts::{Anchor, Drive, FixedFrame, Loop, LoopKind, Spring};
