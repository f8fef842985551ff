//! The equations of motion in joint coordinates: the joints of the tree hold by construction.
//!
//! [`Model`] lists the links with positions `q` (angles and lengths; unit quaternions for ball and free joints) and
//! velocities `v`. Three formulations of its dynamics stand side by side; none shares code with the variational core.
//!
//! - [`equations::Dynamics`]: mass matrix and bias force in link axes, `H(q) a + b(q, v) = tau`, solved as a dense
//!   system. The reference rests on it, and it shares nothing but the model with the other two. It alone holds loops
//!   and mimic joints.
//! - [`equations::Articulated`]: accelerations by the articulated-body recursion in world axes, O(n), for the
//!   fixed-step and adaptive methods that a careful user would take instead of a constrained integrator.
//! - [`galerkin`]: the Galerkin variational integrator on Hamilton's equations, O(n).

mod closure;
mod elimination;
pub mod equations;
pub mod galerkin;
mod inertia;
mod joint;
mod joint_frame;
mod link;
mod link_frame;
mod model;
mod number;
mod spatial;
mod spring;

pub use link::Link;
pub use model::Model;
