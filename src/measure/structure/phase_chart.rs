//! Joint coordinates and their conjugate momenta, in a chart about a state.
//!
//! A coordinate is an angle or a length; a rotation of three coordinates is `R = R_c C(s)` with the chart's centre
//! `R_c` and the Cayley rotation `C(s)`, the quaternion `(1, s) / sqrt(1 + |s|^2)`, which turns with the angular
//! velocity `2 / (1 + |s|^2) (sdot + s x sdot)`. With `J` the twists of the bodies by the rates of the coordinates,
//! momenta are `p = dK/dthetadot = J^T M v`. Any such coordinates and momenta are canonical: `Omega = dtheta ^ dp`.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, Quaternion, UnitQuaternion, Vector3};

use crate::mechanics::coordinates::{JointCoordinates, forward_kinematics, joint_coordinates};
use crate::mechanics::{JointKind, State, System};

/// Canonical coordinates of the states near one state.
#[derive(Clone, Debug)]
pub struct PhaseChart<'a> {
    system: &'a System,
    /// Joint coordinates of the state in the middle of the chart.
    centre: Vec<JointCoordinates>,
}

fn triple(values: &[f64]) -> Vector3<f64> {
    Vector3::new(values[0], values[1], values[2])
}

fn cayley(s: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(Quaternion::new(1.0, s.x, s.y, s.z))
}

impl<'a> PhaseChart<'a> {
    /// The chart with its origin, for rotations, at `state`.
    pub fn about(system: &'a System, state: &State) -> PhaseChart<'a> {
        let mut centre = vec![JointCoordinates::default(); system.bodies.len()];
        joint_coordinates(system, state, &mut centre);
        PhaseChart { system, centre }
    }

    pub(super) fn system(&self) -> &'a System {
        self.system
    }

    /// Place among the coordinates of the first one of a body's joint.
    pub(super) fn first(&self, body: usize) -> usize {
        self.system.bodies[..body].iter().map(|b| b.joint.kind.degrees_of_freedom()).sum()
    }

    /// Number of coordinates of the joints of the tree, d.
    pub fn dimension(&self) -> usize {
        self.system.bodies.iter().map(|b| b.joint.kind.degrees_of_freedom()).sum()
    }

    /// Each joint with its place among the coordinates.
    fn joints(&self) -> impl Iterator<Item = (JointKind, usize, &JointCoordinates)> {
        let mut next = 0;
        self.system.bodies.iter().zip(&self.centre).map(move |(body, centre)| {
            let kind = body.joint.kind;
            let first = next;
            next += kind.degrees_of_freedom();
            (kind, first, centre)
        })
    }

    /// Positions and velocities of the joints, as a [`System`] is built from, at the given coordinates and rates.
    pub fn joint_coordinates(&self, theta: &DVector<f64>, rate: &DVector<f64>) -> Vec<JointCoordinates> {
        let at = |(kind, first, centre): (JointKind, usize, &JointCoordinates)| {
            let mut out = JointCoordinates::default();
            let d = kind.degrees_of_freedom();
            out.position[..d].copy_from_slice(&theta.as_slice()[first..first + d]);
            out.velocity[..d].copy_from_slice(&rate.as_slice()[first..first + d]);
            if let Some(k) = kind.rotation_vector_index() {
                let (s, sdot) = (triple(&out.position[k..]), triple(&out.velocity[k..]));
                let middle = UnitQuaternion::new(triple(&centre.position[k..]));
                let rotation = middle * cayley(&s);
                let turning = middle * ((sdot + s.cross(&sdot)) * (2.0 / (1.0 + s.norm_squared())));
                out.position[k..k + 3].copy_from_slice(rotation.scaled_axis().as_slice());
                out.velocity[k..k + 3].copy_from_slice(turning.as_slice());
            }
            out
        };
        self.joints().map(at).collect()
    }

    /// The state at the given coordinates and rates.
    pub fn state(&self, theta: &DVector<f64>, rate: &DVector<f64>) -> State {
        forward_kinematics(&self.system.bodies, &self.joint_coordinates(theta, rate))
    }

