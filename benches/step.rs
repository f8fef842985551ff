//! Microseconds a step of every engine on chains of 1 kg rods with alternating hinge axes, released from horizontal.
//!
//! Each pass starts afresh and skips the first steps, so that all sizes are timed in the same phase of the motion. The engines
//! take turns; medians over the rounds.

#[path = "../tests/common/mod.rs"]
mod common;

use std::sync::atomic::{AtomicBool, AtomicU64};

use rattlebench::engines::{self, Engine, Role};
use rattlebench::measure::cost::clock::{Candidate, Effort, time};
use rattlebench::mechanics::System;

/// s
const STEP: f64 = 1e-3;
const SKIPPED: usize = 20;
/// Steps after which a run starts afresh: 0.2 s, before a long chain whips.
const TIMED: u64 = 180;

const LINKS: [usize; 6] = [1, 2, 5, 10, 50, 100];

fn under_way(text: &str, system: &System) -> Box<dyn Engine> {
    let mut engine = common::engine(text, system, STEP);
    (0..SKIPPED).for_each(|_| engine.step().unwrap_or_else(|e| panic!("{e}")));
    engine
}

/// Of each engine, in their order.
fn microseconds_a_step(specs: &[&'static str], links: usize) -> Vec<f64> {
    let system = &common::compile(&common::alternating(links));
    let candidate = |text: &&'static str| {
        let text = *text;
        Candidate { build: Box::new(move || Some(under_way(text, system))), steps: TIMED }
    };
    let candidates: Vec<Candidate> = specs.iter().map(candidate).collect();
    let found = time(&candidates, Effort::FULL, &AtomicBool::new(false), &AtomicU64::new(0));
    let timings = found.expect("nothing interrupts");
    timings.into_iter().map(|timing| timing.expect("no step fails").median * 1e6).collect()
}

fn main() {
    let specs: Vec<&str> = engines::line_up(Role::Cost);
    let columns = LINKS.map(|links| microseconds_a_step(&specs, links));
    println!("{:40}{}", "us a step, links:", LINKS.map(|links| format!("{links:>10}")).concat());
    for (row, text) in specs.iter().enumerate() {
        println!("{text:40}{}", columns.each_ref().map(|column| format!("{:10.4}", column[row])).concat());
    }
}
