//! One test for each way in which rapier would not do what it is asked, and for what the adapter promises about it.

use approx::assert_relative_eq;
use nalgebra::Vector3;
use rapier3d_f64::prelude::{
    MassProperties, PhysicsWorld, RevoluteJointBuilder, RigidBodyBuilder, RigidBodyHandle, Vector,
};
use rattlebench::engines::{self, StepFailure};
use rattlebench::mechanics::coordinates::{JointCoordinates, joint_coordinates};
use rattlebench::mechanics::{State, System, constraint, energy};
use rattlebench::model::{Inertial, JointKind};

use crate::runs::{after, difference, engine, spec};
use crate::{common, scenes};

const BOTH: [&str; 2] = ["rapier:precision=f64", "rapier:precision=f64,joints=multibody"];

/// A ball far from everything, without gravity.
fn ball(velocity: Vector3<f64>, angular_velocity: Vector3<f64>) -> System {
    let mut system = scenes::named("free body");
    system.gravity = Vector3::zeros();
    system.bodies[0].inertia = Vector3::from_element(0.01);
    let state = &mut system.initial.bodies[0];
    (state.position, state.velocity, state.angular_velocity) = (Vector3::zeros(), velocity, angular_velocity);
    system
}

/// The same ball in rapier as it comes.
fn plain_ball(velocity: Vector, angular_velocity: Vector, step: f64) -> (PhysicsWorld, RigidBodyHandle) {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    world.integration_parameters.dt = step;
    let properties = MassProperties::new(Vector::ZERO, 1.0, Vector::splat(0.01));
    let body = RigidBodyBuilder::dynamic().additional_mass_properties(properties);
    let handle = world.insert_body(body.linvel(velocity).angvel(angular_velocity));
    (world, handle)
}

/// A flywheel that turns about its principal z axis, which is that of the joint, without gravity.
fn flywheel(damping: f64, rate: f64) -> System {
    let mut scene = common::chain(&[(JointKind::Continuous, Vector3::z())]);
    scene.gravity = Vector3::zeros();
    scene.model.links[1].inertial = Some(Inertial { com: Vector3::zeros(), ..common::rod() });
    scene.model.joints[0].damping = damping;
    scene.initial[0].velocity[0] = rate;
    common::compile(&scene)
}

#[test]
fn a_slow_body_does_not_fall_asleep() {
    let slow = after(BOTH[0], &ball(Vector3::new(0.01, 0.0, 0.0), Vector3::zeros()), 0.01, 1000);
    assert_relative_eq!(slow.bodies[0].position.x, 0.1, epsilon = 1e-14); // measured 1e-16
    let (mut world, handle) = plain_ball(Vector::new(0.01, 0.0, 0.0), Vector::ZERO, 0.01);
    (0..1000).for_each(|_| world.step());
    assert!(world.bodies[handle].translation().x < 0.05, "rapier's default sleeps");
}

#[test]
fn a_fast_rotation_is_not_capped() {
    let spin = after(BOTH[0], &ball(Vector3::zeros(), Vector3::new(0.0, 0.0, 1000.0)), 0.01, 10);
    assert_relative_eq!(spin.bodies[0].angular_velocity.z, 1000.0, max_relative = 1e-13);
    let (mut world, handle) = plain_ball(Vector::ZERO, Vector::new(0.0, 0.0, 1000.0), 0.01);
    world.step();
    assert_relative_eq!(world.bodies[handle].angvel().z, std::f64::consts::FRAC_PI_4 / 0.01, max_relative = 1e-12);
}

#[test]
fn a_fast_translation_is_not_capped() {
    let flight = after(BOTH[0], &ball(Vector3::new(1000.0, 0.0, 0.0), Vector3::zeros()), 0.01, 100);
    assert_relative_eq!(flight.bodies[0].position.x, 1000.0, max_relative = 1e-12);
    let (mut world, handle) = plain_ball(Vector::new(1000.0, 0.0, 0.0), Vector::ZERO, 0.01);
    world.step();
    assert_relative_eq!(world.bodies[handle].linvel().x, 400.0, max_relative = 1e-12);
}

