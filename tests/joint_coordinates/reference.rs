//! The reference against the variational core, which shares no dynamics code with it.

use nalgebra::Vector3;
use rattlebench::engines::reference::{distance, trajectory};
use rattlebench::mechanics::System;
use rattlebench::model::JointKind;

use crate::common::*;

/// Every shipped tree without dampers, compiled; a joint that swings at 30 kHz is for another test, and so are loops.
fn trees() -> Vec<System> {
    let (taken, left): (Vec<System>, Vec<System>) = shipped_scenes().iter().map(compile).partition(|system| {
        let damped = system.bodies.iter().any(|body| body.joint.damping > 0.0);
        system.parts.loops.is_empty() && !damped && system.name != "stiff_joint"
    });
    let left: Vec<&str> = left.iter().map(|system| system.name.as_str()).collect();
    assert_eq!(left, ["bricard", "damped_pendulum", "four_bar", "ladder", "slider_crank", "stiff_joint"]);
    taken
}

/// s
const DURATION: f64 = 2.0;

#[test]
fn the_reference_agrees_with_rattle_of_order_eight_on_every_shipped_scene() {
    for system in trees() {
        let reference = trajectory(&system, &[0.5 * DURATION, DURATION]).unwrap();
        let rattle = run_engine("rattle:order=8", &system, 1e-3, (DURATION * 1e3) as usize);
        let (error, estimate) = (distance(&rattle, &reference.states[1]), reference.error_estimate[1]);
        let travelled = distance(&system.initial, &reference.states[0]);
        println!("{:16} {error:.1e}, estimate {estimate:.1e}, travelled {travelled:.2}", system.name);
        // measured at least 0.021, of the gripper, which is nearly back then
        assert!(travelled > 0.01, "{}: {travelled}", system.name);
        // measured 1.1e-14 (double_pendulum) to 2.0e-12 (arm_6, 1.0e-12 against galerkin)
        assert!(error <= 5e-12, "{}: {error:e}", system.name);
        // measured 7.0e-13 (double_pendulum) to 6.3e-11 (arm_6); it errs on the safe side
        assert!(estimate <= 1.5e-10 && estimate >= error, "{}: {estimate:e} against {error:e}", system.name);
        assert_eq!(reference.trusted_until(estimate), Some(DURATION));
        assert_eq!(reference.trusted_until(0.0), None);
    }
}

/// Errors of the positions after 0.5 s of 500, 1000 and 2000 steps, extrapolated from two steps as an error of order 2: of order 4.
pub fn extrapolated_errors(system: &System) -> [f64; 3] {
    let reference = trajectory(system, &[0.5]).unwrap();
    [500, 1000, 2000].map(|steps| {
        let run = |steps: usize| run_engine("rattle", system, 0.5 / steps as f64, steps);
        let (coarse, fine) = (run(steps), run(2 * steps));
        let positions = coarse.bodies.iter().zip(&fine.bodies).zip(&reference.states[0].bodies);
        positions.map(|((c, f), r)| ((4.0 * f.position - c.position) / 3.0 - r.position).norm()).fold(0.0, f64::max)
    })
}

/// With dampers `rattle` has order 2: the error of two steps, extrapolated, is of order 4.
#[test]
fn the_reference_agrees_with_rattle_on_a_damped_chain_as_far_as_order_two_goes() {
    let kinds = [JointKind::Revolute, JointKind::Spherical, JointKind::Prismatic, JointKind::Planar];
    let mut scene = chain(&kinds.map(|kind| (kind, Vector3::new(0.2, 1.0, 0.1))));
    for (i, joint) in scene.model.joints.iter_mut().enumerate() {
        joint.damping = [0.05, 0.02, 0.5, 0.03][i];
    }
    scene.initial[1].velocity = vec![1.0, -0.5, 2.0];
    scene.initial[3].velocity = vec![0.3, 0.2, -1.0];
    let system = compile(&scene);
    let errors = extrapolated_errors(&system);
    println!("{errors:?}");
    // measured 1.6e-11, 1.0e-12, 6.9e-14: order 4
    assert!(errors[0] <= 4e-11 && errors[2] > 0.0, "{errors:?}");
    assert!(errors[0] / errors[1] > 12.0 && errors[1] / errors[2] > 12.0, "{errors:?}");
}

/// The agreement above can fail: one inertia changed by a millionth shows.
#[test]
fn a_slightly_wrong_inertia_shows_as_a_disagreement() {
    let system = compile(&alternating(2));
    let mut wrong = system.clone();
    wrong.bodies[1].inertia.y *= 1.0 + 1e-6;
    let reference = trajectory(&wrong, &[1.0]).unwrap();
    let error = distance(&run_engine("rattle:order=8", &system, 1e-3, 1000), &reference.states[0]);
    println!("{error:.1e}");
    assert!(error > 1e-8, "{error:e}");
}

#[test]
fn the_engine_lands_where_the_trajectory_does() {
    let system = compile(&alternating(3));
    let reference = trajectory(&system, &[0.3, 0.6]).unwrap();
    let error = distance(&run_engine("reference", &system, 0.01, 60), &reference.states[1]);
    println!("{error:.1e}");
    assert!(error <= 1e-13, "{error:e}");
}
