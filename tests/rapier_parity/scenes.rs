//! Scenes that together hold every kind of joint, none of them aligned with anything, and the scenes that are shipped.

use nalgebra::{Isometry3, Matrix3, Rotation3, Unit, Vector3};
use rattlebench::mechanics::System;
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

/// The scenes under `models/`, in the order of their names.
pub fn shipped() -> Vec<System> {
    let models = concat!(env!("CARGO_MANIFEST_DIR"), "/models");
    let folders = std::fs::read_dir(models).expect("models are shipped").map(|entry| entry.expect("readable").path());
    let mut scenes: Vec<_> = folders.map(|folder| folder.join("scene.json")).filter(|path| path.is_file()).collect();
    scenes.sort();
    assert!(!scenes.is_empty());
    scenes.iter().map(|path| common::compile(&Scene::load(path).expect("a shipped scene can be read"))).collect()
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
