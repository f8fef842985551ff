//! A tree of links in joint coordinates.

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};

use super::closure::Closure;
use super::joint::for_kind;
use super::link::Link;
use super::number::real::Real;
use super::spring::Spring;
use crate::mechanics::coordinates::JointCoordinates;
use crate::mechanics::{BodyState, Coupling, State, System};

/// A tree of links in joint coordinates, with dampers, springs and drives in the joints and springs between points.
///
/// Positions of a joint: the angle or length; for `Planar` x, y and the angle; for `Spherical` a quaternion
/// `(x, y, z, w)`; for `Floating` the position, then a quaternion. Velocities are the free components of the relative
/// twist of the link frame against the joint frame in the parent, *in the axes of the link frame*: the motion subspace
/// is constant there.
#[derive(Clone, Debug)]
pub struct Model {
    pub links: Vec<Link>,
    /// Between points of the links.
    pub springs: Vec<Spring>,
    /// What closes loops, and which joints follow others.
    pub closures: Vec<Closure>,
    pub couplings: Vec<Coupling>,
    /// Independent rows of these where the system starts.
    pub rank: usize,
    /// m/s^2, world
    pub gravity: Vector3<f64>,
    /// Number of positions and of velocities.
    pub positions: usize,
    pub velocities: usize,
    /// Every joint has one coordinate: a position's rate is its velocity, and its momentum lies along that.
    pub plain: bool,
    initial: Vec<JointCoordinates>,
}

impl Model {
    pub fn new(system: &System) -> Model {
        let (mut positions, mut velocities) = (0, 0);
        let mut links: Vec<Link> = Vec::with_capacity(system.bodies.len());
        for body in &system.bodies {
            let joint = &body.joint;
            let in_parent = match joint.parent {
                Some(p) => system.bodies[p].joint.in_child.inverse() * joint.in_parent,
                None => joint.in_parent,
            };
            let in_link = joint.in_child.inverse();
            let axes = in_link.rotation.to_rotation_matrix().into_inner();
            let c = in_link.translation.vector;
            let parallel = body.mass * (Matrix3::identity() * c.norm_squared() - c * c.transpose());
            links.push(Link {
                parent: joint.parent,
                kind: joint.kind,
                in_parent,
                parent_axes: in_parent.rotation.to_rotation_matrix().into_inner(),
                body: in_link,
                mass: body.mass,
                mass_beyond: body.mass,
                first_moment: body.mass * c,
                inertia: axes * Matrix3::from_diagonal(&body.inertia) * axes.transpose() + parallel,
                damping: joint.damping,
                stiffness: 0.0,
                spring_effort: 0.0,
                drives: Vec::new(),
                position: positions,
                velocity: velocities,
            });
            positions += for_kind!(joint.kind, Joint => Joint::POSITIONS);
            velocities += joint.kind.degrees_of_freedom();
        }
        for spring in &system.parts.joint_springs {
            let link = &mut links[spring.body];
            link.stiffness += spring.stiffness;
            link.spring_effort += spring.stiffness * spring.rest;
            link.damping += spring.damping;
        }
        for drive in &system.parts.drives {
            links[drive.body].drives.push(drive.clone());
        }
        for i in (0..links.len()).rev() {
            if let Some(p) = links[i].parent {
                links[p].mass_beyond += links[i].mass_beyond;
            }
        }
        Model {
            springs: system.parts.point_springs.iter().map(|spring| Spring::new(spring, &links)).collect(),
            closures: system.parts.loops.iter().map(|closure| Closure::new(closure, &links)).collect(),
            couplings: system.parts.couplings.clone(),
            rank: system.mobility.rank,
            plain: links.iter().all(|link| link.kind.degrees_of_freedom() == 1),
            links,
            gravity: system.gravity,
            positions,
            velocities,
            initial: system.initial_coordinates.clone(),
        }
    }

    /// What dampers, springs and drives exert along the velocities of a joint at a time in s.
    #[inline(always)]
    pub(super) fn efforts(&self, link: &Link, time: f64, q: &[f64], v: &[f64], out: &mut [f64]) {
        let freedoms = link.velocity..link.velocity + link.kind.degrees_of_freedom();
        for (out, v) in out.iter_mut().zip(&v[freedoms]) {
            *out = -link.damping * v;
        }
        if link.kind.degrees_of_freedom() == 1 {
            out[0] += link.joint_effort(time, q[link.position]);
        }
    }

    /// The system's initial positions and velocities.
    pub fn initial(&self) -> (Vec<f64>, Vec<f64>) {
        let (mut q, mut v) = (vec![0.0; self.positions], vec![0.0; self.velocities]);
        for (link, theta) in self.links.iter().zip(&self.initial) {
            let (q, v) = (&mut q[link.position..], &mut v[link.velocity..]);
            for_kind!(link.kind, Joint => Joint::initial(theta, q, v));
        }
        (q, v)
    }

    /// `qdot` of the positions at the given velocities.
    pub(crate) fn rates<T: Real>(&self, q: &[T], v: &[T], out: &mut [T]) {
        for link in &self.links {
            let (q, v, out) = (&q[link.position..], &v[link.velocity..], &mut out[link.position..]);
            for_kind!(link.kind, Joint => Joint::velocity_map(q, v, out));
        }
    }

    /// Moves the positions for a time `h` at constant velocities: lengths along the axes at the start, quaternions
    /// exactly.
    pub fn advance(&self, q: &mut [f64], v: &[f64], h: f64) {
        for link in &self.links {
            let (q, v) = (&mut q[link.position..], &v[link.velocity..]);
            for_kind!(link.kind, Joint => Joint::advance(q, v, h));
        }
    }

    /// Gives every quaternion its unit length back.
    pub(crate) fn normalise(&self, q: &mut [f64]) {
        for link in &self.links {
            for_kind!(link.kind, Joint => Joint::normalise(&mut q[link.position..]));
        }
    }

    /// Writes poses and twists of the bodies, world axes.
    pub fn write_state(&self, q: &[f64], v: &[f64], out: &mut State) {
        for (i, link) in self.links.iter().enumerate() {
            let (parent_frame, parent) = match link.parent {
                Some(p) => (out.bodies[p].pose() * self.links[p].body.inverse() * link.in_parent, Some(out.bodies[p])),
                None => (link.in_parent, None),
            };
            let frame = parent_frame * self.transform(i, q);
            let pose = frame * link.body;
            let (linear, angular) = self.relative_twist(i, v);
            let (mut velocity, mut angular_velocity) = (frame.rotation * linear, frame.rotation * angular);
            if let Some(parent) = parent {
                let arm = frame.translation.vector - parent.position;
                velocity += parent.velocity + parent.angular_velocity.cross(&arm);
                angular_velocity += parent.angular_velocity;
            }
            velocity += angular_velocity.cross(&(pose.translation.vector - frame.translation.vector));
            let attitude = UnitQuaternion::new_normalize(pose.rotation.into_inner());
            out.bodies[i] = BodyState { position: pose.translation.vector, attitude, velocity, angular_velocity };
        }
    }

    /// Pose of the link frame in the joint frame of the parent.
    pub(super) fn transform(&self, link: usize, q: &[f64]) -> Isometry3<f64> {
        let link = &self.links[link];
        for_kind!(link.kind, Joint => Joint::transform(&q[link.position..]))
    }

    /// Relative twist of a link against its parent (linear, angular), at the origin and in the axes of the link frame.
    pub(super) fn relative_twist(&self, link: usize, v: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
        let link = &self.links[link];
        for_kind!(link.kind, Joint => Joint::relative_twist(&v[link.velocity..]))
    }
}
