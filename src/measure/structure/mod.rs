//! What a few steps of an engine preserve of the structure of the motion, seen from outside.
//!
//! The exact motion of a system without dampers is a map of joint coordinates `theta` and conjugate momenta `p` that is
//! symplectic, time-reversible, and keeps the momentum of every symmetry (Marsden and West 2001, sections 1.3 and 2.1;
//! on a constraint manifold 3.4). [`examine`] takes [`STEPS`] steps of ANY engine as such a map `Phi` and says how far
//! it is from that:
//!
//! - *symplecticity*: the largest entry of `A^T Omega A - Omega`, where `A` is the derivative of `Phi` by differences
//!   and `Omega = dtheta ^ dp`; what the differences themselves err by is estimated and stands beside it,
//! - *reversibility*: the largest entry of `R Phi R Phi z - z`, where `R` turns all velocities round,
//! - *momentum map*: the largest change of a component that the system conserves, over its scale, among all states that
//!   the differences visit,
//! - *memory*: the largest entry of `Phi_2 z - Phi Phi z`, where `Phi_2` is twice as many steps of one engine: what
//!   steps take from those before them and not from coordinates and momenta (impulses kept to start the next solve,
//!   joint errors).
//!
//! Engines are made new at every point, from the coordinates and velocities that belong to it. An engine with memory
//! does not start as it goes on: rapier's impulse joints, made new without joint errors, take some steps to their own
//! small ones, and that start is no symplectic map. Several steps as one map count it once. Where the memory is not
//! small against the defect of the form, part of the defect is that of the start.
//!
//! Where an engine's positions belong to another time than its velocities
//! ([`Engine::position_lag_s`](crate::engines::Engine::position_lag_s)) symplecticity and reversibility are taken
//! twice: of the states as they are, and of the same map in coordinates moved back to the time of the velocities,
//! `theta - lag thetadot`.
//!
//! In systems with loops or mimic joints the coordinates are those of independent joints. A point is written as
//! `y = (theta, H^-1 p)` with the diagonal `H` of the mass matrix at the start, so that all entries
//! are rad, m, rad/s or m/s; an entry `(i, j)` of the form's defect is divided by `sqrt(H_i H_j)`.

mod examine;
mod failure;
mod independent;
mod phase;
mod phase_chart;
mod reversibility;
mod symplecticity;

pub use examine::{Defects, STEPS, Structure, examine, examined_state};
pub use failure::{Failure, StateMap};
pub use phase_chart::{PhaseChart, body_momenta, twists};
pub use reversibility::reversibility;
pub use symplecticity::{Differenced, defect_by, symplecticity};
