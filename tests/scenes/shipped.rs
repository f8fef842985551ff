//! The shipped scenes: each loads, compiles, describes itself and moves.

use rattlebench::mechanics::System;
use rattlebench::model::JointKind;
use rattlebench::model::generate::Chain;

use crate::common::{shipped_scene, shipped_scenes};

#[test]
fn every_scene_compiles_and_holds_energy_to_exchange() {
    for scene in shipped_scenes() {
        let system = System::compile(&scene).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
        assert!(system.energy_scale > 1e-3, "{}: {} J", scene.name, system.energy_scale);
        assert!(!scene.description.is_empty(), "{}", scene.name);
        assert!(scene.steps.len() >= 4, "{}", scene.name);
    }
}

#[test]
fn the_ten_link_chain_is_what_generate_prints() {
    let file = std::fs::read_to_string("models/chain_10/chain_10.urdf").unwrap();
    assert_eq!(file, Chain { links: 10, ..Chain::default() }.urdf().unwrap());
}

#[test]
fn the_joint_zoo_has_every_joint_type() {
    let zoo = shipped_scene("joint_zoo");
    for kind in JointKind::ALL {
        assert!(zoo.model.joints.iter().any(|j| j.kind == kind), "{}", kind.name());
    }
}

/// A symmetric chain released in its plane of symmetry stays there: half of its hinges would never turn.
#[test]
fn chains_of_alternating_hinges_do_not_start_in_a_plane_of_symmetry() {
    for name in ["double_pendulum", "chain_10"] {
        let scene = shipped_scene(name);
        let sideways = scene.model.joints.iter().zip(&scene.initial).filter(|(j, _)| j.axis.z > 0.5);
        assert!(sideways.map(|(_, initial)| initial.position[0]).all(|angle| angle != 0.0), "{name}");
    }
}
