//! The variational core: order, structure, conservation, failure, cost, and the same maps in another formulation.

mod adaptive;
mod allocation;
mod brouwer;
#[path = "../common/mod.rs"]
mod common;
mod composition_sets;
mod energy_momentum;
mod failed_steps;
mod independent;
mod light_links;
mod methods;
mod rotation;
mod symplecticity;
mod trees;
mod work_per_accuracy;
