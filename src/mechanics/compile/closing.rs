//! Consistent initial values of a system with loops and couplings, and its mobility.
//!
//! With `theta` the coordinates of all joints, `phi(theta)` what the loop closures and couplings do not allow and
//! `J = d phi / d thetadot`, the positions left open solve `phi(theta) = 0` by Gauss-Newton steps of least norm, and
//! the velocities left open solve `J thetadot = 0` with least norm. Redundant rows are the rule (a planar four-bar
//! closed by a hinge has three): every solve is by singular values.

use nalgebra::{DMatrix, DVector, UnitQuaternion, Vector3};

use crate::mechanics::body::Body;
use crate::mechanics::coordinates::forward_kinematics;
use crate::mechanics::joint::JointCoordinates;
use crate::mechanics::mobility::Mobility;
use crate::mechanics::parts::Parts;
use crate::mechanics::rank::RANK;

/// The largest change of a coordinate in one Gauss-Newton step, rad or m: at 0.3 rad the linearisation of a turn errs
/// by 0.3^2 / 2, a twentieth.
const LONGEST_STEP: f64 = 0.3;

/// Steps from one start. The shipped linkages take 5 to 23.
const STEPS: usize = 200;

/// Steps in a row that leave more than `PROGRESS` of the least residual before a start is given up.
const STAGNATION: usize = 30;
const PROGRESS: f64 = 0.9;

/// Starts that are tried. The shipped linkages close from the first, second or third.
const STARTS: usize = 40;

/// Phases of the starts over coordinates and over starts, rad: the golden angle spreads them evenly, and the other is
/// in no simple ratio to it.
const PHASES: (f64, f64) = (2.399_963, 1.234_567);

/// How far closures may be open in a consistent state: m or rad for positions, m/s or rad/s for velocities, each
/// against the size of the system's own lengths and velocities. The shipped linkages close to 5e-16 and 7e-16.
const CLOSED: f64 = 1e-11;

/// What a scene gives of a joint's initial state. What it does not give is free to be solved for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Given {
    pub position: bool,
    pub velocity: bool,
}

/// Loops that stay open: the index among loops and then couplings, and by how much (m or rad, m/s or rad/s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Open {
    Position { part: usize, by: f64 },
    Velocity { part: usize, by: f64 },
}

/// Loops and couplings over a tree of bodies.
pub(super) struct Closing<'a> {
    bodies: &'a [Body],
    parts: &'a Parts,
    /// Joint and slot of every coordinate.
    coordinates: Vec<(usize, usize)>,
    /// The part that each row belongs to.
    owner: Vec<usize>,
}

