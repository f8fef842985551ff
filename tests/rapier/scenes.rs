//! Scenes that together hold every kind of joint, none of them aligned with anything, and the scenes that are shipped.

use nalgebra::{Isometry3, Matrix3, Rotation3, Unit, Vector3};
use rattlebench::engines::{self, Spec};
use rattlebench::mechanics::{Anchor, Drive, JointSpring, PointSpring, System};
use rattlebench::model::scene::JointInitial;
use rattlebench::model::{Base, Inertial, Joint, JointKind, Link, Model, Scene};

use crate::common;

/// Parent link (0 is the base) and kind of each joint.
type Tree = [(usize, JointKind)];

/// Every scene, with positions and velocities that are not zero.
pub fn all() -> Vec<System> {
    use JointKind::{Continuous, Floating, Planar, Prismatic, Revolute, Spherical};
    vec![
        moving("pendulum", false, &[(0, Revolute)]),
        moving("cart-pole", false, &[(0, Prismatic), (1, Continuous)]),
        moving("chain", false, &[(0, Revolute), (1, Continuous), (2, Revolute), (3, Revolute)]),
        moving("heavy top", false, &[(0, Spherical)]),
        moving("table", false, &[(0, Planar), (1, Revolute)]),
        moving("every joint", false, &[(0, Revolute), (1, Spherical), (2, Planar), (1, Prismatic), (4, Spherical)]),
        moving("free body", true, &[]),
        moving("torso", true, &[(0, Revolute), (1, Revolute), (0, Spherical), (3, Prismatic)]),
        moving("two trees", false, &[(0, Revolute), (1, Revolute), (0, Spherical), (3, Revolute)]),
        moving("thrown off", false, &[(0, Revolute), (1, Floating), (2, Revolute)]),
    ]
}

/// The scenes under `models/` that rapier has means for, in the order of their names.
pub fn shipped() -> Vec<System> {
    let builds =
        |text: &str, system: &System| engines::build(&Spec::parse(text).expect("a spec"), system, 1e-3).is_ok();
    let can = |system: &System| ["rapier", "rapier:joints=multibody"].iter().all(|text| builds(text, system));
    common::shipped_scenes().iter().map(common::compile).filter(can).collect()
}

/// Those and these.
pub fn all_and_shipped() -> Vec<System> {
    all().into_iter().chain(shipped()).collect()
}

/// One of them, by its name.
pub fn named(name: &str) -> System {
    all().into_iter().find(|system| system.name == name).expect("there is such a scene")
}

/// The same system, starting at rest.
pub fn at_rest(system: &System) -> System {
    let mut still = system.clone();
    for (state, theta) in still.initial.bodies.iter_mut().zip(&mut still.initial_coordinates) {
        (state.velocity, state.angular_velocity) = (Vector3::zeros(), Vector3::zeros());
        theta.velocity = [0.0; 6];
    }
    still
}

/// The same system with this damping in every joint but the floating ones.
pub fn damped(system: &System, damping: f64) -> System {
    let mut damped = system.clone();
    let joints = damped.bodies.iter_mut().map(|body| &mut body.joint);
    for joint in joints.filter(|joint| joint.kind != rattlebench::mechanics::JointKind::Floating) {
        joint.damping = damping;
    }
    damped
}

/// The same system with a damped spring and two drives in every joint of one coordinate.
pub fn sprung_and_driven(system: &System) -> System {
    let mut sprung = system.clone();
    for body in 0..system.bodies.len() {
        if system.bodies[body].joint.kind.degrees_of_freedom() != 1 {
            continue;
        }
        let rest = system.initial_coordinates[body].position[0] + 0.8;
        sprung.parts.joint_springs.push(JointSpring { body, stiffness: 0.4, damping: 0.01, rest });
        let drive = |effort, amplitude| Drive { body, effort, amplitude, angular_frequency: 9.0, phase: 0.6 };
        sprung.parts.drives.extend([drive(0.1, 0.0), drive(0.0, -0.3)]);
    }
    sprung
}