    /// The system with the given coordinates and rates as its initial ones.
    pub(crate) fn system_at(&self, theta: &DVector<f64>, rate: &DVector<f64>) -> System {
        let initial_coordinates = self.joint_coordinates(theta, rate);
        let initial = forward_kinematics(&self.system.bodies, &initial_coordinates);
        System { initial, initial_coordinates, ..self.system.clone() }
    }

    /// The coordinates of a state near the centre; what a joint does not allow is left out.
    pub fn coordinates(&self, state: &State) -> DVector<f64> {
        let mut joints = vec![JointCoordinates::default(); self.system.bodies.len()];
        joint_coordinates(self.system, state, &mut joints);
        let mut theta = DVector::zeros(self.dimension());
        for ((kind, first, centre), joint) in self.joints().zip(&joints) {
            let mut position = joint.position;
            if let Some(k) = kind.rotation_vector_index() {
                let middle = UnitQuaternion::new(triple(&centre.position[k..]));
                let relative = middle.inverse() * UnitQuaternion::new(triple(&position[k..]));
                position[k..k + 3].copy_from_slice((relative.imag() / relative.w).as_slice());
            }
            if let Some(k) = kind.angle_index() {
                // The branch of the angle that the centre lies in.
                position[k] -= TAU * ((position[k] - centre.position[k]) / TAU).round();
            }
            let d = kind.degrees_of_freedom();
            theta.as_mut_slice()[first..first + d].copy_from_slice(&position[..d]);
        }
        theta
    }

    /// `J`: twists of the bodies (velocity of the centre of mass, angular velocity; world axes) by the rates.
    pub fn jacobian(&self, theta: &DVector<f64>) -> DMatrix<f64> {
        let d = self.dimension();
        let unit = |i: usize| DVector::from_fn(d, |k, _| if k == i { 1.0 } else { 0.0 });
        let columns: Vec<_> = (0..d).map(|i| twists(&self.state(theta, &unit(i)))).collect();
        DMatrix::from_columns(&columns)
    }

    /// `J^T M J`
    pub fn mass_matrix(&self, theta: &DVector<f64>) -> DMatrix<f64> {
        let jacobian = self.jacobian(theta);
        let state = self.state(theta, &DVector::zeros(self.dimension()));
        let momenta: Vec<_> =
            jacobian.column_iter().map(|v| body_momenta(self.system, &state, &v.into_owned())).collect();
        jacobian.tr_mul(&DMatrix::from_columns(&momenta))
    }

    /// Conjugate momenta `J^T M v` of a state that has the coordinates `theta`; velocities that a joint does not allow
    /// count as far as they do work on the coordinates.
    pub fn momenta(&self, theta: &DVector<f64>, state: &State) -> DVector<f64> {
        self.jacobian(theta).tr_mul(&body_momenta(self.system, state, &twists(state)))
    }
}

/// Twists of all bodies, six rows each.
pub fn twists(state: &State) -> DVector<f64> {
    let rows = state.bodies.iter().flat_map(|b| b.velocity.iter().chain(b.angular_velocity.iter()).copied());
    DVector::from_iterator(6 * state.bodies.len(), rows)
}

/// `M v`: linear and angular momenta of all bodies that have the twists `v` at the poses of a state.
pub fn body_momenta(system: &System, state: &State, v: &DVector<f64>) -> DVector<f64> {
    let mut out = DVector::zeros(v.len());
    for (i, (body, pose)) in system.bodies.iter().zip(&state.bodies).enumerate() {
        let omega = pose.attitude.inverse_transform_vector(&v.fixed_rows::<3>(6 * i + 3).into_owned());
        out.fixed_rows_mut::<3>(6 * i).copy_from(&(body.mass * v.fixed_rows::<3>(6 * i)));
        out.fixed_rows_mut::<3>(6 * i + 3).copy_from(&(pose.attitude * body.inertia.component_mul(&omega)));
    }
    out
}
