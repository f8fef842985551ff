//! The compiled system: welding, coordinates, residuals, energy.

use approx::assert_relative_eq;
use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use rattlebench::mechanics::coordinates::{CoordinateTracker, JointCoordinates, forward_kinematics, joint_coordinates};
use rattlebench::mechanics::{constraint, energy, momentum};
use rattlebench::model::JointKind::{self, *};
use rattlebench::model::{Base, Inertial};

use crate::common::*;

const KINDS: [JointKind; 6] = [Revolute, Continuous, Prismatic, Planar, Spherical, Floating];

proptest! {
    /// Coordinates to poses and back, on chains of all joint types about random axes.
    #[test]
    fn coordinates_come_back_from_the_poses_that_they_give(
        kinds in prop::collection::vec(0..KINDS.len(), 1..5),
        numbers in prop::collection::vec(-1.0..1.0f64, 60),
    ) {
        let mut number = numbers.into_iter().cycle();
        let mut next = || number.next().unwrap_or(0.3);
        let joints: Vec<_> =
            kinds.iter().map(|&k| (KINDS[k], Vector3::new(next(), next(), 1.1 + next()))).collect();
        let system = compile(&chain(&joints));
        let coordinates: Vec<JointCoordinates> = system
            .bodies
            .iter()
            .map(|body| {
                let count = body.joint.kind.degrees_of_freedom();
                let mut fill = || std::array::from_fn(|i| if i < count { next() } else { 0.0 });
                JointCoordinates { position: fill(), velocity: fill() }
            })
            .collect();
        let state = forward_kinematics(&system.bodies, &coordinates);
        let mut back = vec![JointCoordinates::default(); coordinates.len()];
        joint_coordinates(&system, &state, &mut back);
        for (given, found) in coordinates.iter().zip(&back) {
            for i in 0..6 {
                // measured at most 2e-15
                prop_assert!((given.position[i] - found.position[i]).abs() <= 6e-15, "{given:?} {found:?}");
                prop_assert!((given.velocity[i] - found.velocity[i]).abs() <= 2e-14, "{given:?} {found:?}");
            }
        }
        let residual = constraint::residual(&system, &state);
        prop_assert!(residual.position <= 5e-15 && residual.velocity <= 1e-14, "{residual:?}");
    }
}

#[test]
fn a_welded_pair_is_one_body_with_the_inertia_of_both() {
    let mut scene = chain(&[(Revolute, Vector3::y()), (Fixed, Vector3::x())]);
    scene.model.joints[1].origin =
        Isometry3::from_parts(Vector3::new(0.3, 0.0, 0.0).into(), UnitQuaternion::from_euler_angles(0.0, 0.0, 0.5));
    let system = compile(&scene);
    assert_eq!(system.bodies.len(), 1);
    let body = &system.bodies[0];
    assert_relative_eq!(body.mass, 2.0);
    // Both rods about the hinge by hand: J_yy and the products, by the parallel axis theorem.
    let about = |i: &Inertial, at: &Isometry3<f64>| {
        let r = at.rotation.to_rotation_matrix();
        let c = at * nalgebra::Point3::from(i.com);
        r * i.inertia * r.transpose()
            + i.mass * (Matrix3::identity() * c.coords.norm_squared() - c.coords * c.coords.transpose())
    };
    let expected = about(&rod(), &Isometry3::identity()) + about(&rod(), &scene.model.joints[1].origin);
    let r = body.joint.in_child.inverse();
    // The joint frame has the hinge axis y as its z axis: turn it back to the link's axes.
    let align = UnitQuaternion::rotation_between(&Vector3::z(), &Vector3::y()).unwrap();
    let to_link = (align * r.rotation).to_rotation_matrix();
    let c = align * r.translation.vector;
    let found = to_link * Matrix3::from_diagonal(&body.inertia) * to_link.transpose()
        + body.mass * (Matrix3::identity() * c.norm_squared() - c * c.transpose());
    assert_relative_eq!(found, expected, epsilon = 1e-15);
}

#[test]
fn a_hinge_that_turned_three_times_reads_six_pi() {
    let system = compile(&chain(&[(Revolute, Vector3::z())]));
    let mut tracker = CoordinateTracker::new(&system);
    let (rate, elapsed) = (25.0, 0.09);
    for n in 1..=100 {
        let mut theta = JointCoordinates::default();
        theta.position[0] = rate * elapsed * n as f64;
        theta.velocity[0] = rate;
        tracker.update(&system, &forward_kinematics(&system.bodies, &[theta]), elapsed);
        assert_relative_eq!(tracker.joints[0].position[0], theta.position[0], epsilon = 1e-12);
    }
}

#[test]
fn a_body_out_of_its_joint_shows_as_residual() {
    let system = compile(&alternating(3));
    let mut state = system.initial.clone();
    state.bodies[1].position.y += 1e-4;
    assert_relative_eq!(constraint::residual(&system, &state).position, 1e-4, epsilon = 1e-15);
    let mut state = system.initial.clone();
    state.bodies[2].attitude = UnitQuaternion::from_euler_angles(1e-3, 0.0, 0.0) * state.bodies[2].attitude;
    assert_relative_eq!(constraint::joint_residual(&system, &state, 2).position, 1e-3, epsilon = 1e-9);
    let mut state = system.initial.clone();
    state.bodies[0].velocity.x = 0.2;
    assert_relative_eq!(constraint::residual(&system, &state).velocity, 0.2, epsilon = 1e-15);
    state.bodies[0].velocity.x = f64::NAN;
    assert!(constraint::residual(&system, &state).velocity.is_nan());
}

#[test]
fn the_energy_of_a_hanging_and_of_a_turning_rod_is_that_of_the_textbook() {
    let mut scene = chain(&[(Revolute, Vector3::y())]);
    scene.initial[0].position = vec![std::f64::consts::FRAC_PI_2];
    scene.initial[0].velocity = vec![2.0];
    let system = compile(&scene);
    let found = energy::energy(&system, &system.initial);
    // U = -m g l / 2, K = 1/2 (J + m l^2 / 4) omega^2
    let about_hinge = rod().inertia[(1, 1)] + 0.15 * 0.15;
    assert_relative_eq!(found.potential, -9.81 * 0.15, epsilon = 1e-14);
    assert_relative_eq!(found.kinetic, 0.5 * about_hinge * 4.0, epsilon = 1e-14);
    assert_relative_eq!(system.energy_scale, 9.81 * 0.15, epsilon = 1e-14);
}

#[test]
fn momentum_is_reported_only_where_the_scene_conserves_it() {
    let names = |scene: &rattlebench::model::Scene| -> Vec<String> {
        momentum::conserved(&compile(scene)).into_iter().map(|c| c.name).collect()
    };
    assert!(names(&alternating(2)).is_empty());
    assert_eq!(names(&chain(&[(Revolute, Vector3::z())])), ["angular momentum about the axis of 'joint_1'"]);
    assert_eq!(names(&chain(&[(Prismatic, Vector3::x())])), ["linear momentum along the z axis of 'joint_1'"]);
    let mut damped = chain(&[(Revolute, Vector3::z())]);
    damped.model.joints[0].damping = 0.1;
    assert!(names(&damped).is_empty());
    let mut free = chain(&[]);
    free.model.links[0].inertial = Some(rod());
    free.base = Base::Floating {
        pose: Isometry3::identity(),
        linear_velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
    };
    // Gravity takes the linear momentum along z.
    assert_eq!(names(&free).len(), 5);
}
