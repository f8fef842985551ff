//! The variational core on trees: order, constraints, symmetries, reversibility, and that the tests can fail.

use nalgebra::Vector3;
use rattlebench::mechanics::{State, System, energy, momentum};
use rattlebench::model::JointKind::{self, *};
use rattlebench::variational::composition::{self, Composition};
use rattlebench::variational::{Failure, Rattle, Rotation};

use crate::common::*;

/// Largest figures over every state of a run.
struct Figures {
    energy: f64,
    open: Open,
}

fn run(system: &System, h: f64, duration: f64) -> Figures {
    run_composed(system, &composition::ORDER_2, h, duration)
}

fn run_composed(system: &System, composition: &Composition, h: f64, duration: f64) -> Figures {
    let mut rattle = Rattle::new(system).unwrap();
    let mut state = system.initial.clone();
    let start = energy::energy(system, &state).total();
    let mut figures = Figures { energy: 0.0, open: Open::default() };
    for _ in 0..(duration / h).round() as usize {
        composition.step(&mut rattle, h).unwrap();
        rattle.write_state(&mut state);
        let error = (energy::energy(system, &state).total() - start).abs() / system.energy_scale;
        assert!(error.is_finite());
        figures.energy = figures.energy.max(error);
        figures.open.see(system, &state);
    }
    figures
}

/// `open`: bounds of the joints' residuals.
fn assert_order_two_and_joints_hold(system: &System, duration: f64, energy_at_1e3: f64, open: Open) {
    let mut points = Vec::new();
    for h in [1e-3, 5e-4, 2e-4, 1e-4] {
        let figures = run(system, h, duration);
        println!("h {h}: energy {:.3e} {:?}", figures.energy, figures.open);
        assert!(figures.open.at_most(open.position, open.velocity), "{:?}", figures.open);
        points.push((h, figures.energy));
    }
    assert!(points[0].1 > 0.0 && points[0].1 <= energy_at_1e3, "{:e}", points[0].1);
    let order = slope(&points);
    assert!((order - 2.0).abs() <= 0.1, "order {order}");
}

/// Two rods, hinges about y and z, from horizontal, 10 s.
#[test]
fn the_double_pendulum_has_order_two_and_holds_its_joints() {
    // measured 9.2e-6, order 2.00, position 6e-16 m, velocity 2e-15
    let open = Open { position: 1.5e-15, velocity: 5e-15 };
    assert_order_two_and_joints_hold(&compile(&alternating(2)), 10.0, 2e-5, open);
}

/// Every joint type in one chain, with a velocity on every coordinate.
fn zoo() -> System {
    let kinds: [(JointKind, Vector3<f64>); 6] = [
        (Revolute, Vector3::new(0.3, 1.0, 0.2)),
        (Spherical, Vector3::x()),
        (Prismatic, Vector3::new(1.0, 0.5, 0.1)),
        (Planar, Vector3::new(0.1, 0.2, 1.0)),
        (Continuous, Vector3::new(0.0, 0.0, -1.0)),
        (Floating, Vector3::x()),
    ];
    let mut scene = chain(&kinds);
    for (k, joint) in scene.initial.iter_mut().enumerate() {
        for (i, v) in joint.velocity.iter_mut().enumerate() {
            *v = 0.3 - 0.1 * i as f64 + 0.07 * k as f64;
        }
        for (i, x) in joint.position.iter_mut().enumerate() {
            *x = 0.05 * (i as f64 + 1.0) - 0.02 * k as f64;
        }
    }
    compile(&scene)
}

#[test]
fn a_chain_of_every_joint_type_has_order_two_and_holds_its_joints() {
    // measured 6.2e-7, order 2.00, position 1.6e-15 m, velocity 4.9e-15
    let open = Open { position: 4e-15, velocity: 1.2e-14 };
    assert_order_two_and_joints_hold(&zoo(), 1.0, 1.5e-6, open);
}

#[test]
fn compositions_have_their_order_on_a_spatial_chain() {
    let system = five_links();
    let cases: [(Composition, f64, [f64; 4]); 3] = [
        (composition::ORDER_4, 4.0, [4e-3, 2.5e-3, 2e-3, 1.25e-3]),
        (composition::ORDER_6, 6.0, [8e-3, 6.25e-3, 5e-3, 4e-3]),
        (composition::ORDER_8, 8.0, [1.25e-2, 1e-2, 8e-3, 6.25e-3]),
    ];
    for (composition, order, steps) in cases {
        let points: Vec<_> =
            steps.into_iter().map(|h| (h, run_composed(&system, &composition, h, 1.0).energy)).collect();
        let fitted = slope(&points);
        println!("order {order}: fitted {fitted:.2}, {points:?}");
        assert!((fitted - order).abs() <= 0.2, "{fitted}");
        assert!(points[3].1 > 1e-14, "above the roundoff floor");
    }
}

