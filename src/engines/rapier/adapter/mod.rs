//! A rapier world that holds a system; compiled once for each precision, over the types of `super::rapier`.

mod build;
mod convert;
mod drive;
mod seat;
mod world;

pub(in super::super) use world::World;
