//! The goals for cost, each as a ratio with its goal: time a link, against rapier, growth with the links, memory a link.
//!
//! Chains of 1 kg rods with alternating hinge axes, released from horizontal, h = 1e-3 s. Processor time of one thread over steps
//! 21 to 200; engines take turns, medians of the rounds.

#[path = "../tests/common/mod.rs"]
mod common;

use std::alloc::{GlobalAlloc, Layout, System as Heap};
use std::sync::atomic::{AtomicIsize, Ordering};

use cpu_time::ThreadTime;
use rattlebench::engines::{self, Engine, Spec};
use rattlebench::mechanics::System;

/// s
const STEP: f64 = 1e-3;
const SKIPPED: usize = 20;
const TIMED: usize = 180;
const ROUNDS: usize = 7;
/// A turn steps about so many links, so that short chains are repeated.
const LINKS_A_TURN: usize = 2000;

const RATTLE: &str = "rattle";
const RAPIER: &str = "rapier:precision=f64";
const LINKS: [usize; 4] = [10, 100, 1000, 10_000];

/// Bytes on the heap.
static LIVE: AtomicIsize = AtomicIsize::new(0);

struct Counting;

unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LIVE.fetch_add(layout.size() as isize, Ordering::Relaxed);
        unsafe { Heap.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size() as isize, Ordering::Relaxed);
        unsafe { Heap.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

fn build(text: &str, system: &System) -> Box<dyn Engine> {
    let spec = Spec::parse(text).unwrap_or_else(|e| panic!("{e}"));
    engines::build(&spec, system, STEP).unwrap_or_else(|e| panic!("{e}"))
}

/// Microseconds a step in one turn.
fn turn(text: &str, system: &System, links: usize) -> f64 {
    let passes = (LINKS_A_TURN / links).max(1);
    let mut spent = 0.0;
    for _ in 0..passes {
        let mut engine = build(text, system);
        let mut steps = |count| (0..count).for_each(|_| engine.step().unwrap_or_else(|e| panic!("{e}")));
        steps(SKIPPED);
        let begin = ThreadTime::now();
        steps(TIMED);
        spent += begin.elapsed().as_secs_f64();
    }
    spent * 1e6 / (passes * TIMED) as f64
}

/// Bytes that an engine holds beside the system that it is made from.
fn memory(system: &System) -> f64 {
    let before = LIVE.load(Ordering::Relaxed);
    let engine = build(RATTLE, system);
    let held = LIVE.load(Ordering::Relaxed) - before;
    drop(engine);
    held as f64
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn report(what: &str, found: f64, goal: f64) {
    let verdict = if found <= goal { "met" } else { "NOT met" };
    println!("{what:58} {found:8.3}   goal <= {goal:5}   {verdict}");
}

fn main() {
    let systems = LINKS.map(|n| (n, common::compile(&common::alternating(n))));
    let cases: Vec<(&str, &(usize, System))> =
        systems.iter().map(|s| (RATTLE, s)).chain(systems[..2].iter().map(|s| (RAPIER, s))).collect();
    let mut times = vec![Vec::new(); cases.len()];
    for _ in 0..ROUNDS {
        for ((text, (links, system)), times) in cases.iter().zip(&mut times) {
            times.push(turn(text, system, *links));
        }
    }
    let micros: Vec<f64> = times.into_iter().map(median).collect();
    for ((text, (links, _)), micros) in cases.iter().zip(&micros) {
        println!("{text:22} {links:6} links {micros:12.3} us a step {:8.4} us a link", micros / *links as f64);
    }
    println!();
    report("us a link a step, 100 links", micros[1] / 100.0, 1.0);
    report("time over that of rapier f64 impulse joints, 10 links", micros[0] / micros[4], 0.5);
    report("time over that of rapier f64 impulse joints, 100 links", micros[1] / micros[5], 0.5);
    let points: Vec<(f64, f64)> = LINKS.iter().zip(&micros).map(|(n, t)| (*n as f64, *t)).collect();
    report("exponent of time over links, 10 to 10 000", common::slope(&points), 1.05);
    for (links, system) in &systems {
        report(&format!("KiB a link, {links} links"), memory(system) / (1024.0 * *links as f64), 4.0);
    }
}