#[test]
fn a_multibody_joint_without_damping_loses_no_speed() {
    let turned = after(BOTH[1], &flywheel(0.0, 5.0), 0.01, 100);
    assert_relative_eq!(turned.bodies[0].angular_velocity.z, 5.0, max_relative = 1e-12);
    let (mut world, handle) = plain_ball(Vector::ZERO, Vector::ZERO, 0.01);
    let ground = world.insert_body(RigidBodyBuilder::fixed());
    let joint = world.multibody_joints.insert(ground, handle, RevoluteJointBuilder::new(Vector::Z), true);
    let index = world.multibody_joints.rigid_body_link(handle).expect("a link").multibody;
    world.step();
    let multibody = world.multibody_joints.get_multibody_mut(index).expect("a multibody");
    multibody.generalized_velocity_mut()[0] = 5.0;
    (0..100).for_each(|_| world.step());
    let rate = world.multibody_joints[index].generalized_velocity()[0];
    assert!(joint.is_some() && rate < 0.01, "rapier's default damps: {rate}");
}

#[test]
fn velocities_of_a_multibody_are_those_of_the_end_of_the_step() {
    let text = "rapier:precision=f64,joints=multibody,substeps=1";
    let system = scenes::named("pendulum");
    let angle = |state: &State| {
        let mut theta = [JointCoordinates::default()];
        joint_coordinates(&system, state, &mut theta);
        (theta[0].position[0], theta[0].velocity[0])
    };
    let step = 1e-3;
    let (before, now) = (angle(&after(text, &system, step, 4)), angle(&after(text, &system, step, 5)));
    // theta1 = theta0 + h thetadot1, while the velocity changes by 6e-3 in the step.
    assert_relative_eq!((now.0 - before.0) / step, now.1, epsilon = 1e-12);
    assert!((now.1 - before.1).abs() > 1e-3);
}

#[test]
fn positions_lead_velocities_by_half_a_substep() {
    let system = common::compile(&common::chain(&[(JointKind::Revolute, Vector3::y())]));
    // With impulse joints as they come the energy that they dissipate, 2e-2 here, hides the difference.
    for (text, gain) in [
        (BOTH[1], 100.0),              // measured 300
        ("rapier:preset=strong", 4.0), // measured 8
    ] {
        let mut engine = engine(text, &system, 0.01);
        let lag = engine.position_lag_s();
        let mut state = system.initial.clone();
        let mut worst = [0.0_f64; 3];
        for _ in 0..30 {
            engine.step().expect("a step can be taken");
            engine.write_state(&mut state);
            for (worst, lag) in worst.iter_mut().zip([0.0, lag, -lag]) {
                let total = energy::energy_at_velocity_time(&system, &state, &[], lag).total();
                *worst = worst.max((total / system.energy_scale).abs());
            }
        }
        let [raw, corrected, wrong_sign] = worst;
        assert!(raw > 5e-3 && raw > gain * corrected, "{text}: {raw:e} {corrected:e}");
        assert!(wrong_sign > 1.8 * raw, "{text}: {raw:e} {wrong_sign:e}");
    }
}

#[test]
fn a_damper_slows_a_flywheel_as_its_equation_says() {
    for text in BOTH.into_iter().chain(["rapier:preset=strong"]) {
        let (damping, rate, time) = (0.02, 5.0, 0.5);
        let system = flywheel(damping, rate);
        let exact = rate * (-damping / system.bodies[0].inertia.z * time).exp();
        let error = |steps: u32| {
            let state = after(text, &system, time / f64::from(steps), steps);
            (state.bodies[0].angular_velocity.z / exact - 1.0).abs()
        };
        let (coarse, fine) = (error(500), error(2000));
        assert!(fine <= 1e-3, "{text}: {fine:e}"); // measured 1.1e-4, 4.3e-4 with one substep
        assert_relative_eq!(coarse / fine, 4.0, max_relative = 0.01);
    }
}

