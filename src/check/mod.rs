//! Bounds on long-time behaviour, for continuous integration: what a team's build fails on when an integrator gets
//! worse.
//!
//! A bound holds one figure of a run below a maximum, above a minimum or both. [`Requirement`]s are bounds that have
//! been checked; [`run`] takes the runs that they need, as a stream whose memory does not grow with the
//! number of steps; [`judge`](judge::judge) compares. [`controls`] asks whether bounds catch bad integrators,
//! [`propose`] writes bounds from what is measured, [`baseline`] compares with an earlier report. [`table`], [`junit`],
//! [`summary`] and [`github`] tell the findings.
//!
//! In a test of a crate that has this one as a dev-dependency:
//!
//! ```no_run
//! rattlebench::check!("models/arm/scene.json");
//! ```

pub mod baseline;
mod broken;
pub mod controls;
pub mod github;
pub mod judge;
pub mod junit;
pub mod need;
pub mod propose;
pub mod requirement;
pub mod run;
mod scene;
mod scope;
pub mod session;
mod session_error;
pub mod summary;
pub mod table;

pub use judge::{Finding, judge};
pub use requirement::{BoundError, Requirement};
pub use scene::{CheckError, Checked, assert_bounds, check, requirements};
pub use scope::{QUICK_STEPS, Scope, scoped};
pub(crate) use session_error::SessionError;
