//! The reference on loops, mimic joints, springs and drives, against the variational core.

use nalgebra::{Isometry3, Unit, Vector3};
use rattlebench::engines::reference::{distance, trajectory};
use rattlebench::mechanics::{Anchor, Drive, PointSpring, System};
use rattlebench::model::scene::{FixedFrame, Loop, LoopKind};
use rattlebench::model::{JointKind, Mimic};

use crate::common::*;
use crate::reference::extrapolated_errors;

/// Distance from `rattle:order=8` at the end, and the reference's own estimate.
fn disagreement(system: &System, step: f64, duration: f64) -> (f64, f64) {
    let reference = trajectory(system, &[duration]).unwrap_or_else(|e| panic!("{}: {e}", system.name));
    let rattle = run_engine("rattle:order=8", system, step, (duration / step).round() as usize);
    let travelled = distance(&system.initial, &reference.states[0]);
    let (error, estimate) = (distance(&rattle, &reference.states[0]), reference.error_estimate[0]);
    println!("{:16} {error:.1e}, estimate {estimate:.1e}, travelled {travelled:.2}", system.name);
    assert!(travelled > 0.05, "{}: {travelled}", system.name);
    (error, estimate)
}

#[test]
fn the_reference_agrees_with_rattle_on_every_shipped_linkage() {
    for (name, step, duration) in
        [("four_bar", 1e-3, 1.0), ("slider_crank", 5e-4, 1.0), ("bricard", 1e-3, 1.0), ("ladder", 1e-3, 0.2)]
    {
        let (error, estimate) = disagreement(&shipped(name), step, duration);
        // measured 2.8e-15 (four_bar), 2.7e-14, 3.5e-14 and 6.7e-14 (ladder)
        assert!(error <= 1.5e-13 && error > 0.0, "{name}: {error:e}");
        // measured 1.1e-13 (ladder) to 1.7e-12 (slider_crank)
        assert!(estimate <= 4e-12 && estimate >= error, "{name}: {estimate:e} against {error:e}");
    }
}

/// A planar chain of three hinges whose end is held by a loop.
fn closed_chain(kind: LoopKind, axis: Vector3<f64>) -> System {
    let mut scene = chain(&[(JointKind::Revolute, Vector3::y()); 3]);
    scene.loops.push(Loop {
        name: "end".into(),
        kind,
        axis: Unit::new_normalize(axis),
        parent: FixedFrame { link: Some(3), origin: Isometry3::translation(0.3, 0.0, 0.0) },
        child: FixedFrame { link: None, origin: Isometry3::translation(0.5, 0.0, 0.1) },
    });
    scene.initial[0].velocity = vec![1.0];
    scene.initial[0].velocity_given = true;
    compile(&scene)
}

#[test]
fn the_reference_agrees_with_rattle_on_loops_of_every_kind_that_moves() {
    let cases = [
        (LoopKind::Revolute, Vector3::y(), 0.5),
        (LoopKind::Spherical, Vector3::y(), 0.5),
        // It folds onto itself after 0.38 s, where its path forks.
        (LoopKind::Prismatic, Vector3::new(1.0, 0.0, 0.5), 0.25),
    ];
    for (kind, axis, duration) in cases {
        let (error, estimate) = disagreement(&closed_chain(kind, axis), 5e-4, duration);
        // measured 6.7e-16 to 3.0e-15, and 6.9e-14 to 7.9e-14
        assert!(error <= 8e-15 && estimate <= 2e-13, "{kind:?}: {error:e} {estimate:e}");
    }
}

#[test]
fn the_reference_agrees_with_rattle_on_a_mimic_joint() {
    let mut scene = chain(&[(JointKind::Revolute, Vector3::y()), (JointKind::Revolute, Vector3::new(0.0, 1.0, 0.5))]);
    scene.model.joints[1].mimic = Some(Mimic { source: 0, multiplier: -1.5, offset: 0.2 });
    scene.initial[0].velocity = vec![2.0];
    (scene.initial[0].position_given, scene.initial[0].velocity_given) = (true, true);
    let (error, estimate) = disagreement(&compile(&scene), 1e-3, 1.0);
    // measured 1.3e-14 and 9.5e-13
    assert!(error <= 4e-14 && estimate <= 2.5e-12, "{error:e} {estimate:e}");
}

