//! Microseconds a step of every engine on chains of 1 kg rods with alternating hinge axes, released from horizontal.
//!
//! Each sample starts afresh and skips the first steps, so that all sizes are timed in the same phase of the motion.

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rattlebench::engines::{self, Role, Spec};

/// s
const STEP: f64 = 1e-3;
const SKIPPED: usize = 20;
/// Steps after which a run starts afresh: 0.2 s, before a long chain whips.
const TIMED: u64 = 180;

fn step(criterion: &mut Criterion) {
    for text in engines::line_up(Role::Cost) {
        let spec = Spec::parse(text).unwrap_or_else(|e| panic!("{e}"));
        let mut group = criterion.benchmark_group(text);
        group.sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
        for links in [1, 2, 5, 10, 50, 100] {
            let system = common::compile(&common::alternating(links));
            group.throughput(Throughput::Elements(links as u64));
            group.bench_function(BenchmarkId::from_parameter(links), |bencher| {
                bencher.iter_custom(|iterations| {
                    let mut spent = Duration::ZERO;
                    let mut left = iterations;
                    while left > 0 {
                        let mut engine = engines::build(&spec, &system, STEP).unwrap_or_else(|e| panic!("{e}"));
                        (0..SKIPPED).for_each(|_| engine.step().unwrap_or_else(|e| panic!("{e}")));
                        let count = left.min(TIMED);
                        let start = Instant::now();
                        (0..count).for_each(|_| engine.step().unwrap_or_else(|e| panic!("{e}")));
                        spent += start.elapsed();
                        left -= count;
                    }
                    spent
                })
            });
        }
        group.finish();
    }
}

criterion_group!(benches, step);
criterion_main!(benches);
