//! The explicit Runge-Kutta pair of Dormand and Prince of order 8(5,3), DOP853.
//!
//! [`tableau`] has its coefficients, which two engines share; [`integrator`] is the integration that the reference is
//! made by. `dop853` has stages and a control of its own.

pub(super) mod integrator;
#[allow(clippy::excessive_precision, reason = "digits as published")]
pub(super) mod tableau;
