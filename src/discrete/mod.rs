//! Discrete mechanics on linear spaces: the theory of variational integrators, its methods, and the evidence.
//!
//! MW = J. E. Marsden and M. West, "Discrete mechanics and variational integrators", Acta Numerica 10 (2001).
//! PC = G. W. Patrick and C. Cuell, "Error analysis of variational integrators of unconstrained Lagrangian systems",
//! 2008/09.
//!
//! A discrete Lagrangian `L_d(q0, q1, h)` approximates the action of a motion from `q0` to `q1` in time `h`. Its two
//! Legendre transforms say which momenta belong to the ends, and a motion is a sequence of points at which the momenta
//! from both sides agree. Everything else is made of this:
//!
//! | equation | says | here |
//! | --- | --- | --- |
//! | MW 1.2, 1.4 | `L(q, v)`, `p = dL/dv`, energy | [`system::LagrangianSystem`] |
//! | MW 1.3.3 | `D2 L_d(q0, q1) + D1 L_d(q1, q2) = 0` | [`maps::euler_lagrange_residual`], [`maps::lagrangian_map`] |
//! | MW 1.3.2 | `Omega_Ld = D12 L_d dq0 ^ dq1` is preserved | [`structure::symplectic_form`] |
//! | MW 1.3.4 | `J+`, `J-` agree under a symmetry | [`structure::momentum_maps`] |
//! | MW 1.5, 2.1.2 | `p0 = -D1 L_d`, `p1 = D2 L_d` | [`lagrangian::DiscreteLegendre`], [`maps::hamiltonian_map`] |
//! | MW 1.6.1 | `L_d^E`, the action of the exact motion | [`methods::Exact`] |
//! | MW 2.1.2 | equivalence, null Lagrangians | [`methods::Equivalent`] |
//! | MW 2.3, PC 4 | orders of `L_d`, `F+`, `F-` and the map | [`order::order_table`] |
//! | MW 2.3.2, 2.3.3 | `L_d^alpha`, `L_d^(sym,alpha)` | [`methods::alpha`], [`methods::symmetrised`] |
//! | MW 2.4.1 | `L_d*(q0, q1, h) = -L_d(q1, q0, -h)` | [`methods::Adjoint`] |
//! | MW 2.5.1 | several steps as one | [`methods::Composition`] |
//! | MW 2.6.2, 2.6.3 | Newmark; kicks and drifts | [`methods::Newmark`], `methods::explicit_prk` |
//! | MW 2.6.8 | symplectic partitioned Runge-Kutta | [`methods::partitioned_rk`] |
//! | MW 2.6.10, 5.3.8 | Galerkin, sinusoidal trajectories | [`methods::polynomial`], [`methods::Trigonometric`] |
//! | MW 3.2 | `f_d-`, `f_d+`, forced Legendre transforms | [`lagrangian::WithForce`] |
//! | MW 3.4.1, 3.5.2 | maps on N, SHAKE and RATTLE | [`constrained::shake`], [`constrained::constrained_map`] |
//! | MW 3.5.5 | stages on N | [`methods::constrained_lobatto`] |
//! | MW 3.7 | both | [`constrained`] on a [`lagrangian::WithForce`] |
//! | MW 4.2, 4.9.1 | time as a coordinate; the step is solved for | [`extended`] |
//! | PC 2 | discretisations `(psi, alpha+, alpha-)` of TQ; steps in `(q, v)` that survive `h -> 0` | [`tangent`] |
//! | PC 4 | two discrete Lagrangians on the two sides | [`two_sided`] |
//! | MW figures 1, 2 | energy against RK4 | [`figures`] |
//!
//! Nearly all methods are one form of sum with different numbers, [`stencil`]; a new one is a file in [`methods`] and a
//! line in its list. Solves are Newton's method to roundoff, [`solve`]; references are [`flow`] on [`problems`].
//!
//! Positions, momenta and velocities are in whatever units the system has; examples are dimensionless or SI.

pub mod constrained;
pub mod constraint;
pub mod extended;
pub mod figures;
pub mod flow;
pub mod force;
pub mod lagrangian;
pub mod maps;
pub mod methods;
pub mod order;
pub mod problems;
pub mod quadrature;
pub mod solve;
pub mod stencil;
pub mod structure;
pub mod system;
pub mod tangent;
pub mod two_sided;

/// A vector of R^n.
pub type Vector = nalgebra::DVector<f64>;
/// A real matrix.
pub type Matrix = nalgebra::DMatrix<f64>;
