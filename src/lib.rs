//! Compares a variational RATTLE integrator with rapier on the same URDF multibody models.
//!
//! # The system simulated
//!
//! `n` rigid bodies. Body `b` has mass `m_b` (kg), principal moments of inertia `J_b` (kg m^2), centre of mass
//! `x_b` (m, world axes), attitude `R_b` (body to world; the body frame has its origin in the centre of mass and its
//! axes along the principal axes), linear momentum `p_b = m_b xdot_b` (kg m/s) and spin angular momentum
//! `pi_b = R_b J_b Omega_b` (kg m^2/s, world axes). Joints are holonomic constraints `phi(q) = 0` with velocity form
//! `G(q) v = 0`. The equations of motion are those of the constrained Lagrangian
//!
//! ```text
//! L(q, v) = sum_b 1/2 m_b |xdot_b|^2 + 1/2 Omega_b . J_b Omega_b + m_b g . x_b ,      phi(q) = 0 .
//! ```
//!
//! # Conventions
//!
//! SI units throughout: lengths in m, angles in rad, time in s. World axes are those of the URDF's root link at rest;
//! gravity is `(0, 0, -9.81)` m/s^2 unless the scene says otherwise. A *twist* is the pair of a linear and an angular
//! velocity in world axes, the linear part taken at the point that is named (the centre of mass unless said
//! otherwise); a *wrench* is a force and a torque about the same point. Quaternions turn body axes to world axes.
//!
//! # The modules, in the order in which data flows
//!
//! | module | holds |
//! | --- | --- |
//! | [`model`] | what a URDF and a scene file say, validated, as plain SI data |
//! | [`mechanics`] | the compiled system: rigid bodies, joints as motion subspaces, energy, momentum, residuals |
//! | [`reduced`] | the equations of motion in joint coordinates, for the reference and the rivals of the core |
//! | [`variational`] | RATTLE and the tree recursion that solves its constraints in O(n) |
//! | [`discrete`] | the general discrete mechanics of Marsden and West on linear spaces |
//! | [`engines`] | what can advance a system: one trait, one list, one file an engine |
//! | [`measure`] | one traced and one timed run of any engine, and the figures taken from its states |
//! | [`report`] | records with a schema, charts and the page |
//! | [`mod@check`] | bounds on figures of runs, for continuous integration |
//! | [`cli`] | one file a subcommand |

pub mod check;
pub mod cli;
pub mod discrete;
pub mod engines;
pub mod measure;
pub mod mechanics;
pub mod model;
mod numeric;
pub mod reduced;
pub mod report;
pub mod variational;