#[test]
fn gyroscopic_torque_is_on_unless_it_is_switched_off() {
    let system = scenes::named("free body");
    let start = system.initial.bodies[0].angular_velocity;
    let turned = |text: &str| (after(text, &system, 1e-3, 300).bodies[0].angular_velocity - start).norm();
    assert!(turned("rapier:precision=f64") > 0.1);
    assert!(turned("rapier:precision=f64,gyro=off") < 1e-13);
}

#[test]
fn every_key_acts() {
    let system = scenes::damped(&scenes::named("every joint"), 0.01);
    let run = |text: &str| after(text, &system, 1e-3, 50);
    let default = run("rapier");
    let double = run("rapier:precision=f64");
    assert!(difference(&default, &double) > 1e-5);
    for key in [
        "joints=multibody",
        "preset=strong",
        "substeps=2",
        "iterations=3",
        "stabilization=0",
        "softness_hz=100",
        "damping_ratio=50,softness_hz=1000",
        "gyro=off",
    ] {
        let change = difference(&double, &run(&format!("rapier:precision=f64,{key}")));
        assert!(change > 1e-5, "{key}: {change:e}");
    }
    let spelled = run("rapier:precision=f64,substeps=1,iterations=4,stabilization=0");
    assert_eq!(run("rapier:preset=strong"), spelled);
    assert_eq!(
        run("rapier:preset=strong,iterations=16,precision=f32"),
        run("rapier:substeps=1,iterations=16,stabilization=0")
    );
    assert_eq!(run("rapier:preset=default"), default);
}

/// Each row applies its old impulse right before it is solved, and what it then adds makes up for it exactly: with `d`
/// the row's inverse mass, `w + (r - d w - c w) / (d + c) = r / (d + c)` whatever `w` is.
#[test]
fn a_warm_start_changes_joints_without_limits_by_roundoff_only() {
    let system = scenes::damped(&scenes::named("every joint"), 0.01);
    for joints in ["rapier:precision=f64", "rapier:precision=f64,softness_hz=20"] {
        let run = |text: &str| after(text, &system, 1e-3, 50);
        let change = difference(&run(joints), &run(&format!("{joints},warmstart=on")));
        assert!(change > 0.0 && change <= 1e-12, "{joints}: {change:e}"); // measured 4e-13, 1e-14
    }
}

#[test]
fn multibody_joints_hold_to_roundoff_and_impulse_joints_do_not() {
    let system = common::compile(&common::alternating(5));
    let residual = |text: &str| constraint::residual(&system, &after(text, &system, 1e-3, 500));
    let (multibody, impulse) = (residual(BOTH[1]), residual(BOTH[0]));
    assert!(multibody.position <= 2e-16, "{multibody:?}"); // measured 4.9e-17
    assert!(multibody.velocity <= 1e-14, "{multibody:?}"); // measured 3.6e-15
    assert!(impulse.position > 1e-5 && impulse.velocity > 5e-3, "{impulse:?}"); // measured 3.9e-5, 1.8e-2
}

#[test]
fn runs_repeat_bit_by_bit() {
    let system = scenes::named("torso");
    for text in ["rapier", "rapier:preset=strong", "rapier:joints=multibody,precision=f64"] {
        assert_eq!(after(text, &system, 1e-3, 100), after(text, &system, 1e-3, 100), "{text}");
    }
}

#[test]
fn a_motion_that_overflows_ends_in_a_failure_and_the_last_finite_state() {
    for (text, factor) in [("rapier", 1e30), ("rapier:precision=f64", 1e300), ("rapier:preset=strong", 1e300)] {
        let mut system = scenes::named("chain");
        system.gravity *= factor;
        let mut engine = engine(text, &system, 1.0);
        let mut state = system.initial.clone();
        let failure = (0..100).find_map(|_| {
            engine.write_state(&mut state);
            engine.step().err()
        });
        let failure = failure.expect("the motion overflows");
        assert!(matches!(&failure, StepFailure::Diverged { detail } if detail.contains("body 'link_")), "{failure}");
        let mut kept = system.initial.clone();
        engine.write_state(&mut kept);
        assert!(kept.is_finite() && kept == state, "{text}");
        assert_eq!(engine.step(), Err(failure), "{text}");
    }
}

