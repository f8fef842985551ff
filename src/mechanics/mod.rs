//! The compiled system: rigid bodies in a tree of joints, and what can be computed from a state of it.
//!
//! A [`System`] is what every engine is built from. Links that fixed joints hold together are one body; a body's frame
//! has its origin in the centre of mass and its axes along the principal axes of inertia. Each body hangs on exactly
//! one [`Joint`]: a body that nothing holds hangs on the ground by a floating joint.

mod body;
mod closure;
mod compile;
pub mod constraint;
pub mod coordinates;
pub mod energy;
mod joint;
mod joint_kind;
mod mobility;
pub mod momentum;
mod parts;
pub(crate) mod path;
mod rank;
mod relative;
mod state;
mod system;

pub use body::Body;
pub use closure::Closure;
pub use compile::CompileError;
pub use joint::Joint;
pub(crate) use joint_kind::Coordinate;
pub use joint_kind::JointKind;
pub use mobility::Mobility;
pub use parts::{Anchor, Coupling, Drive, JointSpring, Part, Parts, PointSpring};
pub(crate) use rank::RANK;
pub use state::{BodyState, State};
pub use system::{FloatingBase, System};