/// A free body about its intermediate axis.
fn tumbling(gravity: f64) -> System {
    let mut scene = chain(&[(Floating, Vector3::x())]);
    scene.gravity = Vector3::new(0.0, 0.0, -gravity);
    let body = scene.model.links[1].inertial.as_mut().unwrap();
    body.inertia = nalgebra::Matrix3::from_diagonal(&Vector3::new(1.0e-3, 2.0e-3, 3.0e-3));
    scene.initial[0].velocity = vec![0.1, 0.2, 0.0, 0.02, 5.0, 0.01];
    compile(&scene)
}

#[test]
fn a_free_body_keeps_its_momenta_over_a_million_steps() {
    let system = tumbling(0.0);
    let conserved = momentum::conserved(&system);
    assert_eq!(conserved.len(), 6);
    let mut rattle = Rattle::new(&system).unwrap();
    let mut state = system.initial.clone();
    let spin0 = spin(&system, &state);
    assert!(spin0.norm() > 1e-3);
    let mut worst = 0.0_f64;
    for _ in 0..1_000_000 {
        rattle.step(1e-3).unwrap();
        rattle.write_state(&mut state);
        worst = worst.max((spin(&system, &state) - spin0).norm() / spin0.norm());
    }
    println!("angular momentum {worst:.1e}");
    // measured 6.4e-15
    assert!(worst <= 2e-14);
    for c in &conserved {
        let error = (c.value(&system, &state) - c.value(&system, &system.initial)).abs() / c.scale;
        // measured at most 1.6e-16
        assert!(error <= 5e-16, "{}: {error:e}", c.name);
    }
}

fn spin(system: &System, state: &State) -> Vector3<f64> {
    let (body, s) = (&system.bodies[0], &state.bodies[0]);
    let omega = s.attitude.inverse_transform_vector(&s.angular_velocity);
    s.attitude * body.inertia.component_mul(&omega)
}

#[test]
fn a_thousand_steps_and_back_return_to_the_start() {
    // measured 1.5e-15, 4.6e-13 and 6.0e-15
    for (system, bound) in [(compile(&alternating(5)), 4.5e-15), (zoo(), 1.3e-12), (tumbling(9.81), 1.8e-14)] {
        let mut state = system.initial.clone();
        let mut forward = Rattle::new(&system).unwrap();
        for _ in 0..1000 {
            forward.step(1e-3).unwrap();
        }
        forward.write_state(&mut state);
        let travelled = distance(&state, &system.initial);
        assert!(travelled > 0.1);
        state = reversed(state);
        let mut back = Rattle::from_state(&system, &state).unwrap();
        for _ in 0..1000 {
            back.step(1e-3).unwrap();
        }
        back.write_state(&mut state);
        let missed = distance(&state, &system.initial);
        println!("travelled {travelled:.2}, missed by {missed:.1e}");
        assert!(missed <= bound, "{missed:e}");
    }
}

/// Position residuals stay at roundoff, and the energy error stays at its h^2 law, down to tiny steps.
#[test]
fn small_steps_do_not_cancel() {
    let system = compile(&alternating(3));
    // measured 2.0e-14 and 4.9e-20, and at most 1.4e-16 m and 3.4e-16 m/s
    for (h, energy) in [(1e-5, 5e-14), (1e-6, 1.5e-19)] {
        let figures = run(&system, h, 2e3 * h);
        println!("h {h}: energy {:.1e} {:?}", figures.energy, figures.open);
        assert!(
            figures.open.at_most(4e-16, 1e-15) && figures.energy <= energy,
            "{:e} {:?}",
            figures.energy,
            figures.open
        );
    }
}

/// The energy that a damped joint loses is the work of its damper: K + U + c int thetadot^2 dt, to second order.
#[test]
fn dampers_take_out_their_work_to_second_order() {
    for (kind, damping) in [(Revolute, 0.1), (Prismatic, 0.8), (Spherical, 0.05), (Planar, 0.3)] {
        let mut scene =
            chain(&[(Revolute, Vector3::y()), (kind, Vector3::new(0.2, 0.1, 1.0)), (Revolute, Vector3::z())]);
        scene.model.joints[1].damping = damping;
        scene.initial[1].velocity.fill(0.5);
        let system = compile(&scene);
        let errors: Vec<(f64, f64)> =
            [4e-3, 2e-3, 1e-3, 5e-4].into_iter().map(|h| (h, balance(&system, damping, h, 1.0))).collect();
        let order = slope(&errors);
        println!("{kind:?}: order {order:.2}, {errors:?}");
        assert!((order - 2.0).abs() <= 0.15, "{kind:?}: order {order}");
        // Negative control: a damper of the other sign, or of 1 % more, breaks the balance.
        let wrong = balance(&system, 1.01 * damping, 5e-4, 1.0);
        assert!(wrong > 5.0 * errors[3].1, "{wrong:e}");
    }
}

