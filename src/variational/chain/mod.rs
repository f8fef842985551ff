//! The chain: bodies with the joints that they hang on, where they are, and how they move over a step.

mod component;
mod frame;
mod motion;
mod node;
mod pose;

pub(super) use component::{coordinates_of, keep_locked, wrench_of_coordinates};
pub(super) use frame::{JointFrame, mismatch};
pub(super) use motion::{Motion, RelativeMotion};
pub(super) use node::{Mount, Node, nodes};
pub(super) use pose::Pose;
