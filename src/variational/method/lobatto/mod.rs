//! Constrained Lobatto IIIA-IIIB methods of 2 to 5 stages, of order 2, 4, 6 and 8.
//!
//! The symplectic partitioned Runge-Kutta method of Jay (1996; Marsden and West 2001, section 3.5.6; Hairer, Lubich and
//! Wanner 2006, section VII.1.4) on the linear space of positions and attitude matrices, `(x, R)` in `R^3 x R^(3x3)`
//! for every body, with the kinetic energy `1/2 m |xdot|^2 + 1/2 tr(Rdot Jd Rdot^T)`, `Jd = 1/2 tr(J) 1 - J`, and the
//! constraints `R^T R = 1` and the joints. With the IIIA coefficients `a`, the IIIB coefficients `ahat`, weights `b`
//! and `q = (x, R)`,
//!
//! ```text
//! Q_i = q0 + h sum_j a_ij M^-1 P_j ,                                    phi(Q_i) = 0 , i = 2 ... s      (1)
//! P_i = p0 + h sum_j ahat_ij (f(Q_j) + G(Q_j)^T lambda_j)                                               (2)
//! q1 = Q_s ,  p1 = p0 + h sum_j b_j (f(Q_j) + G(Q_j)^T lambda_j) ,      G(q1) M^-1 p1 = 0               (3)
//! ```
//!
//! `Q_1 = q0`, and `ahat_is = 0`, so that `lambda_1 ... lambda_(s-1)` follow from (1) and `lambda_s` from the
//! projection in (3). Two stages are RATTLE. The map is symplectic, symmetric and of order `2 s - 2` on the constraint
//! manifold.
//!
//! For given forces of the joints at the stages each body is solved on its own (`attitude.rs`), as the discrete
//! Moser-Veselov equation is in RATTLE. The joints are closed by a chord iteration: their gaps at the stages `i = 2 ...
//! s` are combined by the inverse of `(a ahat)_ik` into what the forces at each stage `k = 1 ... s-1` have to close, by
//! the articulated-body recursion at that stage. With the recursion at `q0` for all of them a thin rod, whose
//! compliance is large about one axis, would make the iteration diverge.
//!
//! What it does not do: joint damping, and bodies with a `Jd` that is not positive (a flat plate has none along its
//! normal). It knows nothing of the loops, couplings, springs and drives of a system: the engine refuses them with this
//! method.
//!
//! `tests/core/independent/` solves (1) to (3) as they stand, with all multipliers, by a dense Newton method on random
//! trees: both agree to 3e-15 in the coordinates and, relatively, to 3e-14 in the momenta with 3 to 5 stages, and to
//! 1.1e-13 with 2.

mod attitude;
mod integrator;
mod iterate;
mod matrix;
mod project;
mod stages;
mod step;
mod tableau;

pub use integrator::{Lobatto, Unfit};
