//! The rapier engines: rapier 0.36 in single and double precision, on the same [`System`] as every other engine.
//!
//! # What rapier is given
//!
//! One dynamic body a [`Body`](crate::mechanics::Body), its origin in the centre of mass and its axes principal, with
//! mass and moments and no collider; one `GenericJoint` a joint, which locks the components of the relative twist that
//! [`JointKind::free`](crate::mechanics::JointKind::free) does not name; gravity; and the positions and velocities at
//! t = 0. A floating joint without damping is no joint. `joints=impulse` solves them as velocity constraints by
//! projected Gauss-Seidel, `joints=multibody` puts each tree into reduced coordinates.
//!
//! Viscous joint damping `-c thetadot` is implicit on both sides: `damping` of the generalized coordinates with
//! multibody joints, and with impulse joints a force based motor on each free axis with target velocity zero, stiffness
//! zero and unlimited force. The impulse of such a motor converges to `-c h thetadot` with `iterations`.
//!
//! A spring in a joint is, with its damper and that of the joint, one motor with a target position (impulse joints), or
//! the spring that each coordinate of a multibody may have; both are implicit (backward Euler), and so they take energy
//! out. The motor knows its angle modulo a turn: a torsion spring that winds up further than half a turn from its rest
//! pulls the wrong way. A spring between points is rapier's `SpringJoint`, which does not act on the links of a
//! multibody. A drive is a torque on the two bodies of a hinge, or a force on the line of a slider, as it is at the
//! middle of the step, along the axis at its beginning; rapier holds it over its substeps.
//!
//! # What is always set, and differs from rapier's defaults
//!
//! Bodies never sleep and may turn by any angle in a step; the cap on linear speed is off; there are no substeps of
//! continuous collision detection and no counters; the damping of 0.1 that rapier gives to each angular coordinate of a
//! multibody is replaced by that of the joint. All else is rapier's default unless a key of the spec says otherwise.
//!
//! # What its states mean
//!
//! A substep of length `h = step / substeps` is semi-implicit: `v1 = v0 + h a(x0)`, `x1 = x0 + h v1`, so velocities
//! belong to a time `h/2` before the positions and [`Engine::position_lag_s`](crate::engines::Engine::position_lag_s)
//! is `h/2`. Multibody velocities are computed from the generalized ones, because rapier leaves those of the bodies one
//! substep behind. Single precision is converted where a state is written; the step size too is rounded to single
//! precision.
//!
//! # Limits
//!
//! Rapier takes a body whose pose is not finite out of the simulation, with its velocity set to zero: that is reported
//! as [`StepFailure::Diverged`](crate::engines::StepFailure::Diverged), and the engine stays at the last finite state.
//! Where the solution for the accelerations of a multibody is not finite, rapier goes on with accelerations of zero and
//! does not tell. The solver settings except `substeps` do not act on multibody joints.

mod double;
mod entry;
mod settings;
mod single;

pub(super) use entry::ENTRY;
