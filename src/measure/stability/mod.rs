//! Where engines stop being right: families of scenes along a parameter, against the step, each cell with a class.
//!
//! A [`Cell`] is a scene at one value of its parameter, an engine and a step. Its run is traced as any other, watched
//! for joints that part ([`watch`]), compared with a fine run that agrees with itself ([`true_samples`]), and put into
//! one of nine classes by the rules of [`class`]. No rule looks at a clock: what costs too much is known beforehand
//! ([`budget`]), and the same program finds the same classes everywhere.

pub mod budget;
pub mod cell;
pub mod class;
pub mod families;
pub mod scan;
pub mod suite;
pub mod true_samples;
pub mod watch;

pub use cell::{Case, Cell, Finding};
pub use class::Class;
pub use families::FAMILIES;
pub use scan::{Family, Scan};
pub(crate) use suite::{Shard, Suite};