impl<'a> Closing<'a> {
    pub(super) fn new(bodies: &'a [Body], parts: &'a Parts) -> Closing<'a> {
        let slots = |(i, body): (usize, &Body)| (0..body.joint.kind.degrees_of_freedom()).map(move |slot| (i, slot));
        let loops = parts.loops.iter().enumerate();
        let owner =
            loops.flat_map(|(k, closure)| std::iter::repeat_n(k, closure.locked().iter().filter(|l| **l).count()));
        let couplings = (0..parts.couplings.len()).map(|k| parts.loops.len() + k);
        Closing {
            bodies,
            parts,
            coordinates: bodies.iter().enumerate().flat_map(slots).collect(),
            owner: owner.chain(couplings).collect(),
        }
    }

    /// Solves for what is not given.
    pub(super) fn close(&self, theta: &mut [JointCoordinates], given: &[Given]) -> Result<(), Open> {
        if self.owner.is_empty() {
            return Ok(());
        }
        self.close_positions(theta, given)?;
        self.close_velocities(theta, given)
    }

    /// The rank of the rows at a configuration, part by part: each row is orthogonalised against those before it.
    pub(super) fn mobility(&self, theta: &[JointCoordinates]) -> Mobility {
        let mut redundant = vec![0; self.parts.loops.len() + self.parts.couplings.len()];
        let mut basis: Vec<DVector<f64>> = Vec::new();
        if !self.owner.is_empty() {
            let jacobian = self.jacobian(theta);
            let largest = jacobian.row_iter().map(|row| row.norm()).fold(0.0, f64::max);
            for (row, owner) in jacobian.row_iter().zip(&self.owner) {
                let mut rest = row.transpose();
                for _ in 0..2 {
                    for direction in &basis {
                        let along = direction.dot(&rest);
                        rest.axpy(-along, direction, 1.0);
                    }
                }
                let length = rest.norm();
                if length > RANK * largest {
                    basis.push(rest / length);
                } else {
                    redundant[*owner] += 1;
                }
            }
        }
        Mobility { tree: self.coordinates.len(), rows: self.owner.len(), rank: basis.len(), redundant }
    }

    fn close_positions(&self, theta: &mut [JointCoordinates], given: &[Given]) -> Result<(), Open> {
        let free = self.open_coordinates(|i| !given[i].position);
        let mut nearest: Option<(f64, Open)> = None;
        for start in 0..STARTS {
            let mut trial = theta.to_vec();
            self.scatter(&mut trial, &free, start);
            match self.newton(&mut trial, &free) {
                Ok(()) => {
                    theta.copy_from_slice(&trial);
                    return Ok(());
                }
                Err((size, open)) => {
                    if nearest.is_none_or(|(least, _)| size < least) {
                        nearest = Some((size, open));
                    }
                }
            }
            if free.is_empty() {
                break;
            }
        }
        nearest.map_or(Ok(()), |(_, open)| Err(open))
    }

    /// Moves the open coordinates away from where they are left by default, farther with every start: the first starts
    /// there, and where the rows are singular the next ones are not. The same in every run.
    fn scatter(&self, theta: &mut [JointCoordinates], free: &[usize], start: usize) {
        let reach = 3.0 * start as f64 / STARTS as f64;
        for (n, &column) in free.iter().enumerate() {
            let (i, slot) = self.coordinates[column];
            let phase = (n + 1) as f64 * PHASES.0 + start as f64 * PHASES.1;
            theta[i].position[slot] += reach * phase.sin();
        }
    }

    fn newton(&self, theta: &mut [JointCoordinates], free: &[usize]) -> Result<(), (f64, Open)> {
        let (mut closed_before, mut least) = (false, f64::INFINITY);
        let mut since_progress = 0;
        for _ in 0..STEPS {
            let residual = self.position_residual(theta);
            let (part, by) = self.largest(&residual);
            if !by.is_finite() {
                return Err((f64::INFINITY, Open::Position { part, by }));
            }
            let closed = by <= CLOSED * self.length();
            since_progress = if by < PROGRESS * least { 0 } else { since_progress + 1 };
            least = least.min(by);
            // Two more steps after the first closed one reach roundoff.
            if (closed && closed_before && since_progress > 0) || (closed && free.is_empty()) {
                return Ok(());
            }
            if since_progress > STAGNATION || free.is_empty() {
                return Err((by, Open::Position { part, by }));
            }
            closed_before = closed;
            let jacobian = self.jacobian(theta).select_columns(free);
            let Some(mut step) = least_norm(jacobian, &residual) else {
                return Err((by, Open::Position { part, by }));
            };
            let longest = step.amax();
            if longest > LONGEST_STEP {
                step *= LONGEST_STEP / longest;
            }
            for (&column, change) in free.iter().zip(step.iter()) {
                self.turn(theta, column, -change);
            }
        }
        let (part, by) = self.largest(&self.position_residual(theta));
        if by <= CLOSED * self.length() { Ok(()) } else { Err((by, Open::Position { part, by })) }
    }

    fn close_velocities(&self, theta: &mut [JointCoordinates], given: &[Given]) -> Result<(), Open> {
        let free = self.open_coordinates(|i| !given[i].velocity);
        let jacobian = self.jacobian(theta);
        let fast = theta.iter().flat_map(|t| t.velocity).fold(0.0, |a: f64, b| a.max(b.abs()));
        for _ in 0..2 {
            let rates = DVector::from_iterator(
                self.coordinates.len(),
                self.coordinates.iter().map(|&(i, slot)| theta[i].velocity[slot]),
            );
            let residual = &jacobian * rates;
            let Some(step) = least_norm(jacobian.select_columns(&free), &residual) else { break };
            for (&column, change) in free.iter().zip(step.iter()) {
                let (i, slot) = self.coordinates[column];
                theta[i].velocity[slot] -= change;
            }
        }
        let rates = self.coordinates.iter().map(|&(i, slot)| theta[i].velocity[slot]);
        let residual = &jacobian * DVector::from_iterator(self.coordinates.len(), rates);
        let (part, by) = self.largest(&residual);
        if by <= CLOSED * self.length() * fast { Ok(()) } else { Err(Open::Velocity { part, by }) }
    }

    fn open_coordinates(&self, open: impl Fn(usize) -> bool) -> Vec<usize> {
        (0..self.coordinates.len()).filter(|&column| open(self.coordinates[column].0)).collect()
    }

    /// A length of the system, at least 1: rows hold angles too.
    fn length(&self) -> f64 {
        let reach = |body: &Body| {
            body.joint.in_parent.translation.vector.norm() + body.joint.in_child.translation.vector.norm()
        };
        self.bodies.iter().map(reach).fold(1.0, f64::max)
    }

    fn largest(&self, residual: &DVector<f64>) -> (usize, f64) {
        let mut worst = (0, 0.0);
        for (value, owner) in residual.iter().zip(&self.owner) {
            if !(value.abs() <= worst.1) {
                worst = (*owner, value.abs());
            }
        }
        worst
    }

    /// `phi(theta)`, m and rad.
    fn position_residual(&self, theta: &[JointCoordinates]) -> DVector<f64> {
        let state = forward_kinematics(self.bodies, theta);
        let loops = self.parts.loops.iter().flat_map(|closure| closure.residual(&state).0);
        let couplings = self.parts.couplings.iter().map(|coupling| {
            let (follower, source) = (theta[coupling.follower].position[0], theta[coupling.source].position[0]);
            follower - coupling.multiplier * source - coupling.offset
        });
        DVector::from_iterator(self.owner.len(), loops.chain(couplings))
    }

    /// `J`: a column is what the rows see of a unit velocity of one coordinate.
    fn jacobian(&self, theta: &[JointCoordinates]) -> DMatrix<f64> {
        let mut moving: Vec<JointCoordinates> =
            theta.iter().map(|t| JointCoordinates { position: t.position, velocity: [0.0; 6] }).collect();
        let mut jacobian = DMatrix::zeros(self.owner.len(), self.coordinates.len());
        for (column, &(i, slot)) in self.coordinates.iter().enumerate() {
            moving[i].velocity[slot] = 1.0;
            let state = forward_kinematics(self.bodies, &moving);
            let loops = self.parts.loops.iter().flat_map(|closure| closure.residual(&state).1);
            let couplings = self.parts.couplings.iter().map(|coupling| {
                moving[coupling.follower].velocity[0] - coupling.multiplier * moving[coupling.source].velocity[0]
            });
            for (row, value) in loops.chain(couplings).enumerate() {
                jacobian[(row, column)] = value;
            }
            moving[i].velocity[slot] = 0.0;
        }
        jacobian
    }

    /// Changes a coordinate by a small amount, in the sense of its velocity.
    fn turn(&self, theta: &mut [JointCoordinates], column: usize, change: f64) {
        let (i, slot) = self.coordinates[column];
        let rotation = self.bodies[i].joint.kind.rotation_vector_index().filter(|first| slot >= *first);
        let Some(rotation) = rotation else {
            theta[i].position[slot] += change;
            return;
        };
        let vector = Vector3::from_column_slice(&theta[i].position[rotation..rotation + 3]);
        let mut by = Vector3::zeros();
        by[slot - rotation] = change;
        let turned = UnitQuaternion::from_scaled_axis(by) * UnitQuaternion::from_scaled_axis(vector);
        theta[i].position[rotation..rotation + 3].copy_from_slice(turned.scaled_axis().as_slice());
    }
}

/// The solution of least norm of `a x = b` in the sense of least squares. `None` where there is nothing to solve for.
fn least_norm(a: DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    if a.ncols() == 0 || !a.iter().all(|x| x.is_finite()) {
        return None;
    }
    let svd = a.svd(true, true);
    let largest = svd.singular_values.iter().fold(0.0, |a: f64, b| a.max(*b));
    svd.solve(b, RANK * largest).ok()
}
