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

pub use bounds::{Bound, BoundFile, BoundsFile, Limit, read_bounds};
pub use data::{Base, JointInitial, Scene};
pub(super) use error::not_negative;
pub use error::{SceneError, SceneProblem, positive};
pub use file::SceneFile;
pub use parts::{Anchor, Drive, FixedFrame, Loop, LoopKind, Spring};
