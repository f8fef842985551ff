//! Linear and angular momentum, and which components of them a system conserves (Noether's theorem on the ground's
//! joints: a translation or rotation that a ground joint lets pass and that gravity does not notice).

use nalgebra::{Unit, Vector3};

use super::joint_kind::JointKind;
use super::state::State;
use super::system::System;

/// A component of momentum that the exact motion conserves.
#[derive(Clone, Debug)]
pub struct Conserved {
    /// Such as `angular momentum about z through joint 'swivel'`.
    pub name: String,
    pub kind: Component,
    /// The bodies that hang on the ground's joint.
    bodies: Vec<usize>,
    /// What errors are divided by, kg m/s or kg m^2/s.
    pub scale: f64,
}

/// Which component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Component {
    /// `P . axis`
    Linear { axis: Unit<Vector3<f64>> },
    /// `L . axis` about a point fixed in the world.
    Angular { axis: Unit<Vector3<f64>>, point: Vector3<f64> },
    /// `L . axis` about the moving centre of mass.
    Spin { axis: Unit<Vector3<f64>> },
}

impl Conserved {
    /// The component in a state, kg m/s or kg m^2/s.
    pub fn value(&self, system: &System, state: &State) -> f64 {
        match self.kind {
            Component::Linear { axis } => self.linear(system, state).dot(&axis),
            Component::Angular { axis, point } => self.angular(system, state, &point, &Vector3::zeros()).dot(&axis),
            Component::Spin { axis } => {
                let mass: f64 = self.bodies.iter().map(|&i| system.bodies[i].mass).sum();
                let centre: Vector3<f64> =
                    self.bodies.iter().map(|&i| system.bodies[i].mass * state.bodies[i].position).sum::<Vector3<f64>>()
                        / mass;
                let drift = self.linear(system, state) / mass;
                self.angular(system, state, &centre, &drift).dot(&axis)
            }
        }
    }

    fn linear(&self, system: &System, state: &State) -> Vector3<f64> {
        self.bodies.iter().map(|&i| system.bodies[i].mass * state.bodies[i].velocity).sum()
    }

    /// Angular momentum about a point that moves with velocity `drift`.
    fn angular(&self, system: &System, state: &State, point: &Vector3<f64>, drift: &Vector3<f64>) -> Vector3<f64> {
        self.bodies
            .iter()
            .map(|&i| {
                let (body, s) = (&system.bodies[i], &state.bodies[i]);
                let omega = s.attitude.inverse_transform_vector(&s.angular_velocity);
                (s.position - point).cross(&(body.mass * (s.velocity - drift)))
                    + s.attitude * body.inertia.component_mul(&omega)
            })
            .sum()
    }
}

/// Every conserved component, tree by tree. Empty where the scene has no such symmetry.
pub fn conserved(system: &System) -> Vec<Conserved> {
    let mut found = Vec::new();
    for (root, body) in system.bodies.iter().enumerate() {
        let joint = &body.joint;
        if joint.parent.is_some() || joint.damping > 0.0 {
            continue;
        }
        let bodies = subtree(system, root);
        if !pushed_from_outside(system, root, &bodies) {
            for (name, kind) in components(system, root) {
                found.push(Conserved {
                    scale: momentum_scale(system, &bodies, &kind),
                    bodies: bodies.clone(),
                    name,
                    kind,
                });
            }
        }
    }
    found
}

/// True where a loop, coupling, spring or drive acts between a tree and what is not part of it, or along its ground
/// joint.
fn pushed_from_outside(system: &System, root: usize, tree: &[usize]) -> bool {
    let parts = &system.parts;
    let inside = |body: Option<usize>| body.is_some_and(|b| tree.contains(&b));
    let leaves = |a: Option<usize>, b: Option<usize>| inside(a) != inside(b);
    parts.loops.iter().any(|c| leaves(c.parent, c.child))
        || parts.point_springs.iter().any(|s| leaves(s.from.body, s.to.body))
        || parts
            .couplings
            .iter()
            .any(|c| [c.follower, c.source].contains(&root) || leaves(Some(c.follower), Some(c.source)))
        || parts.joint_springs.iter().any(|s| s.body == root)
        || parts.drives.iter().any(|d| d.body == root)
}

/// The components that the ground joint of `root` and gravity leave invariant.
fn components(system: &System, root: usize) -> Vec<(String, Component)> {
    let joint = &system.bodies[root].joint;
    let frame = joint.in_parent.rotation;
    let point = joint.in_parent.translation.vector;
    let axes = [("x", Vector3::x_axis()), ("y", Vector3::y_axis()), ("z", Vector3::z_axis())];
    let across = |axis: &Vector3<f64>| system.gravity.dot(axis).abs() <= 1e-12 * system.gravity.norm();
    let along = |axis: &Vector3<f64>| system.gravity.cross(axis).norm() <= 1e-12 * system.gravity.norm();
    let name = &joint.name;
    let mut list = Vec::new();
    match joint.kind {
        JointKind::Floating => {
            for (letter, axis) in axes.iter().filter(|(_, a)| across(a)) {
                list.push((format!("linear momentum along {letter} of '{name}'"), Component::Linear { axis: *axis }));
            }
            for (letter, axis) in axes {
                list.push((format!("angular momentum about {letter} of '{name}'"), Component::Spin { axis }));
            }
        }
        JointKind::Spherical => {
            for (letter, axis) in axes.into_iter().filter(|(_, a)| along(a)) {
                list.push((
                    format!("angular momentum about {letter} through '{name}'"),
                    Component::Angular { axis, point },
                ));
            }
        }
        JointKind::Revolute | JointKind::Prismatic | JointKind::Planar => {
            let axis_of = |i: usize| frame * axes[i].1;
            let free = joint.kind.free();
            for i in (0..3).filter(|&i| free[i] && across(&axis_of(i))) {
                let letter = axes[i].0;
                let kind = Component::Linear { axis: axis_of(i) };
                list.push((format!("linear momentum along the {letter} axis of '{name}'"), kind));
            }
            if free[5] && along(&axis_of(2)) {
                let kind = Component::Angular { axis: axis_of(2), point };
                list.push((format!("angular momentum about the axis of '{name}'"), kind));
            }
        }
    }
    list
}

fn subtree(system: &System, root: usize) -> Vec<usize> {
    let mut member = vec![false; system.bodies.len()];
    member[root] = true;
    for i in root + 1..system.bodies.len() {
        member[i] = system.bodies[i].joint.parent.is_some_and(|p| member[p]);
    }
    (0..member.len()).filter(|&i| member[i]).collect()
}

/// `sqrt(2 m E)` for linear and `sqrt(2 I E)` for angular momentum, with `E` the energy scale of the scene and `I` the
/// moment of inertia about the point, the bodies taken where they start.
fn momentum_scale(system: &System, bodies: &[usize], kind: &Component) -> f64 {
    let mass: f64 = bodies.iter().map(|&i| system.bodies[i].mass).sum();
    let point = match kind {
        Component::Linear { .. } => return (2.0 * mass * system.energy_scale).sqrt(),
        Component::Angular { point, .. } => *point,
        Component::Spin { .. } => {
            bodies.iter().map(|&i| system.bodies[i].mass * system.initial.bodies[i].position).sum::<Vector3<f64>>()
                / mass
        }
    };
    let inertia: f64 = bodies
        .iter()
        .map(|&i| {
            let body = &system.bodies[i];
            body.mass * (system.initial.bodies[i].position - point).norm_squared() + body.inertia.max()
        })
        .sum();
    (2.0 * inertia * system.energy_scale).sqrt()
}
