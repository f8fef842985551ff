//! No allocation inside a step.

use std::alloc::{GlobalAlloc, Layout, System as Heap};
use std::cell::Cell;

use nalgebra::Vector3;
use rattlebench::engines::{self, Spec};
use rattlebench::model::JointKind::*;

use crate::common::*;

thread_local! {
    /// Of this thread alone: the test harness allocates in another one.
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

struct Counting;

unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        unsafe { Heap.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { Heap.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn a_step_allocates_nothing() {
    let joints = [Revolute, Spherical, Prismatic, Planar, Floating].map(|kind| (kind, Vector3::new(0.1, 1.0, 0.2)));
    let mut damped = chain(&joints);
    damped.model.joints[1].damping = 0.01;
    let specs = [
        "rattle",
        "rattle:order=8",
        "rattle:method=lobatto,stages=4",
        "rattle:step=adaptive,tol=1e-5",
        "rattle:on_failure=substep",
        "galerkin:stages=5",
        "dop853",
        "rk4",
        "semi_implicit_euler",
        "explicit_euler",
    ];
    let cases = specs.map(|text| (chain(&joints), text));
    let mut whirl = alternating(2);
    whirl.initial[0].velocity = vec![30.0];
    let more = [(damped.clone(), "rattle"), (damped, "galerkin"), (whirl, "rattle:method=energy_momentum")];
    for (scene, text) in cases.into_iter().chain(more) {
        let system = compile(&scene);
        let before = ALLOCATIONS.get();
        let mut engine = engines::build(&Spec::parse(text).unwrap(), &system, 1e-3).unwrap();
        let mut state = system.initial.clone();
        let built = ALLOCATIONS.get();
        assert!(built > before, "the counter counts");
        for _ in 0..100 {
            engine.step().unwrap();
            engine.write_state(&mut state);
        }
        assert_eq!(ALLOCATIONS.get() - built, 0, "{text}");
    }
}
