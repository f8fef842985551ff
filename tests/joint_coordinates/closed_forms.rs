//! Motions whose closed form is known, against the reference, the engines in joint coordinates and `rattle`.

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};
use rattlebench::engines::reference::trajectory;
use rattlebench::mechanics::coordinates::{JointCoordinates, joint_coordinates};
use rattlebench::mechanics::{State, System};
use rattlebench::model::{Base, Inertial, JointKind};

use crate::common::*;

/// Complete elliptic integral of the first kind of modulus `k` by the arithmetic-geometric mean: `K = pi / (2 M(1, k'))`.
fn complete_elliptic(k: f64) -> f64 {
    let (mut a, mut b) = (1.0f64, (1.0 - k * k).sqrt());
    while (a - b).abs() > 1e-15 * a {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    std::f64::consts::PI / (a + b)
}

/// `sn, cn, dn` of `u` and modulus `k` by descending Landen transformations (Abramowitz and Stegun, section 16.4).
fn jacobi(u: f64, k: f64) -> (f64, f64, f64) {
    let (mut a, mut b, mut c) = (vec![1.0f64], (1.0 - k * k).sqrt(), vec![k]);
    while c[c.len() - 1].abs() > 1e-16 {
        let last = a[a.len() - 1];
        c.push(0.5 * (last - b));
        (b, _) = ((last * b).sqrt(), a.push(0.5 * (last + b)));
    }
    let n = a.len() - 1;
    let mut phi = 2f64.powi(n as i32) * a[n] * u;
    let mut before = phi;
    for i in (1..=n).rev() {
        before = phi;
        phi = 0.5 * (phi + (c[i] / a[i] * phi.sin()).asin());
    }
    let dn = if n == 0 { 1.0 } else { phi.cos() / (before - phi).cos() };
    (phi.sin(), phi.cos(), dn)
}

fn coordinates(system: &System, state: &State) -> Vec<JointCoordinates> {
    let mut joints = vec![JointCoordinates::default(); system.bodies.len()];
    joint_coordinates(system, state, &mut joints);
    joints
}

/// A rod released at rest at an angle from hanging, with `omega0^2 = m g l / J`, has the period `4 K(sin(angle/2)) / omega0`.
#[test]
fn the_pendulum_returns_after_the_period_of_the_elliptic_integral() {
    for degrees in [30.0f64, 60.0, 90.0, 120.0, 150.0, 170.0, 179.0] {
        let angle = degrees.to_radians();
        let mut scene = chain(&[(JointKind::Revolute, Vector3::y())]);
        // At position 0 the rod is horizontal; about y it hangs at pi/2.
        scene.initial[0].position = vec![std::f64::consts::FRAC_PI_2 - angle];
        let system = compile(&scene);
        let inertia = rod().inertia[(1, 1)] + 0.15 * 0.15;
        let period = 4.0 * complete_elliptic((0.5 * angle).sin()) / (9.81 * 0.15 / inertia).sqrt();
        let start = scene.initial[0].position[0];
        let error = |state: &State| {
            let joint = coordinates(&system, state)[0];
            let wrapped = (joint.position[0] - start).rem_euclid(std::f64::consts::TAU);
            (wrapped.min(std::f64::consts::TAU - wrapped), joint.velocity[0].abs())
        };
        let half = trajectory(&system, &[0.5 * period, period]).unwrap();
        let (reference, galerkin) =
            (error(&half.states[1]), error(&run_engine("galerkin:stages=8", &system, period / 40.0, 40)));
        let rattle = error(&run_engine("rattle:order=8", &system, period / 1000.0, 1000));
        let across = coordinates(&system, &half.states[0])[0].position[0] - (start + 2.0 * angle);
        println!("{degrees}: {reference:?} {galerkin:?} {rattle:?} across {across:.1e}");
        // measured at most 5.3e-13 rad and 9.6e-12 rad/s (at 179 degrees), galerkin 2.8e-14 and 4.8e-13, rattle 4.0e-15 and
        // 8.3e-14
        assert!(reference.0 <= 1.5e-12 && reference.1 <= 2.5e-11, "{degrees}: {reference:?}");
        assert!(galerkin.0 <= 8e-14 && galerkin.1 <= 1.4e-12, "{degrees}: {galerkin:?}");
        assert!(rattle.0 <= 1e-14 && rattle.1 <= 2.5e-13, "{degrees}: {rattle:?}");
        let turns = (across / std::f64::consts::TAU).round();
        assert!((across - turns * std::f64::consts::TAU).abs() <= 1.5e-12, "{degrees}: {across:e}");
    }
}

/// A free body with the given moments of inertia, turning without gravity.
fn free_body(moments: [f64; 3], omega: Vector3<f64>) -> System {
    let mut scene = chain(&[]);
    let inertia = Matrix3::from_diagonal(&Vector3::from(moments));
    scene.model.links[0].inertial = Some(Inertial { mass: 1.0, com: Vector3::zeros(), inertia });
    scene.gravity = Vector3::zeros();
    let (pose, linear_velocity) = (Isometry3::identity(), Vector3::new(0.1, -0.2, 0.3));
    scene.base = Base::Floating { pose, linear_velocity, angular_velocity: omega };
    compile(&scene)
}

fn body_rates(state: &State) -> Vector3<f64> {
    state.bodies[0].attitude.inverse_transform_vector(&state.bodies[0].angular_velocity)
}

/// Euler's equations from `omega = (a, 0, c)` with `J1 > J2 > J3` and the motion about the first axis (Landau and Lifshitz,
/// Mechanics, section 37): `omega = (a dn, -b sn, c cn)` of `p t`.
#[test]
fn the_free_rigid_body_turns_by_jacobi_functions() {
    let [j1, j2, j3] = [0.03, 0.02, 0.01f64];
    let (a, c) = (5.0, 3.0);
    let system = free_body([j1, j2, j3], Vector3::new(a, 0.0, c));
    // (dn' = -k^2 sn cn, sn' = cn dn, cn' = -sn dn) in Euler's equations fixes b, p and k.
    let b = c * (j3 * (j1 - j3) / (j2 * (j1 - j2))).sqrt();
    let p = a * ((j1 - j2) * (j1 - j3) / (j2 * j3)).sqrt();
    let k = (c / a) * (j3 * (j2 - j3) / (j1 * (j1 - j2))).sqrt();
    let closed = |t: f64| {
        let (sn, cn, dn) = jacobi(p * t, k);
        Vector3::new(a * dn, -b * sn, c * cn)
    };
    // The closed form satisfies Euler's equations: by differences.
    let slope = (closed(0.3 + 1e-5) - closed(0.3 - 1e-5)) / 2e-5;
    let w = closed(0.3);
    let momentum = Vector3::new(j1 * w.x, j2 * w.y, j3 * w.z);
    let expected = momentum.cross(&w).component_div(&Vector3::new(j1, j2, j3));
    assert!((slope - expected).norm() <= 1e-7, "{slope} {expected}");

    let times = [0.5, 1.0, 2.0, 5.0];
    let found = trajectory(&system, &times).unwrap();
    for (time, state) in times.iter().zip(&found.states) {
        let error = (body_rates(state) - closed(*time)).norm();
        let way = (state.bodies[0].position - Vector3::new(0.1, -0.2, 0.3) * *time).norm();
        let galerkin = run_engine("galerkin:stages=6", &system, 0.02, (time / 0.02).round() as usize);
        let rival = (body_rates(&galerkin) - closed(*time)).norm();
        let rattle = run_engine("rattle:order=8", &system, 0.005, (time / 0.005).round() as usize);
        let own = (body_rates(&rattle) - closed(*time)).norm();
        println!("{time}: reference {error:.1e} {way:.1e} galerkin {rival:.1e} rattle {own:.1e}");
        // measured at most 1.2e-13, 1.8e-13, 1.4e-14 and 1.5e-14
        assert!(error <= 3e-13 && way <= 5e-13 && rival <= 4e-14, "{time}: {error:e} {way:e} {rival:e}");
        assert!(own <= 4e-14, "{time}: {own:e}");
    }
}

/// The symmetric free body precesses at constant rate: its attitude is a product of two rotations.
#[test]
fn the_symmetric_free_body_precesses_uniformly() {
    let [j, j3] = [0.02, 0.035];
    let omega = Vector3::new(1.0, 0.5, 6.0);
    let system = free_body([j, j, j3], omega);
    let momentum = Vector3::new(j * omega.x, j * omega.y, j3 * omega.z);
    let time = 3.0;
    // R(t) = exp(t L / J) exp(t omega3 (1 - J3 / J) e3)
    let expected = UnitQuaternion::from_scaled_axis(momentum / j * time)
        * UnitQuaternion::from_scaled_axis(Vector3::z() * (omega.z * (1.0 - j3 / j) * time));
    let reference = trajectory(&system, &[time]).unwrap();
    let galerkin = run_engine("galerkin:stages=6", &system, 0.02, 150);
    let rattle = run_engine("rattle:order=8", &system, 0.005, 600);
    for (name, state) in [("reference", &reference.states[0]), ("galerkin", &galerkin), ("rattle", &rattle)] {
        let error = state.bodies[0].attitude.angle_to(&expected);
        println!("{name} {error:.1e}");
        // measured 1.3e-14, 9.6e-15 and 1.6e-15
        assert!(error <= 4e-14, "{name}: {error:e}");
    }
}

/// A symmetric top on a ball joint keeps its energy, its angular momentum about the vertical and the one about its own axis.
#[test]
fn the_lagrange_top_keeps_its_three_integrals() {
    let mut scene = chain(&[(JointKind::Spherical, Vector3::x())]);
    let (mass, height, j, j3) = (0.8, 0.12, 0.004, 0.006);
    scene.model.links[1].inertial = Some(Inertial {
        mass,
        com: Vector3::new(0.0, 0.0, height),
        inertia: Matrix3::from_diagonal(&Vector3::new(j, j, j3)),
    });
    scene.initial[0].position = vec![0.5, 0.0, 0.0];
    scene.initial[0].velocity = vec![0.3, -10.0, 20.0];
    let system = compile(&scene);
    let integrals = |state: &State| {
        let body = &state.bodies[0];
        let rates = body_rates(state);
        let spin = body.attitude * Vector3::new(j * rates.x, j * rates.y, j3 * rates.z);
        let about_point = spin + body.position.cross(&(body.velocity * mass));
        let kinetic = 0.5 * mass * body.velocity.norm_squared() + 0.5 * spin.dot(&body.angular_velocity);
        [kinetic + mass * 9.81 * body.position.z, about_point.z, about_point.dot(&(body.attitude * Vector3::z()))]
    };
    let start = integrals(&system.initial);
    let times = [1.0, 2.0, 5.0];
    let mut states = trajectory(&system, &times).unwrap().states;
    states.push(run_engine("galerkin:stages=6", &system, 0.01, 500));
    states.push(run_engine("rattle:order=8", &system, 0.002, 2500));
    let moved = (states[0].bodies[0].position - system.initial.bodies[0].position).norm();
    assert!(moved > 0.01, "{moved}");
    for state in &states {
        let now = integrals(state);
        let errors: Vec<f64> = now.iter().zip(&start).map(|(a, b)| ((a - b) / b).abs()).collect();
        println!("{errors:?}");
        // measured at most 2.4e-14
        assert!(errors.iter().all(|&e| e <= 7e-14), "{errors:?}");
    }
}

/// A slider on a vertical rail falls by `g t^2 / 2`; with a damper it nears the speed `m g / c` exponentially.
#[test]
fn a_damped_slider_falls_by_the_textbook() {
    for damping in [0.0, 2.0] {
        let mut scene = chain(&[(JointKind::Prismatic, Vector3::z())]);
        scene.model.joints[0].damping = damping;
        let system = compile(&scene);
        let time = 1.5f64;
        let expected = match damping {
            0.0 => -0.5 * 9.81 * time * time,
            c => -9.81 / c * (time - (1.0 - (-c * time).exp()) / c),
        };
        let reference = trajectory(&system, &[time]).unwrap();
        let galerkin = run_engine("galerkin:stages=6", &system, 0.05, 30);
        let rattle = run_engine("rattle", &system, 1e-3, 1500);
        for (name, state) in [("reference", &reference.states[0]), ("galerkin", &galerkin), ("rattle", &rattle)] {
            let error = coordinates(&system, state)[0].position[0] - expected;
            println!("{name} {damping} {error:.1e}");
            // measured at most 1.2e-14, and 1.2e-7 of `rattle` with the damper, where it has order 2
            let bound = if name == "rattle" && damping > 0.0 { 3e-7 } else { 3e-14 };
            assert!(error.abs() <= bound, "{name} {damping}: {error:e}");
        }
    }
}
