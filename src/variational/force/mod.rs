//! What acts beside gravity: springs, dampers and drives in joints, and what holds between bodies across the tree.
//!
//! A force along the coordinate of a joint belongs into [`joint`], one between bodies is a kind of [`bond`].

pub(super) mod bond;
pub(super) mod joint;
mod leap;
pub(super) mod loops;
pub(super) mod parts;
pub(super) mod solve;
pub(super) mod step_energy;

pub(super) use parts::Parts;