/// The same system with joint springs of at most 20 N m/rad or N/m, which the steps of these tests resolve.
pub fn softened(system: &System) -> System {
    let mut soft = system.clone();
    for spring in &mut soft.parts.joint_springs {
        spring.stiffness = spring.stiffness.min(20.0);
    }
    soft
}

/// The same system with a damped spring from the ground to every body, and one between the first and the last.
pub fn hung_on_springs(system: &System) -> System {
    let mut hung = system.clone();
    let anchor = |body: Option<usize>, i: usize| Anchor { body, point: vector(i, 0.3, 0.4) };
    let last = system.bodies.len() - 1;
    let pairs = (0..=last).map(|i| (None, Some(i))).chain((last > 0).then_some((Some(0), Some(last))));
    hung.parts.point_springs = pairs
        .enumerate()
        .map(|(i, (from, to))| PointSpring {
            from: anchor(from, i),
            to: anchor(to, i + 3),
            stiffness: 3.0,
            damping: 0.05,
            rest_length: 0.1,
        })
        .collect();
    hung
}

fn moving(name: &str, floating: bool, tree: &Tree) -> System {
    let links = (0..=tree.len()).map(|i| Link {
        name: format!("link_{i}"),
        inertial: (i > 0 || floating).then(|| inertial(i)),
        collisions: vec![],
    });
    let joints = tree.iter().enumerate().map(|(i, &(parent, kind))| Joint {
        name: format!("joint_{}", i + 1),
        kind,
        parent,
        child: i + 1,
        origin: Isometry3::new(vector(i, 0.2, 0.1), vector(i, 0.7, 2.1)),
        axis: Unit::new_normalize(vector(i, 1.0, 0.4)),
        damping: 0.0,
        friction: 0.0,
        mimic: None,
    });
    let initial = tree.iter().enumerate().map(|(i, (_, kind))| {
        let values = |scale: f64, phase: f64| {
            (0..kind.degrees_of_freedom()).map(|k| scale * (1.3 * (i + k) as f64 + phase).cos()).collect()
        };
        JointInitial { position: values(0.6, 0.2), velocity: values(1.5, 0.9), ..JointInitial::default() }
    });
    let base = if floating {
        Base::Floating {
            pose: Isometry3::new(Vector3::new(0.4, -0.3, 1.0), Vector3::new(0.5, 0.2, -0.4)),
            linear_velocity: Vector3::new(0.3, 0.8, -0.2),
            angular_velocity: Vector3::new(1.0, -2.0, 0.7),
        }
    } else {
        Base::Fixed
    };
    let model =
        Model { name: name.into(), links: links.collect(), joints: joints.collect(), ignored: vec![], remarks: vec![] };
    common::compile(&Scene {
        gravity: Vector3::new(1.0, -2.0, -9.0),
        base,
        initial: initial.collect(),
        duration: 1.0,
        steps: vec![1e-3],
        ..Scene::of_model(name, model)
    })
}

/// A different vector of length about `scale` for each `i`.
fn vector(i: usize, scale: f64, phase: f64) -> Vector3<f64> {
    let angle = 1.7 * i as f64 + phase;
    scale * Vector3::new(angle.cos(), (1.3 * angle).sin(), (0.7 * angle).cos())
}

/// A box turned out of the link's axes.
fn inertial(i: usize) -> Inertial {
    let mass = 0.8 + 0.3 * i as f64;
    let moments = mass * Vector3::new(0.011, 0.017, 0.023);
    let turn = Rotation3::new(vector(i, 0.9, 0.5));
    let inertia = turn * Matrix3::from_diagonal(&moments) * turn.transpose();
    Inertial { mass, com: vector(i, 0.12, 1.0), inertia: 0.5 * (inertia + inertia.transpose()) }
}
