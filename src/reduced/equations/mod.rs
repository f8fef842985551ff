//! The equations of motion, each formulation by itself.

mod articulated;
pub(super) mod hamiltonian;
mod loops;
mod recursive;

pub use articulated::Articulated;
pub use recursive::Dynamics;
