//! Compiles a scene into a system: welds fixed joints, puts every body into its principal frame and every joint into
//! its own frame, and places the bodies at the initial coordinates.

use nalgebra::{Isometry3, Matrix3, Rotation3, SymmetricEigen, Translation3, UnitQuaternion, Vector3};

use super::coordinates::{JointCoordinates, forward_kinematics};
use super::{Body, FloatingBase, Joint, JointKind, System, energy};
use crate::model::{self, Base, Model, Scene};

/// Why a scene cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompileError {
    #[error(
        "scene '{scene}': link '{link}' moves on joint '{joint}' but has no mass; give it an <inertial>, weld it by a \
         fixed joint to a link that has one, or set \"density\" in the scene"
    )]
    Massless { scene: String, link: String, joint: String },
    #[error(
        "scene '{scene}': link '{link}' moves on joint '{joint}' but its smallest principal moment of inertia is \
         {moment:e} kg m^2; give it an <inertia> with three positive principal moments"
    )]
    NoInertia { scene: String, link: String, joint: String, moment: f64 },
    #[error("scene '{scene}': joint '{joint}': damping {damping} on a floating joint is not simulated; set it to 0")]
    FloatingDamping { scene: String, joint: String, damping: f64 },
    #[error("scene '{scene}': nothing moves; every link is fixed to the ground")]
    NothingMoves { scene: String },
}

impl System {
    /// Compiles a scene.
    ///
    /// # Errors
    /// A body that moves without mass or inertia, damping on a floating joint, or a scene in which nothing moves.
    pub fn compile(scene: &Scene) -> Result<System, CompileError> {
        let welded = weld(&scene.model);
        let ground = usize::from(matches!(scene.base, Base::Fixed));
        let frames: Vec<Principal> = welded.assemblies.iter().map(|a| principal(&scene.model, a)).collect();
        let mut bodies = Vec::with_capacity(frames.len());
        let mut coordinates = Vec::with_capacity(frames.len());
        for (assembly, frame) in welded.assemblies.iter().zip(&frames).skip(ground) {
            let (joint, theta) = match assembly.joint {
                Some(j) => tree_joint(scene, j, &welded, &frames, ground),
                None => base_joint(&scene.base, frame),
            };
            let name = scene.model.links[assembly.top].name.clone();
            check(scene, &name, &joint, frame)?;
            bodies.push(Body { name, mass: frame.mass, inertia: frame.moments, joint });
            coordinates.push(theta);
        }
        if bodies.is_empty() {
            return Err(CompileError::NothingMoves { scene: scene.name.clone() });
        }
        let floating_base =
            (ground == 0).then(|| FloatingBase { body: 0, link_in_body: frames[0].body_in_assembly.inverse() });
        let initial = forward_kinematics(&bodies, &coordinates);
        let energy_scale = energy::scale(&bodies, &scene.gravity, &initial);
        Ok(System {
            name: scene.name.clone(),
            bodies,
            gravity: scene.gravity,
            initial,
            initial_coordinates: coordinates,
            energy_scale,
            floating_base,
        })
    }

    /// Number of coordinates that the joints leave free.
    pub fn degrees_of_freedom(&self) -> usize {
        self.bodies.iter().map(|b| b.joint.kind.degrees_of_freedom()).sum()
    }
}

/// Links that fixed joints hold together. Its frame is that of its link nearest to the root.
struct Assembly {
    top: usize,
    /// The model's joint above the top link, `None` for the root's assembly.
    joint: Option<usize>,
    /// Each link with its pose in the assembly's frame.
    links: Vec<(usize, Isometry3<f64>)>,
}

/// A model's links, grouped: the root's group first, and a parent's group before its child's.
struct Welded {
    assemblies: Vec<Assembly>,
    /// For each link its group and its pose in the group's frame.
    places: Vec<(usize, Isometry3<f64>)>,
}

fn weld(model: &Model) -> Welded {
    let mut places = vec![(0, Isometry3::identity()); model.links.len()];
    let mut assemblies = vec![Assembly { top: 0, joint: None, links: vec![(0, Isometry3::identity())] }];
    for (j, joint) in model.joints.iter().enumerate() {
        if joint.kind == model::JointKind::Fixed {
            let (group, pose) = places[joint.parent];
            places[joint.child] = (group, pose * joint.origin);
            assemblies[group].links.push((joint.child, pose * joint.origin));
        } else {
            places[joint.child] = (assemblies.len(), Isometry3::identity());
            let links = vec![(joint.child, Isometry3::identity())];
            assemblies.push(Assembly { top: joint.child, joint: Some(j), links });
        }
    }
    Welded { assemblies, places }
}

/// Mass properties of an assembly.
struct Principal {
    mass: f64,
    /// Principal moments, kg m^2.
    moments: Vector3<f64>,
    /// The body frame (centre of mass, principal axes) in the assembly's frame.
    body_in_assembly: Isometry3<f64>,
}