/// Rows that are left out are found: the loop opens, and the run ends with its name.
#[test]
fn a_loop_that_opens_ends_the_reference_by_name() {
    let mut system = shipped("four_bar");
    system.mobility.rank -= 1;
    let failure = trajectory(&system, &[0.1]).unwrap_err().to_string();
    assert!(failure.contains("loop 'rocker_pin' stays open by "), "{failure}");
}

/// Three spatial hinges with a spring to the ground, one between the first and the last link, and a drive.
fn sprung(damping: f64) -> System {
    let mut scene = alternating(3);
    scene.initial[0].velocity = vec![1.0];
    scene.initial[2].position = vec![0.6];
    let mut system = compile(&scene);
    let anchor = |body, x: f64, y: f64, z: f64| Anchor { body, point: Vector3::new(x, y, z) };
    let spring = |from, to, rest_length| PointSpring { from, to, stiffness: 60.0, damping, rest_length };
    system.parts.point_springs = vec![
        spring(anchor(None, 0.2, -0.5, 0.6), anchor(Some(1), 0.1, 0.05, 0.0), 0.4),
        spring(anchor(Some(2), 0.15, 0.0, 0.1), anchor(Some(0), -0.1, 0.0, 0.2), 0.3),
    ];
    let frequency = std::f64::consts::TAU * 1.3;
    system.parts.drives =
        vec![Drive { body: 1, effort: 0.3, amplitude: 2.0, angular_frequency: frequency, phase: 0.4 }];
    system.energy_scale = rattlebench::mechanics::energy::scale(&system);
    system
}

/// `rattle` carries roundoff of the springs that does not fall with its step, and the motion enlarges it: it is asked for
/// 0.25 s. `galerkin`, with a mass matrix of its own, is asked for 1 s.
#[test]
fn the_reference_agrees_with_others_on_springs_between_points_and_drives() {
    let system = sprung(0.0);
    let (error, estimate) = disagreement(&system, 1e-3, 0.25);
    // measured 1.6e-11 (4.7e-11 at half the step) and 3.0e-13
    assert!(error <= 4e-11 && estimate <= 8e-13, "{error:e} {estimate:e}");
    let reference = trajectory(&system, &[1.0]).unwrap();
    let error = distance(&run_engine("galerkin:stages=8", &system, 5e-3, 200), &reference.states[0]);
    // measured 6.0e-13 and 6.8e-11
    assert!(error <= 1.5e-12 && reference.error_estimate[0] <= 2e-10, "{error:e}");
    // Negative control: the springs matter.
    let mut softer = system.clone();
    softer.parts.point_springs[1].stiffness *= 1.0 + 1e-6;
    assert!(disagreement_of(&softer, &system) > 1e-8);
}

fn disagreement_of(a: &System, b: &System) -> f64 {
    distance(&trajectory(a, &[1.0]).unwrap().states[0], &trajectory(b, &[1.0]).unwrap().states[0])
}

/// With dampers `rattle` has order 2: the error of two steps, extrapolated, is of order 4.
#[test]
fn the_reference_agrees_with_rattle_on_damped_springs_as_far_as_order_two_goes() {
    let system = sprung(1.5);
    let errors = extrapolated_errors(&system);
    println!("{errors:?}");
    // measured 5.9e-10, 3.7e-11, 2.3e-12: order 4
    assert!(errors[0] <= 1.5e-9 && errors[2] > 0.0, "{errors:?}");
    assert!(errors[0] / errors[1] > 12.0 && errors[1] / errors[2] > 12.0, "{errors:?}");
}

/// The elbow swings at 30 kHz by as much as gravity deflects it, 1e-8 rad: `rattle` steps over that, the reference does not.
#[test]
fn the_reference_follows_a_stiff_joint_that_rattle_steps_over() {
    let system = shipped("stiff_joint");
    let reference = trajectory(&system, &[0.02]).unwrap();
    let rattle = run_engine("rattle:order=8", &system, 1e-3, 20);
    let (error, estimate) = (distance(&rattle, &reference.states[0]), reference.error_estimate[0]);
    let travelled = distance(&system.initial, &reference.states[0]);
    println!("{error:.1e}, estimate {estimate:.1e}, travelled {travelled:.1e}");
    assert!(travelled > 1e-3, "{travelled:e}");
    // measured 6.2e-11 and 9.7e-15
    assert!(error <= 2e-10 && estimate <= 3e-14, "{error:e} {estimate:e}");
}
