//! Processor time a step against the size of the system.

use std::sync::atomic::{AtomicBool, AtomicU64};

use super::clock::{self, Candidate, Effort, Timing};
use crate::engines::{self, Spec};
use crate::mechanics::System;

/// Engines that step systems of several sizes.
#[derive(Debug)]
pub(crate) struct Scaling<'a> {
    pub engines: &'a [Spec],
    /// Each with its number of links.
    pub systems: &'a [(usize, System)],
    /// s
    pub step: f64,
    /// Steps that are timed, from the initial state; fewer where they take long.
    pub steps: u64,
}

/// Processor time a step of one engine on one system.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    pub engine: String,
    pub links: usize,
    pub timing: Timing,
}

impl Scaling<'_> {
    /// Turns that the timing takes at most, one for each engine and system in each round and one before.
    pub fn turns(&self) -> u64 {
        (self.engines.len() * self.systems.len()) as u64 * Effort::FULL.turns()
    }

    /// Times every engine on every system, in turns; what an engine cannot simulate or step is left out. `None` where
    /// it was interrupted.
    pub fn run(&self, interrupted: &AtomicBool, taken: &AtomicU64) -> Option<Vec<Point>> {
        let cases: Vec<(&Spec, &(usize, System))> =
            self.engines.iter().flat_map(|spec| self.systems.iter().map(move |system| (spec, system))).collect();
        let candidates: Vec<Candidate> = cases
            .iter()
            .map(|(spec, (_, system))| Candidate {
                build: Box::new(move || engines::build(spec, system, self.step).ok()),
                steps: self.steps,
            })
            .collect();
        let timings = clock::time(&candidates, Effort::FULL, interrupted, taken)?;
        let point = |((spec, (links, _)), timing): (&(&Spec, &(usize, System)), Option<Timing>)| {
            Some(Point { engine: spec.to_string(), links: *links, timing: timing? })
        };
        Some(cases.iter().zip(timings).filter_map(point).collect())
    }
}
