//! Joint coordinates and their conjugate momenta, in a chart about a state.
//!
//! A coordinate is an angle or a length; a rotation of three coordinates is `R = R_c C(s)` with the chart's centre `R_c` and
//! the Cayley rotation `C(s)`, the quaternion `(1, s) / sqrt(1 + |s|^2)`, which turns with the angular velocity
//! `2 / (1 + |s|^2) (sdot + s x sdot)`. With `J` the twists of the bodies by the rates of the coordinates, momenta are
//! `p = dK/dthetadot = J^T M v`. Any such coordinates and momenta are canonical: `Omega = dtheta ^ dp`.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rattlebench::discrete::{Matrix, Vector};
use rattlebench::mechanics::coordinates::{JointCoordinates, forward_kinematics, joint_coordinates};
use rattlebench::mechanics::{JointKind, State, System};

pub struct Chart<'a> {
    system: &'a System,
    /// Joint coordinates of the state in the middle of the chart.
    centre: Vec<JointCoordinates>,
}

/// Index of the first of three coordinates that are a rotation.
fn rotation_at(kind: JointKind) -> Option<usize> {
    match kind {
        JointKind::Spherical => Some(0),
        JointKind::Floating => Some(3),
        JointKind::Revolute | JointKind::Prismatic | JointKind::Planar => None,
    }
}

fn triple(values: &[f64]) -> Vector3<f64> {
    Vector3::new(values[0], values[1], values[2])
}

fn cayley(s: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(Quaternion::new(1.0, s.x, s.y, s.z))
}

impl<'a> Chart<'a> {
    pub fn about(system: &'a System, state: &State) -> Chart<'a> {
        let mut centre = vec![JointCoordinates::default(); system.bodies.len()];
        joint_coordinates(system, state, &mut centre);
        Chart { system, centre }
    }

    pub fn dimension(&self) -> usize {
        self.system.degrees_of_freedom()
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

    /// The state at the given coordinates and rates.
    pub fn state(&self, theta: &Vector, rate: &Vector) -> State {
        let joints: Vec<_> = self
            .joints()
            .map(|(kind, first, centre)| {
                let mut out = JointCoordinates::default();
                let d = kind.degrees_of_freedom();
                out.position[..d].copy_from_slice(&theta.as_slice()[first..first + d]);
                out.velocity[..d].copy_from_slice(&rate.as_slice()[first..first + d]);
                if let Some(k) = rotation_at(kind) {
                    let (s, sdot) = (triple(&out.position[k..]), triple(&out.velocity[k..]));
                    let middle = UnitQuaternion::new(triple(&centre.position[k..]));
                    let rotation = middle * cayley(&s);
                    let turning = middle * ((sdot + s.cross(&sdot)) * (2.0 / (1.0 + s.norm_squared())));
                    out.position[k..k + 3].copy_from_slice(rotation.scaled_axis().as_slice());
                    out.velocity[k..k + 3].copy_from_slice(turning.as_slice());
                }
                out
            })
            .collect();
        forward_kinematics(&self.system.bodies, &joints)
    }

    /// The coordinates of a state near the centre.
    pub fn coordinates(&self, state: &State) -> Vector {
        let mut joints = vec![JointCoordinates::default(); self.system.bodies.len()];
        joint_coordinates(self.system, state, &mut joints);
        let mut theta = Vector::zeros(self.dimension());
        for ((kind, first, centre), joint) in self.joints().zip(&joints) {
            let mut position = joint.position;
            if let Some(k) = rotation_at(kind) {
                let middle = UnitQuaternion::new(triple(&centre.position[k..]));
                let relative = middle.inverse() * UnitQuaternion::new(triple(&position[k..]));
                position[k..k + 3].copy_from_slice((relative.imag() / relative.w).as_slice());
            }
            let d = kind.degrees_of_freedom();
            theta.as_mut_slice()[first..first + d].copy_from_slice(&position[..d]);
            if let Some(angle) = [(JointKind::Revolute, 0), (JointKind::Planar, 2)].iter().find(|a| a.0 == kind) {
                // The branch of the angle that the centre lies in.
                let turn = std::f64::consts::TAU;
                let turns = ((position[angle.1] - centre.position[angle.1]) / turn).round();
                theta[first + angle.1] -= turn * turns;
            }
        }
        theta
    }

    /// `J`: twists of the bodies (velocity of the centre of mass, angular velocity; world axes) by the rates.
    pub fn jacobian(&self, theta: &Vector) -> Matrix {
        let d = self.dimension();
        let columns: Vec<_> = (0..d)
            .map(|i| twists(&self.state(theta, &Vector::from_fn(d, |k, _| if k == i { 1.0 } else { 0.0 }))))
            .collect();
        Matrix::from_columns(&columns)
    }

    /// `J^T M J`
    pub fn mass_matrix(&self, theta: &Vector) -> Matrix {
        let jacobian = self.jacobian(theta);
        let state = self.state(theta, &Vector::zeros(self.dimension()));
        let momenta: Vec<_> =
            jacobian.column_iter().map(|v| body_momenta(self.system, &state, &v.into_owned())).collect();
        jacobian.tr_mul(&Matrix::from_columns(&momenta))
    }

    /// Conjugate momenta of a state.
    pub fn momenta(&self, theta: &Vector, state: &State) -> Vector {
        self.jacobian(theta).tr_mul(&body_momenta(self.system, state, &twists(state)))
    }

    /// The state at coordinates and conjugate momenta.
    pub fn state_at_momenta(&self, theta: &Vector, p: &Vector) -> State {
        let rate = self.mass_matrix(theta).cholesky().expect("a positive mass matrix").solve(p);
        self.state(theta, &rate)
    }
}

/// Twists of all bodies, six rows each.
pub fn twists(state: &State) -> Vector {
    let rows = state.bodies.iter().flat_map(|b| b.velocity.iter().chain(b.angular_velocity.iter()).copied());
    Vector::from_iterator(6 * state.bodies.len(), rows)
}

/// `M v`: linear and angular momenta of all bodies that have the twists `v` at the poses of a state.
pub fn body_momenta(system: &System, state: &State, v: &Vector) -> Vector {
    let mut out = Vector::zeros(v.len());
    for (i, (body, pose)) in system.bodies.iter().zip(&state.bodies).enumerate() {
        let omega = pose.attitude.inverse_transform_vector(&v.fixed_rows::<3>(6 * i + 3).into_owned());
        out.fixed_rows_mut::<3>(6 * i).copy_from(&(body.mass * v.fixed_rows::<3>(6 * i)));
        out.fixed_rows_mut::<3>(6 * i + 3).copy_from(&(pose.attitude * body.inertia.component_mul(&omega)));
    }
    out
}
