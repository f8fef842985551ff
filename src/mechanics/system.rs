//! Compiles a scene into a system: welds fixed joints, puts every body into its principal frame and every joint into
//! its own frame, and places the bodies at the initial coordinates.

use nalgebra::{Isometry3, Matrix3, Rotation3, SymmetricEigen, Translation3, UnitQuaternion, Vector3};

use super::closing::{Closing, Given, Open};
use super::coordinates::{JointCoordinates, forward_kinematics};
use super::parts::{Anchor, Closure, Coupling, Drive, JointSpring, Parts, PointSpring};
use super::{Body, FloatingBase, Joint, JointKind, System, energy};
use crate::model::{self, Base, Model, Scene};

/// Why a scene cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompileError {
    #[error(
        "scene '{scene}': link '{link}' moves on joint '{joint}' but has no mass, nor has anything that hangs on it; give \
         it an <inertial>, weld it by a fixed joint to a link that has one, or set \"density\" in the scene"
    )]
    Massless { scene: String, link: String, joint: String },
    #[error(
        "scene '{scene}': link '{link}' moves on joint '{joint}' but its smallest principal moment of inertia is \
         {moment:e} kg m^2 and the others are not; give it an <inertia> with three positive principal moments, or with \
         none for a point mass"
    )]
    NoInertia { scene: String, link: String, joint: String, moment: f64 },
    #[error("scene '{scene}': joint '{joint}': damping {damping} on a floating joint is not simulated; set it to 0")]
    FloatingDamping { scene: String, joint: String, damping: f64 },
    #[error("scene '{scene}': nothing moves; every link is fixed to the ground")]
    NothingMoves { scene: String },
    #[error(
        "scene '{scene}': {what} connects two places of one rigid body ('{body}'); remove it, or free a joint between them"
    )]
    WithinOneBody { scene: String, what: String, body: String },
    #[error(
        "scene '{scene}': joint '{joint}' mimics joint '{source_joint}'; both must have one coordinate (revolute, \
         continuous or prismatic)"
    )]
    MimicCoordinates { scene: String, joint: String, source_joint: String },
    #[error(
        "scene '{scene}': {what} cannot be closed: {by:.3e} m or rad stay open at the nearest positions that were found; \
         leave a joint of the loop out of \"initial\", or check its geometry"
    )]
    StaysOpen { scene: String, what: String, by: f64 },
    #[error(
        "scene '{scene}': the initial velocities open {what} at {by:.3e} m/s or rad/s; leave the velocity of a joint of \
         the loop out of \"initial\""
    )]
    Opens { scene: String, what: String, by: f64 },
    #[error(
        "scene '{scene}': nothing can move: its loops take away {rank} of the tree's {tree} degrees of freedom where it \
         starts"
    )]
    NoMobility { scene: String, tree: usize, rank: usize },
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
        let mut given = Vec::with_capacity(frames.len());
        for (assembly, frame) in welded.assemblies.iter().zip(&frames).skip(ground) {
            let (joint, theta) = match assembly.joint {
                Some(j) => tree_joint(scene, j, &welded, &frames, ground),
                None => base_joint(&scene.base, frame),
            };
            let name = scene.model.links[assembly.top].name.clone();
            check(scene, &name, &joint, frame)?;
            bodies.push(Body { name, mass: frame.mass, inertia: frame.moments, joint });
            coordinates.push(theta);
            given.push(assembly.joint.map_or(BASE_GIVEN, |j| {
                let initial = &scene.initial[j];
                Given { position: initial.position_given, velocity: initial.velocity_given }
            }));
        }
        if let Some(empty) = first_without_mass(&bodies) {
            let (scene, link) = (scene.name.clone(), empty.name.clone());
            return Err(CompileError::Massless { scene, link, joint: empty.joint.name.clone() });
        }
        if bodies.is_empty() {
            return Err(CompileError::NothingMoves { scene: scene.name.clone() });
        }
        let floating_base =
            (ground == 0).then(|| FloatingBase { body: 0, link_in_body: frames[0].body_in_assembly.inverse() });
        let places = Places { scene, welded: &welded, frames: &frames, ground };
        let parts = Parts {
            loops: places.loops()?,
            couplings: places.couplings()?,
            joint_springs: places.joint_springs(),
            point_springs: places.point_springs()?,
            drives: places.drives(),
        };
        let closing = Closing::new(&bodies, &parts);
        closing.close(&mut coordinates, &given).map_err(|open| stays_open(scene, &bodies, &parts, open))?;
        let mobility = closing.mobility(&coordinates);
        if mobility.degrees_of_freedom() == 0 {
            return Err(CompileError::NoMobility {
                scene: scene.name.clone(),
                tree: mobility.tree,
                rank: mobility.rank,
            });
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

    /// Number of coordinates that joints, loops and couplings leave free at t = 0.
    pub fn degrees_of_freedom(&self) -> usize {
        self.mobility.degrees_of_freedom()
    }
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

/// Where links and joints of the model have gone.
struct Places<'a> {
    scene: &'a Scene,
    welded: &'a Welded,
    frames: &'a [Principal],
    /// Number of assemblies that are the ground: 0 or 1.
    ground: usize,
}

