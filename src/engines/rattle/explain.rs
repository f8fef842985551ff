//! Why a step failed: what is too fast for it, and the step with which it would have gone right.

use super::messages::{Names, describe};
use crate::mechanics::State;
use crate::variational::substep::step_that_works;
use crate::variational::{Failure, Map};

/// A rate times the step, rad, up to which failures are not put down to it.
const RESOLVED: f64 = 0.3;

/// The same for the sway of a linkage, whose forces grow large near a singular configuration without being the cause.
const SWAYS: f64 = 1.0;

/// A step that failed.
pub(super) struct Failed<'a, M> {
    pub map: &'a M,
    pub failure: Failure,
    /// When the step began, and its size, s.
    pub time: f64,
    pub step: f64,
    pub before: &'a State,
    pub names: &'a Names,
}

impl<M: Map> Failed<'_, M> {
    /// What went wrong, how fast bodies turn, and the step with which it would have gone right.
    pub(super) fn explain(&self) -> String {
        if let Some(own) = self.map.own_step() {
            return describe(self.failure, own.time, own.size, self.names);
        }
        let what = describe(self.failure, self.time, self.step, self.names);
        if matches!(self.failure, Failure::Singular { .. } | Failure::NotFinite { .. }) {
            return what;
        }
        let cause = self.cause();
        let cure = match self.step_that_works() {
            Some(step) => format!("a step of {step:.3e} s goes on from there, as would on_failure=substep (order 2)"),
            None => "halves of it down to 1/1024 fail too".to_string(),
        };
        format!("{what}; {cause}; {cure}")
    }

    /// What of the motion is too fast for the step: the turn of a body, or the sway of a body under the forces in its
    /// joints.
    fn cause(&self) -> String {
        let turning = self.before.bodies.iter().map(|body| self.step * body.angular_velocity.norm()).enumerate();
        let (turned, turn) = turning.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
        let sway = self.map.rattle().and_then(|rattle| rattle.fastest_sway());
        let (swayed, sway) = sway.map_or((0, 0.0), |(body, rate)| (body, self.step * rate));
        let names = &self.names.bodies;
        let fastest = format!("h |Omega| is at most {turn:.2} (body '{}')", names[turned]);
        let linkage = self.names.first_spring > 0;
        if sway > turn && sway > if linkage { SWAYS } else { RESOLVED } {
            return format!(
                "the forces in the joints make body '{}' sway with h omega = {sway:.1}, which the step does not \
                 resolve; {fastest}",
                names[swayed]
            );
        }
        if turn > RESOLVED {
            return format!("{fastest}, which the step does not resolve");
        }
        let place = if linkage { ", as where a linkage passes a singular configuration" } else { "" };
        format!("{fastest} and h omega of the sway {sway:.2}: the motion changes within the step{place}")
    }

    /// Found on copies of the map before the step.
    fn step_that_works(&self) -> Option<f64> {
        let start = self.map.before_failure(self.step)?;
        step_that_works(&start, self.step, |map, part| map.step(part))
    }
}
