//! Systems and their parts: what a scene compiles to, shipped scenes, joints with forces, springs, loops.

#[path = "../common/mod.rs"]
mod common;
mod joint_forces;
mod linkage_symplecticity;
mod loops;
mod mechanics;
mod point_springs;
mod shipped;
