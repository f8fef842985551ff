//! A tree of links in joint coordinates.

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

use super::closure::Closure;
use super::link::Link;
use super::number::linear;
use super::number::quaternion::{matrix, rotation, turning};
use super::number::real::Real;
use super::spring::Spring;
use crate::mechanics::coordinates::JointCoordinates;
use crate::mechanics::{BodyState, Coupling, JointKind, State, System};

/// A tree of links in joint coordinates, with dampers, springs and drives in the joints and springs between points.
///
/// Positions of a joint: the angle or length; for `Planar` x, y and the angle; for `Spherical` a quaternion
/// `(x, y, z, w)`; for `Floating` the position, then a quaternion. Velocities are the free components of the relative
/// twist of the link frame against the joint frame in the parent, *in the axes of the link frame*: the motion subspace is
/// constant there.
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

/// Numbers that hold the position of a joint.
const fn positions_of(kind: JointKind) -> usize {
    match kind {
        JointKind::Revolute | JointKind::Prismatic => 1,
        JointKind::Planar => 3,
        JointKind::Spherical => 4,
        JointKind::Floating => 7,
    }
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
            positions += positions_of(joint.kind);
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
            plain: links.iter().all(|link| matches!(link.kind, JointKind::Revolute | JointKind::Prismatic)),
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
        if let JointKind::Revolute | JointKind::Prismatic = link.kind {
            out[0] += link.held(time, q[link.position]);
        }
    }

    /// The system's initial positions and velocities.
    pub fn initial(&self) -> (Vec<f64>, Vec<f64>) {
        let (mut q, mut v) = (vec![0.0; self.positions], vec![0.0; self.velocities]);
        for (link, theta) in self.links.iter().zip(&self.initial) {
            let (q, v) = (&mut q[link.position..], &mut v[link.velocity..]);
            let vector = |values: &[f64]| Vector3::new(values[0], values[1], values[2]);
            let (position, velocity) = (&theta.position, &theta.velocity);
            match link.kind {
                JointKind::Revolute | JointKind::Prismatic => (q[0], v[0]) = (position[0], velocity[0]),
                JointKind::Planar => {
                    q[..3].copy_from_slice(&position[..3]);
                    let (s, c) = position[2].sin_cos();
                    v[0] = c * velocity[0] + s * velocity[1];
                    v[1] = c * velocity[1] - s * velocity[0];
                    v[2] = velocity[2];
                }
                JointKind::Spherical => {
                    let turn = UnitQuaternion::from_scaled_axis(vector(position));
                    q[..4].copy_from_slice(turn.coords.as_slice());
                    v[..3].copy_from_slice((turn.inverse() * vector(velocity)).as_slice());
                }
                JointKind::Floating => {
                    let turn = UnitQuaternion::from_scaled_axis(vector(&position[3..]));
                    q[..3].copy_from_slice(&position[..3]);
                    q[3..7].copy_from_slice(turn.coords.as_slice());
                    v[..3].copy_from_slice((turn.inverse() * vector(velocity)).as_slice());
                    v[3..6].copy_from_slice((turn.inverse() * vector(&velocity[3..])).as_slice());
                }
            }
        }
        (q, v)
    }

    /// `qdot` of the positions at the given velocities; a quaternion turns by `qdot = 1/2 q (0, omega)`.
    pub(crate) fn rates<T: Real>(&self, q: &[T], v: &[T], out: &mut [T]) {
        for link in &self.links {
            let (q, v, out) = (&q[link.position..], &v[link.velocity..], &mut out[link.position..]);
            match link.kind {
                JointKind::Revolute | JointKind::Prismatic => out[0] = v[0],
                JointKind::Planar => {
                    let (s, c) = q[2].sin_cos();
                    out[0] = c * v[0] - s * v[1];
                    out[1] = s * v[0] + c * v[1];
                    out[2] = v[2];
                }
                JointKind::Spherical => turning(&q[..4], &v[..3], &mut out[..4]),
                JointKind::Floating => {
                    matrix(&q[3..7]).times(&linear::Vector3::new(v[0], v[1], v[2])).write(out);
                    turning(&q[3..7], &v[3..6], &mut out[3..7]);
                }
            }
        }
    }

    /// Moves the positions for a time `h` at constant velocities: lengths along the axes at the start, quaternions exactly.
    pub fn advance(&self, q: &mut [f64], v: &[f64], h: f64) {
        let turn = |q: &mut [f64], omega: &[f64]| {
            let by = UnitQuaternion::from_scaled_axis(Vector3::new(omega[0], omega[1], omega[2]) * h);
            q.copy_from_slice((rotation(q) * by).coords.as_slice());
        };
        for link in &self.links {
            let (q, v) = (&mut q[link.position..], &v[link.velocity..]);
            match link.kind {
                JointKind::Revolute | JointKind::Prismatic => q[0] += h * v[0],
                JointKind::Planar => {
                    let (s, c) = q[2].sin_cos();
                    q[0] += h * (c * v[0] - s * v[1]);
                    q[1] += h * (s * v[0] + c * v[1]);
                    q[2] += h * v[2];
                }
                JointKind::Spherical => turn(&mut q[..4], &v[..3]),
                JointKind::Floating => {
                    let way = rotation(&q[3..7]) * Vector3::new(v[0], v[1], v[2]) * h;
                    (0..3).for_each(|k| q[k] += way[k]);
                    turn(&mut q[3..7], &v[3..6]);
                }
            }
        }
    }

    /// Gives every quaternion its unit length back.
    pub fn normalise(&self, q: &mut [f64]) {
        for link in &self.links {
            let start = match link.kind {
                JointKind::Spherical => link.position,
                JointKind::Floating => link.position + 3,
                _ => continue,
            };
            let unit = rotation(&q[start..start + 4]);
            q[start..start + 4].copy_from_slice(unit.coords.as_slice());
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
        let q = &q[self.links[link].position..];
        let about_z = |angle| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        match self.links[link].kind {
            JointKind::Revolute => Isometry3::from_parts(Translation3::identity(), about_z(q[0])),
            JointKind::Prismatic => Isometry3::translation(0.0, 0.0, q[0]),
            JointKind::Planar => Isometry3::from_parts(Translation3::new(q[0], q[1], 0.0), about_z(q[2])),
            JointKind::Spherical => Isometry3::from_parts(Translation3::identity(), rotation(&q[..4])),
            JointKind::Floating => Isometry3::from_parts(Translation3::new(q[0], q[1], q[2]), rotation(&q[3..7])),
        }
    }

    /// Relative twist of a link against its parent (linear, angular), at the origin and in the axes of the link frame.
    pub(super) fn relative_twist(&self, link: usize, v: &[f64]) -> (Vector3<f64>, Vector3<f64>) {
        let v = &v[self.links[link].velocity..];
        let zero = Vector3::zeros();
        match self.links[link].kind {
            JointKind::Revolute => (zero, Vector3::new(0.0, 0.0, v[0])),
            JointKind::Prismatic => (Vector3::new(0.0, 0.0, v[0]), zero),
            JointKind::Planar => (Vector3::new(v[0], v[1], 0.0), Vector3::new(0.0, 0.0, v[2])),
            JointKind::Spherical => (zero, Vector3::new(v[0], v[1], v[2])),
            JointKind::Floating => (Vector3::new(v[0], v[1], v[2]), Vector3::new(v[3], v[4], v[5])),
        }
    }
}
