//! Models built in code, and those that are shipped.

use nalgebra::{Isometry3, Matrix3, Unit, Vector3};
use rattlebench::mechanics::System;
use rattlebench::model::JointKind::{Prismatic, Revolute, Spherical};
use rattlebench::model::{Inertial, Joint, JointKind, Link, Model, Scene};

/// A rod of 0.3 m and 1 kg along x, its frame at one end.
pub fn rod() -> Inertial {
    let (mass, length, radius) = (1.0, 0.3, 0.02);
    let across = mass * (3.0 * radius * radius + length * length) / 12.0;
    Inertial {
        mass,
        com: Vector3::new(0.5 * length, 0.0, 0.0),
        inertia: Matrix3::from_diagonal(&Vector3::new(0.5 * mass * radius * radius, across, across)),
    }
}

/// A chain of such rods from the ground, one joint for each entry.
pub fn chain(joints: &[(JointKind, Vector3<f64>)]) -> Scene {
    let link = |name: String, inertial| Link { name, inertial, collisions: vec![] };
    let mut links = vec![link("base".into(), None)];
    let mut list = Vec::new();
    for (i, (kind, axis)) in joints.iter().enumerate() {
        links.push(link(format!("link_{}", i + 1), Some(rod())));
        list.push(Joint {
            name: format!("joint_{}", i + 1),
            kind: *kind,
            parent: i,
            child: i + 1,
            origin: Isometry3::translation(if i == 0 { 0.0 } else { 0.3 }, 0.0, 0.0),
            axis: Unit::new_normalize(*axis),
            damping: 0.0,
            friction: 0.0,
            mimic: None,
        });
    }
    let model = Model { name: "chain".into(), links, joints: list, ignored: vec![], remarks: vec![] };
    Scene { steps: vec![1e-3], ..Scene::of_model("chain", model) }
}

/// A chain whose hinges are about y and z in turn.
pub fn alternating(n: usize) -> Scene {
    let axes: Vec<_> =
        (0..n).map(|i| (JointKind::Revolute, if i % 2 == 0 { Vector3::y() } else { Vector3::z() })).collect();
    chain(&axes)
}

pub fn compile(scene: &Scene) -> System {
    System::compile(scene).expect("the scene compiles")
}

/// A spatial chain of five links with revolute, spherical and prismatic joints.
pub fn five_links() -> System {
    let mut scene = chain(&[
        (Revolute, Vector3::y()),
        (Spherical, Vector3::x()),
        (Revolute, Vector3::new(0.0, 1.0, 1.0)),
        (Prismatic, Vector3::new(0.0, 1.0, 0.3)),
        (Revolute, Vector3::z()),
    ]);
    scene.initial[1].position = vec![0.3, -0.2, 0.5];
    scene.initial[3].velocity = vec![0.2];
    scene.initial[4].position = vec![0.8];
    compile(&scene)
}

/// Two points of 1 kg on massless rods of 1 m, released at rest from horizontal, g = 9.81 m/s^2.
pub fn double_pendulum() -> System {
    let mut scene = chain(&[(Revolute, Vector3::y()); 2]);
    for link in &mut scene.model.links[1..] {
        let inertial = link.inertial.as_mut().unwrap();
        (inertial.com, inertial.inertia) = (Vector3::x(), Matrix3::zeros());
    }
    scene.model.joints[1].origin = Isometry3::translation(1.0, 0.0, 0.0);
    compile(&scene)
}

/// A scene that is shipped, by the name of its folder.
pub fn shipped_scene(name: &str) -> Scene {
    let path = format!("{}/models/{name}/scene.json", env!("CARGO_MANIFEST_DIR"));
    Scene::load(path).unwrap_or_else(|e| panic!("{e}"))
}

pub fn shipped(name: &str) -> System {
    compile(&shipped_scene(name))
}

/// All scenes that are shipped, in the order of their names: one of each folder under `models/`.
pub fn shipped_scenes() -> Vec<Scene> {
    let folders = std::fs::read_dir(format!("{}/models", env!("CARGO_MANIFEST_DIR"))).expect("models");
    let mut names: Vec<String> =
        folders.map(|entry| entry.expect("readable").file_name().into_string().expect("UTF-8")).collect();
    names.sort();
    assert!(!names.is_empty());
    names.iter().map(|name| shipped_scene(name)).collect()
}
