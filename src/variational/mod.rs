//! The variational integrators for rigid bodies with joints.
//!
//! [`rattle::Rattle`] is the discrete Hamiltonian map of Marsden and West (2001), section 3.5.4, on the constraint
//! manifold of the joints. Its linear algebra is the articulated-body recursion over the tree of joints; a
//! body turns by a rule of [`rotation`]; [`composition`] raises the order, [`adaptive`] varies the step, [`energy_momentum`] solves
//! for it, [`substep`] takes a step that fails in halves. Loops, couplings and springs between points are rows across the tree, whose Schur complement is
//! factorised with its rank revealed; springs, dampers and drives of the joints enter the recursion itself.

pub mod adaptive;
mod attitude;
mod bonds;
mod compensated;
#[allow(clippy::excessive_precision, reason = "weights with all the digits that were published")]
pub mod composition;
pub mod energy_momentum;
#[doc(hidden)]
pub mod fault;
mod forces;
mod free_body;
mod joints;
pub mod lobatto;
mod loops;
pub mod method;
mod newton;
mod orthogonal;
mod predictor;
pub mod rattle;
pub mod rotation;
mod rows;
mod spatial;
pub mod substep;
mod tableau;
mod tree;

pub use adaptive::Adaptive;
pub use energy_momentum::EnergyMomentum;
#[doc(hidden)]
pub use fault::Fault;
pub use lobatto::Lobatto;
pub use method::Method;
pub use rattle::{Failure, Rattle};
pub use rotation::Rotation;