/// Energy balance error over a run when the joint of body 1 has the given damping, by the trapezoidal rule.
fn balance(system: &System, damping: f64, h: f64, duration: f64) -> f64 {
    use rattlebench::mechanics::coordinates::{JointCoordinates, joint_coordinates};
    let mut rattle = Rattle::new(system).unwrap();
    let mut state = system.initial.clone();
    let mut joints = vec![JointCoordinates::default(); system.bodies.len()];
    let mut power = |state: &State| {
        joint_coordinates(system, state, &mut joints);
        damping * joints[1].velocity.iter().map(|v| v * v).sum::<f64>()
    };
    let start = energy::energy(system, &state).total();
    let (mut lost, mut before, mut worst) = (0.0, power(&state), 0.0_f64);
    for _ in 0..(duration / h).round() as usize {
        rattle.step(h).unwrap();
        rattle.write_state(&mut state);
        let now = power(&state);
        lost += 0.5 * h * (before + now);
        before = now;
        worst = worst.max((energy::energy(system, &state).total() + lost - start).abs() / system.energy_scale);
    }
    assert!(lost > 1e-3 * system.energy_scale, "the damper does something: {lost}");
    worst
}

#[test]
fn a_step_too_long_for_the_rotation_is_refused_by_name() {
    let mut scene = chain(&[(Floating, Vector3::x())]);
    scene.initial[0].velocity = vec![0.0, 0.0, 0.0, 300.0, 0.0, 0.0];
    let system = compile(&scene);
    let mut rattle = Rattle::new(&system).unwrap();
    let mut before = system.initial.clone();
    rattle.write_state(&mut before);
    assert!(matches!(rattle.step(1e-2), Err(Failure::Rotation { body: 0, .. })));
    let mut after = before.clone();
    rattle.write_state(&mut after);
    assert_eq!(before, after, "a refused step leaves the state as it was");
    rattle.step(1e-3).unwrap();
}

/// Ten links whip at h = 1e-2: the chord iteration alone stops contracting there (at 3.91 s, after 60 rounds).
#[test]
fn a_whip_with_long_steps_is_run_through() {
    // Joints measured 1.9e-15 m and 1.7e-14 m/s, 2.7e-15 m and 1.7e-13 m/s.
    for (links, h, bound, position, velocity) in [(10, 1e-2, 0.1, 5e-15, 5e-14), (50, 1e-3, 1e-2, 7e-15, 5e-13)] {
        let figures = run(&compile(&alternating(links)), h, 10.0);
        println!("{links} links: energy {:.1e} {:?}", figures.energy, figures.open);
        // measured 4.3e-2 and 3.2e-3
        assert!(figures.energy <= bound);
        assert!(figures.open.at_most(position, velocity), "{:?}", figures.open);
    }
}

/// A top of 0.3 m at 300 rad/s about its axis: at h = 1e-2 it turns 3 rad a step, where Moser-Veselov has no solution.
#[test]
fn the_cayley_rule_runs_a_fast_top_at_any_step_and_has_order_two() {
    let mut scene = chain(&[(Spherical, Vector3::x())]);
    scene.initial[0].position = vec![0.0, -1.2, 0.0];
    let axis: Vector3<f64> = nalgebra::Rotation3::new(Vector3::new(0.0, -1.2, 0.0)) * Vector3::x();
    scene.initial[0].velocity = (axis * 300.0).as_slice().to_vec();
    let system = compile(&scene);
    let error = |h: f64| {
        let mut rattle = Rattle::new(&system).unwrap().with_rotation(Rotation::Cayley);
        let mut state = system.initial.clone();
        let start = energy::energy(&system, &state).total();
        let mut worst = 0.0_f64;
        for _ in 0..(1.0 / h).round() as usize {
            rattle.step(h).unwrap();
            rattle.write_state(&mut state);
            worst = worst.max((energy::energy(&system, &state).total() - start).abs() / system.energy_scale);
        }
        worst
    };
    let points: Vec<_> = [1e-3, 5e-4, 2.5e-4, 1.25e-4].into_iter().map(|h| (h, error(h))).collect();
    let (order, long) = (slope(&points), error(1e-2));
    println!("order {order:.2}, {points:?}, at 1e-2 {long:.1e}");
    assert!((order - 2.0).abs() <= 0.1);
    assert!(long <= 0.1);
    let mut proper = Rattle::new(&system).unwrap();
    assert!(matches!(proper.step(1e-2), Err(Failure::Rotation { .. })));
}

#[test]
fn a_state_that_is_not_a_number_is_refused_by_name() {
    for (system, body) in [(compile(&alternating(3)), 1), (tumbling(9.81), 0)] {
        let mut state = system.initial.clone();
        state.bodies[body].velocity.x = f64::NAN;
        let mut rattle = Rattle::from_state(&system, &state).unwrap();
        let failure = rattle.step(1e-3).unwrap_err();
        assert!(matches!(failure, Failure::NotFinite { .. } | Failure::Rotation { .. }), "{failure:?}");
    }
}