/// Adds up the links of an assembly (parallel axis theorem) and diagonalises the sum.
fn principal(model: &Model, assembly: &Assembly) -> Principal {
    let inertials =
        || assembly.links.iter().filter_map(|(link, pose)| model.links[*link].inertial.as_ref().map(|i| (i, pose)));
    let mass: f64 = inertials().map(|(i, _)| i.mass).sum();
    let weighted: Vector3<f64> =
        inertials().map(|(i, pose)| i.mass * (pose * nalgebra::Point3::from(i.com)).coords).sum();
    let com = if mass > 0.0 { weighted / mass } else { Vector3::zeros() };
    let inertia: Matrix3<f64> = inertials()
        .map(|(i, pose)| {
            let r = pose.rotation.to_rotation_matrix();
            let arm = (pose * nalgebra::Point3::from(i.com)).coords - com;
            r * i.inertia * r.transpose() + i.mass * (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose())
        })
        .sum();
    let (moments, axes) = diagonalise(&inertia);
    Principal { mass, moments, body_in_assembly: Isometry3::from_parts(Translation3::from(com), axes) }
}

/// Principal moments and the rotation from principal axes to the given axes. A tensor that is diagonal already keeps its
/// axes; moments that roundoff made negative become zero.
fn diagonalise(inertia: &Matrix3<f64>) -> (Vector3<f64>, UnitQuaternion<f64>) {
    let off_diagonal = inertia[(0, 1)].abs().max(inertia[(0, 2)].abs()).max(inertia[(1, 2)].abs());
    if off_diagonal <= 1e-14 * inertia.diagonal().amax() {
        return (inertia.diagonal().map(|j| j.max(0.0)), UnitQuaternion::identity());
    }
    let eigen = SymmetricEigen::new(*inertia);
    let mut axes = eigen.eigenvectors;
    if axes.determinant() < 0.0 {
        axes.column_mut(2).neg_mut();
    }
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    (eigen.eigenvalues.map(|j| j.max(0.0)), rotation)
}

/// A joint of the model between two assemblies, with its initial coordinates.
fn tree_joint(
    scene: &Scene,
    index: usize,
    welded: &Welded,
    frames: &[Principal],
    ground: usize,
) -> (Joint, JointCoordinates) {
    let joint = &scene.model.joints[index];
    let kind = match joint.kind {
        model::JointKind::Revolute | model::JointKind::Continuous => JointKind::Revolute,
        model::JointKind::Prismatic => JointKind::Prismatic,
        model::JointKind::Planar => JointKind::Planar,
        model::JointKind::Spherical => JointKind::Spherical,
        model::JointKind::Floating | model::JointKind::Fixed => JointKind::Floating,
    };
    let align = match kind {
        JointKind::Spherical | JointKind::Floating => Isometry3::identity(),
        _ => Isometry3::from_parts(Translation3::identity(), from_z_to(&joint.axis)),
    };
    let (above, parent_link) = welded.places[joint.parent];
    let (below, child_link) = welded.places[joint.child];
    let in_parent_assembly = parent_link * joint.origin * align;
    let parent = above.checked_sub(ground);
    let in_parent = match parent {
        Some(_) => frames[above].body_in_assembly.inverse() * in_parent_assembly,
        None => in_parent_assembly,
    };
    let in_child = frames[below].body_in_assembly.inverse() * child_link * align;
    let initial = &scene.initial[index];
    let compiled = Joint { name: joint.name.clone(), kind, parent, in_parent, in_child, damping: joint.damping };
    (compiled, padded(&initial.position, &initial.velocity))
}

/// The floating joint between the ground and a free root.
fn base_joint(base: &Base, frame: &Principal) -> (Joint, JointCoordinates) {
    let theta = match base {
        Base::Fixed => JointCoordinates::default(),
        Base::Floating { pose, linear_velocity: v, angular_velocity: w } => {
            let (x, r) = (pose.translation.vector, pose.rotation.scaled_axis());
            padded(&[x.x, x.y, x.z, r.x, r.y, r.z], &[v.x, v.y, v.z, w.x, w.y, w.z])
        }
    };
    let joint = Joint {
        name: "base".to_string(),
        kind: JointKind::Floating,
        parent: None,
        in_parent: Isometry3::identity(),
        in_child: frame.body_in_assembly.inverse(),
        damping: 0.0,
    };
    (joint, theta)
}

fn padded(position: &[f64], velocity: &[f64]) -> JointCoordinates {
    let fill = |values: &[f64]| std::array::from_fn(|i| values.get(i).copied().unwrap_or(0.0));
    JointCoordinates { position: fill(position), velocity: fill(velocity) }
}

/// The shortest rotation that turns z to the axis; half a turn about x where the axis is -z.
fn from_z_to(axis: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(&Vector3::z(), axis)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
}

fn check(scene: &Scene, link: &str, joint: &Joint, frame: &Principal) -> Result<(), CompileError> {
    let (scene, link, name) = (scene.name.clone(), link.to_string(), joint.name.clone());
    if frame.mass <= 0.0 {
        return Err(CompileError::Massless { scene, link, joint: name });
    }
    let moment = frame.moments.min();
    if moment <= 0.0 {
        return Err(CompileError::NoInertia { scene, link, joint: name, moment });
    }
    if joint.kind == JointKind::Floating && joint.damping > 0.0 {
        return Err(CompileError::FloatingDamping { scene, joint: name, damping: joint.damping });
    }
    Ok(())
}
