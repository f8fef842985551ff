//! Compiles a scene into a system: welds fixed joints, puts every body into its principal frame and every joint into
//! its own frame, and places the bodies at the initial coordinates.

use super::assemble::{Welded, weld};
use super::closing::{Closing, Given, Open};
use super::error::CompileError;
use super::joints::{base_joint, check, tree_joint};
use super::parts::BodyMap;
use super::principal::{Principal, principal};
use crate::mechanics::body::Body;
use crate::mechanics::coordinates::forward_kinematics;
use crate::mechanics::energy;
use crate::mechanics::joint::JointCoordinates;
use crate::mechanics::parts::Parts;
use crate::mechanics::system::{FloatingBase, System};
use crate::model::Scene;

impl System {
    /// Compiles a scene.
    ///
    /// # Errors
    /// A body that moves without mass or inertia, damping on a floating joint, or a scene in which nothing moves.
    pub fn compile(scene: &Scene) -> Result<System, CompileError> {
        let welded = weld(&scene.model);
        let ground = usize::from(!scene.base.is_floating());
        let frames: Vec<Principal> = welded.assemblies.iter().map(|a| principal(&scene.model, a)).collect();
        let Tree { bodies, mut coordinates, given } = tree(scene, &welded, &frames, ground)?;
        let floating_base =
            (ground == 0).then(|| FloatingBase { body: 0, link_in_body: frames[0].body_in_assembly.inverse() });
        let map = BodyMap { scene, welded: &welded, frames: &frames, ground };
        let parts = Parts {
            loops: map.loops()?,
            couplings: map.couplings()?,
            joint_springs: map.joint_springs(),
            point_springs: map.point_springs()?,
            drives: map.drives(),
        };
        let closing = Closing::new(&bodies, &parts);
        closing.close(&mut coordinates, &given).map_err(|open| stays_open(scene, &bodies, &parts, open))?;
        let mobility = closing.mobility(&coordinates);
        if mobility.degrees_of_freedom() == 0 {
            let (tree, rank) = (mobility.tree, mobility.rank);
            return Err(CompileError::NoMobility { scene: scene.name.clone(), tree, rank });
        }
        let initial = forward_kinematics(&bodies, &coordinates);
        let mut system = System {
            name: scene.name.clone(),
            mobility,
            parts,
            bodies,
            gravity: scene.gravity,
            initial,
            initial_coordinates: coordinates,
            energy_scale: 1.0,
            floating_base,
        };
        system.energy_scale = energy::scale(&system);
        Ok(system)
    }
}

/// Bodies with their joints, and the initial coordinates as far as the scene gives them.
struct Tree {
    bodies: Vec<Body>,
    coordinates: Vec<JointCoordinates>,
    given: Vec<Given>,
}

fn tree(scene: &Scene, welded: &Welded, frames: &[Principal], ground: usize) -> Result<Tree, CompileError> {
    let mut tree = Tree { bodies: Vec::new(), coordinates: Vec::new(), given: Vec::new() };
    for (assembly, frame) in welded.assemblies.iter().zip(frames).skip(ground) {
        let (joint, theta) = match assembly.joint {
            Some(j) => tree_joint(scene, j, welded, frames, ground),
            None => base_joint(&scene.base, frame),
        };
        let name = scene.model.links[assembly.top].name.clone();
        check(scene, &name, &joint, frame)?;
        tree.bodies.push(Body { name, mass: frame.mass, inertia: frame.moments, joint });
        tree.coordinates.push(theta);
        tree.given.push(assembly.joint.map_or(BASE_GIVEN, |j| {
            let initial = &scene.initial[j];
            Given { position: initial.position_given, velocity: initial.velocity_given }
        }));
    }
    if let Some(empty) = first_without_mass(&tree.bodies) {
        let (scene, link) = (scene.name.clone(), empty.name.clone());
        return Err(CompileError::Massless { scene, link, joint: empty.joint.name.clone() });
    }
    if tree.bodies.is_empty() {
        return Err(CompileError::NothingMoves { scene: scene.name.clone() });
    }
    Ok(tree)
}

/// The root of a floating scene is where the scene says.
const BASE_GIVEN: Given = Given { position: true, velocity: true };

/// The error for a loop or coupling that cannot be closed.
fn stays_open(scene: &Scene, bodies: &[Body], parts: &Parts, open: Open) -> CompileError {
    let what = |part: usize| match parts.loops.get(part) {
        Some(closure) => format!("loop '{}'", closure.name),
        None => {
            let coupling = &parts.couplings[part - parts.loops.len()];
            format!("the mimic of joint '{}'", bodies[coupling.follower].joint.name)
        }
    };
    let name = scene.name.clone();
    match open {
        Open::Position { part, by } => CompileError::StaysOpen { scene: name, what: what(part), by },
        Open::Velocity { part, by } => CompileError::Opens { scene: name, what: what(part), by },
    }
}

/// The first body with no mass in itself and in all that hangs on it.
fn first_without_mass(bodies: &[Body]) -> Option<&Body> {
    let mut behind: Vec<f64> = bodies.iter().map(|body| body.mass).collect();
    for i in (0..bodies.len()).rev() {
        if let Some(parent) = bodies[i].joint.parent {
            behind[parent] += behind[i];
        }
    }
    bodies.iter().zip(behind).find(|(_, mass)| !(*mass > 0.0)).map(|(body, _)| body)
}
