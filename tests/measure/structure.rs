//! What a few steps preserve, of maps whose defects are known in closed form and of every engine.

use std::sync::atomic::{AtomicBool, AtomicU64};
use std::time::Duration;

use nalgebra::Vector3;
use rattlebench::engines::{self, Spec};
use rattlebench::measure::outcome::Limits;
use rattlebench::measure::structure::{Structure, examine, examined_state, reversibility, symplecticity};
use rattlebench::mechanics::{State, System};
use rattlebench::model::JointKind;

use crate::common::*;

const STEP: f64 = 0.01;

fn examined(system: &System, spec: &str, step: f64) -> Structure {
    let (state, at) = examined_state(system, 10.0);
    let limits =
        Limits { budget: Duration::from_secs(100), interrupted: &AtomicBool::new(false), taken: &AtomicU64::new(0) };
    examine(system, &Spec::parse(spec).expect("a spec"), step, (&state, at), &limits).expect("supported")
}

/// A map that multiplies all velocities by 1 + e multiplies the form by it too: the defect is e, found to the error of the
/// differences; and it comes back with velocities (1 + e)^2 too large.
#[test]
fn a_map_that_stretches_momenta_has_the_defect_of_its_stretch() {
    let stretch = 1e-3;
    let map = |from: &System| {
        let mut state = from.initial.clone();
        for body in &mut state.bodies {
            body.velocity *= 1.0 + stretch;
            body.angular_velocity *= 1.0 + stretch;
        }
        Ok(state)
    };
    for name in ["double_pendulum", "joint_zoo", "torso"] {
        let system = shipped(name);
        let (state, _) = examined_state(&system, 10.0);
        let found = symplecticity(&system, &state, 0.0, &map).expect("a map");
        // measured at most 2.0e-12 (joint_zoo), of which the defect is 5.2e-13 off
        assert!((found.defect - stretch).abs() <= 1.5e-12 && found.error <= 5e-12, "{name}: {found:?}");
        let back = reversibility(&system, &state, 0.0, &map).expect("a map");
        let own = reversibility(&system, &state, 0.0, &|from| Ok(from.initial.clone())).expect("a map");
        assert!(own <= 1e-13 && back > stretch, "{name}: {own:e} {back:e}");
    }
}

/// Semi-implicit Euler in free fall: `v1 = v0 + h g`, `x1 = x0 + h v1`. It comes back `h^2 g` off, and exactly in coordinates
/// moved back by `h/2`; it is symplectic in both.
#[test]
fn a_lag_of_the_positions_is_taken_out() {
    let system = compile(&chain(&[(JointKind::Prismatic, Vector3::z())]));
    let g = system.gravity.z;
    let map = |from: &System| {
        let mut state = from.initial.clone();
        state.bodies[0].velocity.z += STEP * g;
        let velocity = state.bodies[0].velocity;
        state.bodies[0].position += STEP * velocity;
        Ok(state)
    };
    let off = |lag: f64| reversibility(&system, &system.initial, lag, &map).expect("a map");
    assert!((off(0.0) - STEP * STEP * g.abs()).abs() <= 1e-15, "{:e}", off(0.0));
    assert!(off(0.5 * STEP) <= 1e-15, "{:e}", off(0.5 * STEP));
    for lag in [0.0, 0.5 * STEP] {
        let found = symplecticity(&system, &system.initial, lag, &map).expect("a map");
        assert!(found.defect <= found.error && found.error <= 1e-11, "{found:?}");
    }
}

#[test]
fn rattle_has_no_defect_and_rapier_has() {
    for name in ["double_pendulum", "heavy_top", "tumbling_body", "joint_zoo"] {
        let system = shipped(name);
        for spec in ["rattle", "rattle:order=8", "rattle:rotation=cayley"] {
            let found = examined(&system, spec, STEP);
            let form = found.as_returned.symplecticity.expect("measured");
            // measured at most 3.1e-9 (joint_zoo)
            assert!(form.defect <= form.error && form.error <= 8e-9, "{name} {spec}: {form:?}");
            let rest = [found.as_returned.reversibility, found.memory, found.momentum_map];
            // measured at most 4.0e-14 (joint_zoo)
            assert!(rest.into_iter().flatten().all(|x| x <= 1e-13), "{name} {spec}: {found:?}");
            assert!(found.as_returned.reversibility.is_some() && found.time_level_corrected.is_none());
        }
        for spec in ["rapier:preset=strong", "rapier:joints=multibody,precision=f64"] {
            let found = examined(&system, spec, STEP);
            let form = found.as_returned.symplecticity.expect("measured");
            // measured from 2.6e3 (joint_zoo, strong)
            assert!(form.defect >= 1e3 * form.error, "{name} {spec}: {form:?}");
        }
    }
}

/// The start of an engine with memory is part of its defect, so the mean of a step falls when many are taken as one map; without
/// memory it does not. The memory tells the two apart.
#[test]
fn memory_tells_whose_defect_is_that_of_the_start() {
    let system = shipped("double_pendulum");
    let (state, _) = examined_state(&system, 10.0);
    let measured = |text: &str| {
        let spec = Spec::parse(text).expect("a spec");
        let defect_of_a_step = |steps: usize| {
            let map = |from: &System| -> Result<State, _> {
                let mut engine = engines::build(&spec, from, STEP).expect("supported");
                (0..steps).for_each(|_| engine.step().expect("a step"));
                let mut state = from.initial.clone();
                engine.write_state(&mut state);
                Ok(state)
            };
            symplecticity(&system, &state, 0.0, &map).expect("a map").defect / steps as f64
        };
        (defect_of_a_step(16) / defect_of_a_step(1), examined(&system, text, STEP).memory.expect("measured"))
    };
    let (impulse, with_memory) = measured("rapier:preset=strong");
    let (multibody, without) = measured("rapier:joints=multibody,precision=f64");
    // measured 0.029 and 3.8e-3, 3.6 and 3.3e-16
    assert!(impulse < 0.08 && with_memory > 1.5e-3, "{impulse} {with_memory:e}");
    assert!(multibody > 1.5 && without < 2e-15, "{multibody} {without:e}");
}

/// With dampers no exact step is symplectic: the figures are left out and the reason is told.
#[test]
fn a_damped_system_has_no_defect_of_the_form() {
    let mut scene = alternating(2);
    scene.model.joints.iter_mut().for_each(|joint| joint.damping = 0.05);
    let found = examined(&compile(&scene), "rattle", STEP);
    assert_eq!((found.as_returned.symplecticity, found.as_returned.reversibility), (None, None));
    assert!(found.memory.is_some_and(|x| x <= 1e-12), "{found:?}");
    assert_eq!(found.detail.as_deref(), Some("with dampers the exact motion is neither symplectic nor reversible"));
}

/// A loop leaves fewer motions than the joints have coordinates: the form is that of independent ones.
#[test]
fn a_linkage_keeps_the_form_of_its_independent_joints() {
    let system = shipped("four_bar");
    let found = examined(&system, "rattle", STEP);
    let form = found.as_returned.symplecticity.expect("measured");
    // measured 5.0e-13 with an error of 1.8e-12
    assert!(form.defect <= 2.0 * form.error && form.error < 5e-12 && found.at == 0.5, "{found:?}");
    // measured 8.9e-16 and 6.7e-16
    assert!(found.as_returned.reversibility.is_some_and(|x| x <= 3e-15), "{found:?}");
    assert!(found.memory.is_some_and(|x| x <= 2e-15), "{found:?}");
    assert_eq!(found.detail, None);
}
