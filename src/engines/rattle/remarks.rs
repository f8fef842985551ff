//! What a reader of a run should know of how its steps were taken.

use crate::variational::composition::Composed;
use crate::variational::substep::Halving;
use crate::variational::{Adaptive, EnergyMomentum, Faulty, Lobatto, Map, Rattle};

/// A map that can tell of its steps.
pub(super) trait Told: Map {
    /// How they were taken, where that is not as asked: the step is that of the run, s, `taken` the number of its
    /// steps.
    fn steps(&self, step: f64, taken: u64) -> Option<String>;

    /// How many of the steps failed and were taken in halves.
    fn steps_in_halves(&self) -> u64 {
        0
    }
}

impl Told for Rattle {
    fn steps(&self, _step: f64, _taken: u64) -> Option<String> {
        None
    }
}

impl Told for Lobatto {
    fn steps(&self, _step: f64, _taken: u64) -> Option<String> {
        None
    }
}

impl Told for Faulty {
    fn steps(&self, _step: f64, _taken: u64) -> Option<String> {
        None
    }
}

impl<M: Map> Told for Composed<M> {
    fn steps(&self, _step: f64, _taken: u64) -> Option<String> {
        None
    }
}

impl<M: Told> Told for Halving<M> {
    fn steps(&self, step: f64, taken: u64) -> Option<String> {
        let halved = self.halved();
        let first: Vec<String> = halved.first.iter().map(|&before| format!("{:.6} s", before as f64 * step)).collect();
        (halved.steps > 0).then(|| {
            format!(
                "on_failure=substep: {} of {taken} steps did not converge and were taken in halves, at the finest in \
                 {} parts, first at t = {}; the map is not symplectic there",
                halved.steps,
                1_u32 << halved.most,
                first.join(", ")
            )
        })
    }

    fn steps_in_halves(&self) -> u64 {
        self.halved().steps
    }
}

impl Told for Adaptive {
    fn steps(&self, _step: f64, _taken: u64) -> Option<String> {
        Some(format!("step=adaptive took {} steps of its own", Adaptive::steps(self)))
    }
}

impl Told for EnergyMomentum {
    fn steps(&self, _step: f64, _taken: u64) -> Option<String> {
        self.report().map(|report| {
            format!(
                "method=energy_momentum took {} steps of its own, of {:.3e} to {:.3e} s, by {} solves; they keep a \
                 discrete energy of {:.9e} J to {:.1e} of its terms",
                report.steps, report.shortest, report.longest, report.solves, report.energy, report.worst
            )
        })
    }
}

/// A body that left the Moser-Veselov equation at a time, s.
pub(super) fn switched(body: &str, time: f64) -> String {
    format!(
        "body '{body}' turns too fast for the Moser-Veselov equation at t = {time:.6} s; from there on it turns by \
         rotation=splitting"
    )
}
