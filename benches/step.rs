//! Microseconds a step of every engine on chains of 1 kg rods with alternating hinge axes, released from horizontal.
//!
//! Each pass starts afresh and skips the first steps, so that all sizes are timed in the same phase of the motion. The
//! engines take turns; medians over the rounds.

#[path = "../tests/common/mod.rs"]
mod common;

use cpu_time::ThreadTime;
use rattlebench::engines::{self, Role};
use rattlebench::mechanics::System;

/// s
const STEP: f64 = 1e-3;
const SKIPPED: usize = 20;
/// Steps after which a run starts afresh: 0.2 s, before a long chain whips.
const TIMED: usize = 180;
const ROUNDS: usize = 7;
/// A turn steps about so many links, so that short chains are repeated.
const LINKS_A_TURN: usize = 500;

const LINKS: [usize; 6] = [1, 2, 5, 10, 50, 100];

/// Microseconds a step in one turn.
fn turn(text: &str, system: &System) -> f64 {
    let passes = (LINKS_A_TURN / system.bodies.len()).max(1);
    let mut spent = 0.0;
    for _ in 0..passes {
        let mut engine = common::engine(text, system, STEP);
        let mut steps = |count| (0..count).for_each(|_| engine.step().unwrap_or_else(|e| panic!("{e}")));
        steps(SKIPPED);
        let begin = ThreadTime::now();
        steps(TIMED);
        spent += begin.elapsed().as_secs_f64();
    }
    spent * 1e6 / (passes * TIMED) as f64
}

/// Medians of each engine, in their order.
fn microseconds_a_step(specs: &[&str], links: usize) -> Vec<f64> {
    let system = common::compile(&common::alternating(links));
    let mut times = vec![Vec::new(); specs.len()];
    for _ in 0..ROUNDS {
        for (text, times) in specs.iter().zip(&mut times) {
            times.push(turn(text, &system));
        }
    }
    let median = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times[ROUNDS / 2]
    };
    times.into_iter().map(median).collect()
}

fn main() {
    let specs: Vec<&str> = engines::line_up(Role::Cost);
    let columns = LINKS.map(|links| microseconds_a_step(&specs, links));
    println!("{:40}{}", "us a step, links:", LINKS.map(|links| format!("{links:>10}")).concat());
    for (row, text) in specs.iter().enumerate() {
        println!("{text:40}{}", columns.each_ref().map(|column| format!("{:10.4}", column[row])).concat());
    }
}