impl Places<'_> {
    /// The body that a link is part of, and a pose in the link's frame in that body's frame; for the ground in the world.
    fn place(&self, link: Option<usize>, pose: Isometry3<f64>) -> (Option<usize>, Isometry3<f64>) {
        let Some(link) = link else { return (None, pose) };
        let (assembly, link_pose) = self.welded.places[link];
        match assembly.checked_sub(self.ground) {
            Some(body) => (Some(body), self.frames[assembly].body_in_assembly.inverse() * link_pose * pose),
            None => (None, link_pose * pose),
        }
    }

    /// The child body of a joint that is not fixed.
    fn body_of(&self, joint: usize) -> usize {
        self.welded.places[self.scene.model.joints[joint].child].0 - self.ground
    }

    /// Refuses what connects a body with itself.
    fn between(&self, what: String, a: Option<usize>, b: Option<usize>) -> Result<(), CompileError> {
        if a != b {
            return Ok(());
        }
        let top = |body: usize| self.welded.assemblies[body + self.ground].top;
        let body = a.map_or("world", |body| &self.scene.model.links[top(body)].name).to_string();
        Err(CompileError::WithinOneBody { scene: self.scene.name.clone(), what, body })
    }

    fn loops(&self) -> Result<Vec<Closure>, CompileError> {
        let closure = |closure: &model::scene::Loop| {
            let align = Isometry3::from_parts(Translation3::identity(), from_z_to(&closure.axis));
            let (parent, in_parent) = self.place(closure.parent.link, closure.parent.origin * align);
            let (child, in_child) = self.place(closure.child.link, closure.child.origin * align);
            self.between(format!("loop '{}'", closure.name), parent, child)?;
            Ok(Closure { name: closure.name.clone(), kind: closure.kind, parent, child, in_parent, in_child })
        };
        self.scene.loops.iter().map(closure).collect()
    }

    fn couplings(&self) -> Result<Vec<Coupling>, CompileError> {
        let joints = &self.scene.model.joints;
        let mimics = joints.iter().enumerate().filter_map(|(j, joint)| joint.mimic.as_ref().map(|mimic| (j, mimic)));
        let coupling = |(j, mimic): (usize, &model::Mimic)| {
            if [j, mimic.source].iter().any(|&j| joints[j].kind.degrees_of_freedom() != 1) {
                let (scene, joint) = (self.scene.name.clone(), joints[j].name.clone());
                let source_joint = joints[mimic.source].name.clone();
                return Err(CompileError::MimicCoordinates { scene, joint, source_joint });
            }
            let (follower, source) = (self.body_of(j), self.body_of(mimic.source));
            Ok(Coupling { follower, source, multiplier: mimic.multiplier, offset: mimic.offset })
        };
        mimics.map(coupling).collect()
    }

    fn joint_springs(&self) -> Vec<JointSpring> {
        let spring = |spring: &model::scene::Spring| match *spring {
            model::scene::Spring::Joint { joint, stiffness, damping, rest } => {
                Some(JointSpring { body: self.body_of(joint), stiffness, damping, rest })
            }
            model::scene::Spring::Points { .. } => None,
        };
        self.scene.springs.iter().filter_map(spring).collect()
    }

    fn point_springs(&self) -> Result<Vec<PointSpring>, CompileError> {
        let anchor = |anchor: &model::scene::Anchor| {
            let (body, pose) = self.place(anchor.link, Isometry3::from(anchor.point));
            Anchor { body, point: pose.translation.vector }
        };
        let spring = |(i, spring): (usize, &model::scene::Spring)| match spring {
            model::scene::Spring::Points { from, to, stiffness, damping, rest_length } => {
                let (from, to) = (anchor(from), anchor(to));
                let between = self.between(format!("springs[{i}]"), from.body, to.body);
                Some(between.map(|()| PointSpring {
                    from,
                    to,
                    stiffness: *stiffness,
                    damping: *damping,
                    rest_length: *rest_length,
                }))
            }
            model::scene::Spring::Joint { .. } => None,
        };
        self.scene.springs.iter().enumerate().filter_map(spring).collect()
    }

    fn drives(&self) -> Vec<Drive> {
        let drive = |drive: &model::scene::Drive| Drive {
            body: self.body_of(drive.joint),
            effort: drive.effort,
            amplitude: drive.amplitude,
            angular_frequency: std::f64::consts::TAU * drive.frequency_hz,
            phase: drive.phase,
        };
        self.scene.drives.iter().map(drive).collect()
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
    let mass = inertials().map(|(i, _)| i.mass).fold(0.0, |sum, mass| sum + mass);
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
    // Nothing can be divided by what is below the normal numbers: it is none.
    let normal = |x: f64| if x < f64::MIN_POSITIVE { 0.0 } else { x };
    let (mass, moments) = (normal(mass), moments.map(normal));
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

fn check(scene: &Scene, link: &str, joint: &Joint, frame: &Principal) -> Result<(), CompileError> {
    let (scene, link, name) = (scene.name.clone(), link.to_string(), joint.name.clone());
    let (least, most) = (frame.moments.min(), frame.moments.max());
    if !(frame.mass > 0.0) && most > 0.0 {
        return Err(CompileError::Massless { scene, link, joint: name });
    }
    if !(least > 0.0) && most > 0.0 {
        return Err(CompileError::NoInertia { scene, link, joint: name, moment: least });
    }
    if joint.kind == JointKind::Floating && joint.damping > 0.0 {
        return Err(CompileError::FloatingDamping { scene, joint: name, damping: joint.damping });
    }
    Ok(())
}
