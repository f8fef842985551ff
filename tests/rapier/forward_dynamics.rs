//! Accelerations by the textbook: one dense system for all bodies and all joint forces, built from the definition of a
//! joint in the crate's documentation and sharing no code with any engine.
//!
//! ```text
//! [ M  -G^T ] [ a      ]   [ f ]
//! [ G   0   ] [ lambda ] = [ c ]
//! ```
//!
//! with `M` of masses and world inertias, `f` of gravity, gyroscopic torque, springs, dampers and drives at t = 0, and one row of `G` for
//! each component of a joint's relative twist that is locked.

use nalgebra::{DMatrix, DVector, Matrix3, UnitQuaternion, Vector3};
use rattlebench::mechanics::{Anchor, BodyState, State, System};

/// What the rows of `G` say about the accelerations.
#[derive(Clone, Copy, PartialEq)]
pub enum Constraint {
    /// `d/dt (G v) = 0`: the motion of the bodies.
    Exact,
    /// `G a = 0`: a velocity that is kept in the null space of `G(q0)`, as one step of a velocity solver does.
    Frozen,
}

/// Accelerations of every body: linear of the centre of mass, angular; world axes.
pub fn accelerations(system: &System, state: &State, constraint: Constraint) -> DVector<f64> {
    let g = rows(system, state);
    let (n, m) = (6 * system.bodies.len(), g.nrows());
    let mut matrix = DMatrix::zeros(n + m, n + m);
    let mut right = DVector::zeros(n + m);
    for (i, (body, s)) in system.bodies.iter().zip(&state.bodies).enumerate() {
        let turn = s.attitude.to_rotation_matrix();
        let inertia = turn * Matrix3::from_diagonal(&body.inertia) * turn.inverse();
        matrix.view_mut((6 * i, 6 * i), (3, 3)).fill_diagonal(body.mass);
        matrix.view_mut((6 * i + 3, 6 * i + 3), (3, 3)).copy_from(&inertia);
        right.rows_mut(6 * i, 3).copy_from(&(body.mass * system.gravity));
        right.rows_mut(6 * i + 3, 3).copy_from(&(-s.angular_velocity.cross(&(inertia * s.angular_velocity))));
    }
    let free = free_rows(system, state);
    let v = velocities(state);
    let mut row = 0;
    for (i, body) in system.bodies.iter().enumerate() {
        let count = body.joint.kind.degrees_of_freedom();
        let own = free.rows(row, count);
        let mut effort = -body.joint.damping * (own * &v);
        let theta = system.initial_coordinates[i].position[0];
        for spring in system.parts.joint_springs.iter().filter(|spring| spring.body == i) {
            effort[0] += -spring.stiffness * (theta - spring.rest) - spring.damping * (own * &v)[0];
        }
        for drive in system.parts.drives.iter().filter(|drive| drive.body == i) {
            effort[0] += drive.effort + drive.amplitude * drive.phase.sin();
        }
        let mut bodies = right.rows_mut(0, n);
        bodies += own.transpose() * effort;
        row += count;
    }
    for spring in &system.parts.point_springs {
        // The row that gives the rate of the distance.
        let (from, to) = (point_of(&spring.from, state), point_of(&spring.to, state));
        let (distance, along) = ((to - from).norm(), (to - from).normalize());
        let mut own = DVector::zeros(n);
        for (anchor, at, sign) in [(&spring.from, from, -1.0), (&spring.to, to, 1.0)] {
            if let Some(b) = anchor.body {
                own.rows_mut(6 * b, 3).copy_from(&(sign * along));
                own.rows_mut(6 * b + 3, 3).copy_from(&(sign * (at - state.bodies[b].position).cross(&along)));
            }
        }
        let pull = spring.stiffness * (distance - spring.rest_length) + spring.damping * own.dot(&v);
        let mut bodies = right.rows_mut(0, n);
        bodies -= pull * own;
    }
    matrix.view_mut((0, n), (n, m)).copy_from(&(-g.transpose()));
    matrix.view_mut((n, 0), (m, n)).copy_from(&g);
    if constraint == Constraint::Exact {
        let e = 1e-5;
        let rate = (rows(system, &moved(state, e)) - rows(system, &moved(state, -e))) / (2.0 * e);
        right.rows_mut(n, m).copy_from(&(-rate * v));
    }
    matrix.lu().solve(&right).expect("joints are independent").rows(0, n).into_owned()
}

fn point_of(anchor: &Anchor, state: &State) -> Vector3<f64> {
    anchor.body.map_or(anchor.point, |b| state.bodies[b].position + state.bodies[b].attitude * anchor.point)
}

/// All twists in one vector.
pub fn velocities(state: &State) -> DVector<f64> {
    let all = state.bodies.iter().flat_map(|s| s.velocity.iter().chain(s.angular_velocity.iter()).copied());
    DVector::from_iterator(6 * state.bodies.len(), all)
}

fn rows(system: &System, state: &State) -> DMatrix<f64> {
    twist_rows(system, state, false)
}

fn free_rows(system: &System, state: &State) -> DMatrix<f64> {
    twist_rows(system, state, true)
}

/// The rows that give the components of the relative twists, free or locked, of every joint.
fn twist_rows(system: &System, state: &State, wanted: bool) -> DMatrix<f64> {
    let mut list: Vec<DVector<f64>> = Vec::new();
    for (child, body) in system.bodies.iter().enumerate() {
        let joint = &body.joint;
        let s = &state.bodies[child];
        let origin = s.position + s.attitude * joint.in_child.translation.vector;
        let frame = joint.parent.map_or(UnitQuaternion::identity(), |p| state.bodies[p].attitude);
        let axes = frame * joint.in_parent.rotation;
        for slot in (0..6).filter(|&slot| joint.kind.free()[slot] == wanted) {
            let axis = axes * Vector3::ith(slot % 3, 1.0);
            let mut row = DVector::zeros(6 * system.bodies.len());
            let mut add = |index: usize, sign: f64| {
                let arm = origin - state.bodies[index].position;
                if slot < 3 {
                    row.rows_mut(6 * index, 3).copy_from(&(sign * axis));
                    row.rows_mut(6 * index + 3, 3).copy_from(&(sign * arm.cross(&axis)));
                } else {
                    row.rows_mut(6 * index + 3, 3).copy_from(&(sign * axis));
                }
            };
            add(child, 1.0);
            if let Some(parent) = joint.parent {
                add(parent, -1.0);
            }
            list.push(row);
        }
    }
    let mut matrix = DMatrix::zeros(list.len(), 6 * system.bodies.len());
    for (i, row) in list.iter().enumerate() {
        matrix.row_mut(i).copy_from(&row.transpose());
    }
    matrix
}

/// The state a time later if every twist stayed what it is.
fn moved(state: &State, time: f64) -> State {
    let bodies = state.bodies.iter().map(|s| BodyState {
        position: s.position + time * s.velocity,
        attitude: UnitQuaternion::from_scaled_axis(time * s.angular_velocity) * s.attitude,
        ..*s
    });
    State { bodies: bodies.collect() }
}
