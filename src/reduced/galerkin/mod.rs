//! The Galerkin variational integrator of Marsden and West (2001), section 2.6.6, in joint coordinates.
//!
//! The action over a step is taken on the polynomials of degree `s` with Gauss-Legendre quadrature at `s` points; its
//! discrete Hamiltonian map is Gauss collocation of Hamilton's equations. With stage velocities `u_i` the stages
//! satisfy
//!
//! ```text
//! q_i = q0 + sum_j mu_ij h b_j qdot(q_j, u_j)                                   (1)
//! p_i = p0 + sum_j mu_ij h b_j pdot(q_j, p_j, u_j)                              (2)
//! m(q_i, p_i) = H(q_i) u_i                                                      (3)
//! q1  = q0 + sum_j h b_j qdot_j ,    p1 = p0 + sum_j h b_j pdot_j               (4)
//! ```
//!
//! The stages are predicted one `LANES` of them after the other, by the explicit Adams method on the nodes before them,
//! those of the last step included: a node is much nearer to the next than a step is long, so the prediction errs far
//! less than an extrapolation over the whole step. Then (3) is solved for the corrections of the `u_i` with the mass
//! matrix that was factorised at the predicted stage; each further round costs two sweeps of vectors over the tree and
//! no factorisation. The rounds go on until what they leave would be lost in roundoff; `q` and `p` are compensated
//! sums. What is iterated to the end does not depend on where it started, so the prediction takes nothing from symmetry
//! and symplecticity.
//!
//! Over a long step the rounds may be no contraction, whatever their start. Then the stages are continued from those of
//! shorter steps, by Newton's method on (3) with the positions and momenta of (1) and (2) as functions of the
//! velocities.
//!
//! Symplectic, time-reversible, of order `2 s`; keeps joints exactly and momenta that are bilinear in `q` and `p`,
//! among them the angular momentum of a free body; does not conserve energy, whose error stays bounded. Springs between
//! points add to the potential, and drives a potential `-f(t) q` at the times of the stages. Damping, in joints and
//! beside springs, enters by the Lagrange-d'Alembert principle.

mod adams;
mod batch;
mod continuation;
mod failure;
mod gauss;
mod integrator;
mod krylov;
mod newton;

pub use failure::Failure;
pub use integrator::Galerkin;
