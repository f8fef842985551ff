//! What a URDF and a scene file say, as plain validated data in SI units. Nothing here knows dynamics.

pub mod assemble;
pub mod generate;
mod joint;
mod link;
mod names;
mod robot;
pub mod scene;
mod urdf;

pub use joint::{Joint, JointKind, Mimic};
pub use link::{Collision, Inertial, Link, Shape};
pub use robot::{Ignored, Model};
pub(crate) use scene::read_bounds;
pub use scene::{Base, Bound, Limit, Scene, SceneError, SceneProblem};
pub use urdf::{ModelError, Position, Problem, read_urdf};
