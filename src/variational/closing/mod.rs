//! The constraints at the end of the drift, (1) to (3) of [`super::rattle`]: predict, drift, measure, correct, until
//! roundoff.
//!
//! | file | is |
//! | --- | --- |
//! | [`iterate`] | the loop |
//! | [`stop`] | its thresholds, and which rule ends it; [`progress`] applies them, [`decline`] below roundoff |
//! | [`predict`] | where it starts |
//! | [`measure`] | the drift, and what it leaves open |
//! | [`correct`] | a round of the chord iteration, and one with the exact linearisation |
//! | [`accept`] | the refusal of false solutions |

mod accept;
mod correct;
pub(super) mod counters;
mod decline;
mod iterate;
mod measure;
mod predict;
mod progress;
pub(super) mod stop;