/// A known shortfall of rapier (`free_velocity_energy_guard`): accelerations that are not finite become zero, so the
/// run goes on as if there were no forces and no engine outside can tell.
#[test]
fn a_multibody_hides_an_overflow_of_its_accelerations() {
    let mut system = scenes::named("pendulum");
    system.initial_coordinates[0].velocity[0] = 1e30;
    let rates = |steps| after("rapier:joints=multibody", &system, 1.0, steps).bodies[0].angular_velocity.norm();
    assert_relative_eq!(rates(5), 1e30, max_relative = 1e-6);
}

#[test]
fn what_a_precision_cannot_hold_is_refused() {
    let system = scenes::named("pendulum");
    let refusal = |text: &str, system: &System, step: f64| match engines::build(&spec(text), system, step) {
        Ok(_) => panic!("{text} takes it"),
        Err(unsupported) => unsupported.to_string(),
    };
    assert_eq!(
        refusal("rapier", &system, 1e-45),
        "engine 'rapier' does not support a step of 1e-45 s in 4 substeps: it vanishes in single precision"
    );
    let mut changed = system.clone();
    changed.gravity = Vector3::new(0.0, 0.0, -1e40);
    assert_eq!(
        refusal("rapier", &changed, 1e-3),
        "engine 'rapier' does not support a gravity of 1e40 m/s^2: it overflows in single precision"
    );
    changed = system.clone();
    changed.bodies[0].mass = 1e21;
    assert_eq!(
        refusal("rapier:precision=f64", &changed, 1e-3),
        "engine 'rapier:precision=f64' does not support the mass 1e21 of body 'link_1': its inverse vanishes or \
         overflows in double precision"
    );
    changed = scenes::damped(&system, 1e-18);
    assert_eq!(
        refusal("rapier:precision=f64", &changed, 1e-3),
        "engine 'rapier:precision=f64' does not support the damping 1e-18 of joint 'joint_1': so weak a motor acts as \
         a lock"
    );
    assert!(engines::build(&spec("rapier:precision=f64,joints=multibody"), &changed, 1e-3).is_ok());
    changed = system.clone();
    changed.initial.bodies[0].velocity.x = 1e39;
    assert_eq!(
        refusal("rapier", &changed, 1e-3),
        "engine 'rapier' does not support the initial motion of body 'link_1': it is out of the range of single precision"
    );
}

#[test]
fn no_number_makes_rapier_panic() {
    for text in BOTH.into_iter().chain(["rapier", "rapier:joints=multibody", "rapier:preset=strong"]) {
        for scene in scenes::all() {
            for (step, gravity, speed) in [
                (1e-300, 10.0, 1.0),
                (1e-30, 1e20, 1e8),
                (1.0, 1e38, 1.0),
                (1e3, 1e300, 1e30),
                (1e30, 0.0, 1e200),
                (1e300, 1e300, 1e200),
            ] {
                let mut system = scenes::damped(&scene, 1e3);
                system.gravity *= gravity;
                for (state, theta) in system.initial.bodies.iter_mut().zip(&mut system.initial_coordinates) {
                    (state.velocity, state.angular_velocity) = (state.velocity * speed, state.angular_velocity * speed);
                    theta.velocity.iter_mut().for_each(|rate| *rate *= speed);
                }
                let Ok(mut engine) = engines::build(&spec(text), &system, step) else { continue };
                let mut state = system.initial.clone();
                (0..5).for_each(|_| drop(engine.step()));
                engine.write_state(&mut state);
                assert!(state.is_finite(), "{text}, {}, step {step:e}", system.name);
            }
        }
    }
}
