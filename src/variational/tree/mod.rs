//! Linear solves on the tree of joints in O(n): the articulated-body recursion (Featherstone 1983), in world axes.
//!
//! All solves of a step have the form: find body twists `v` and joint wrenches (the multipliers) with
//!
//! ```text
//! M v = b + G^T lambda ,      G v = c .
//! ```
//!
//! Here a joint's wrench `f` acts on the child and `-f` on the parent at the joint point, `S . f = 0` for the joint's
//! motion subspace `S`, and the joint lets the child's twist differ from the parent's by `S sigma + gamma`, where
//! `gamma` is the joint's part of `c`. A sweep from the leaves to the root eliminates the free directions,
//!
//! ```text
//! U = A S ,   D = S^T U ,   A_parent += A - U D^-1 U^T ,
//! ```
//!
//! and one from the root to the leaves finds the twists. Only `D` is inverted: a number for a hinge.

mod elimination;
mod factor;
pub(super) mod newton;
pub(super) mod orthogonal;
mod response;
pub(super) mod row;
pub(super) mod schur;
mod solve;
pub(super) mod spatial;

pub(super) use elimination::Singular;
pub(super) use factor::Tree;
