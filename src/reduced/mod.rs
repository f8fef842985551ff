//! The equations of motion in joint coordinates, on trees: constraints hold by construction.
//!
//! [`Model`] lists the links with positions `q` (angles and lengths; unit quaternions for ball and free joints) and
//! velocities `v`. [`recursive`] has mass matrix and bias force in link axes, `H(q) a + b(q, v) = tau`, solved as a dense
//! system; the reference rests on it. Nothing here shares code with the variational core.

mod model;
pub mod recursive;

pub use model::{Link, Model};
