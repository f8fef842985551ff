//! What holds between bodies beside the joints of the tree: loop closures, couplings and springs between points.
//!
//! Each is one or more scalar [`Row`]s. Loops and couplings are constraints like the joints: an impulse `nu` along
//! their rows in the first half kick makes them hold at `q1`, another in the second makes their velocities vanish
//! there. A spring with a damper has the discrete potential and force of the distance `d` at both ends of the step,
//!
//! ```text
//! nu = -h/2 k ((d0 + d1)/2 - rest) - c/2 (d1 - d0)      in both half kicks, along grad d(q0) and grad d(q1),
//! ```
//!
//! which is a row with the compliance `1 / (kappa h)`, `kappa = h k / 4 + c / 2`: a stiff spring costs what a soft one
//! costs and tends to a rod. Distances and couplings are running sums of their changes over the steps; what a change is
//! follows from the motions of the bodies, so that small steps do not cancel.
//!
//! On a line, with `beta = kappa h T` for the mobility `T` of the row, the end `y1` of the way between the points obeys
//!
//! ```text
//! y1 + beta |y1| = b .
//! ```
//!
//! Where `beta > 1` there are two solutions for `b > 0`, of which the one with `y1 < 0` is false, and none for `b < 0`.
//! Where `beta < 1` there is one, but with `y1 < 0` the direction turns round within the step and each such pass errs
//! in energy by about `beta` of what the spring holds. So beyond `beta` of [`PASS`] a distance on the far side counts
//! as negative, which leads the iteration back, and a step that ends there all the same is refused.
//!
//! A spring with the rest length 0 needs no direction: `V = k/2 |D|^2` for the way `D` from point to point, and
//!
//! ```text
//! nu = -h/2 k (D0 + D1)/2
//! ```
//!
//! is three rows along the world's axes. A damper beside it is a row of its own, along the way; where the points
//! coincide it has no direction and does not pull, as any spring.

mod build;
mod measure;
mod place;
mod state;

pub(in crate::variational) use build::bonds;
pub(in crate::variational) use place::Trying;
pub(in crate::variational) use state::Bond;
