//! The variational integrators for rigid bodies with joints.
//!
//! [`rattle::Rattle`] is the discrete Hamiltonian map of Marsden and West (2001), section 3.5.4, on the constraint
//! manifold of the joints. Its linear algebra is the articulated-body recursion over the tree of joints; a body turns
//! by a rule of [`rotation`]; [`composition`] raises the order, [`adaptive`] varies the step, [`energy_momentum`]
//! solves for it, [`substep`] takes a step that fails in halves. Loops, couplings and springs between points are rows
//! across the tree, whose Schur complement is factorised with its rank revealed; springs, dampers and drives of the
//! joints enter the recursion itself.

mod chain;
mod closing;
#[doc(hidden)]
pub mod fault;
mod force;
mod map;
pub mod method;
mod predictor;
pub mod rattle;
pub mod rotation;
mod tree;

pub use closing::counters::Counters;
pub use closing::stop::Ending;
#[doc(hidden)]
pub use fault::{Fault, Faulty};
pub use map::{Map, OwnStep};
pub use method::adaptive::Adaptive;
pub use method::energy_momentum::EnergyMomentum;
pub use method::lobatto::Lobatto;
pub use method::{Method, adaptive, composition, energy_momentum, lobatto, substep};
pub use rattle::{Failure, Rattle};
pub use rotation::Rotation;
