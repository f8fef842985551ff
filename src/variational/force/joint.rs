//! Springs, dampers and drives in the coordinates of joints.
//!
//! With the change `d = theta1 - theta0` of a joint's coordinate over a step and `Delta0 = theta0 - rest`, the discrete
//! Lagrangian and the discrete force (Marsden and West 2001, sections 3.2 and 4.1) are
//!
//! ```text
//! L_d:  -h V(theta_m, t_m) ,   V = k/2 (theta_m - rest)^2 - u(t_m) theta_m ,
//!       theta_m = theta0 + d/2 ,   t_m = t0 + h/2
//! F_d:  -c d/2  at either end ,
//! ```
//!
//! so that each half kick carries the same impulse along the joint,
//!
//! ```text
//! S . w = h/2 (u(t_m) - k Delta0) - (h k/4 + c/2) d .                                                     (1)
//! ```
//!
//! A damper that is fast beside the step needs more: with the impulse (1) at both ends the velocity at the end of a
//! step keeps the error `O(h^2)` of the step before with its sign turned, and the power `c thetadot^2` that it stands
//! for is beyond all bounds. So a part `w` of the damper's impulse in the second half kick goes with the velocity at
//! the end, which the projection finds,
//!
//! ```text
//! S . w1 = h/2 (u(t_m) - k Delta0) - (h k/4 + (1 - w) c/2) d - w h c/2 thetadot1 ,                      (2)
//! w = max(0, 1 - 1/z^2) ,   z = h c / J
//! ```
//!
//! with `J` the articulated inertia along the joint at the start. A velocity along the joint decays by `1 / (1 +
//! z/2)^2` a step as `z` grows, and not by -1. Where the damper's rate `c / J` is below `1/h` nothing changes, so that
//! the order stays 2.
//!
//! The quadrature is the midpoint rule, in position and in time: of order 2, and its own adjoint, so that the step
//! stays time-reversible and composes to higher order. A substep backwards in time evaluates the drive at its own
//! midpoint.
//!
//! (1) is solved with the joint's constraint, for `w`: a change of `w` moves the joint through the tree, whose block
//! `D` grows by `h (h k/4 + c/2)`. The impulse along the joint stays of the size of the load however large `k` is, and
//! as `k -> infinity` it becomes the impulse with which a rigid joint holds its coordinate: the stiff limit is well
//! conditioned. The deflection `Delta`, and not the angle, is carried as a compensated sum of the changes `d`, so that
//! `k` multiplies its roundoff and not that of the angle.

use nalgebra::{SVector, Vector3};

use crate::mechanics::coordinates::CoordinateTracker;
use crate::mechanics::{Drive, JointSpring, State, System};
use crate::numeric::Compensated;
use crate::variational::chain::{JointFrame, Node, wrench_of_coordinates};
use crate::variational::tree::spatial::Wrench;

/// What acts along the coordinates of one joint. Springs and drives act in joints of one coordinate.
#[derive(Clone, Debug)]
pub(in crate::variational) struct JointForce {
    /// N m/rad or N/m, all springs of the joint together.
    stiffness: f64,
    /// N m s/rad or N s/m, for each coordinate: the joint's own and that of its springs.
    damping: f64,
    /// `Delta`: the coordinate less the position in which the springs hold each other, rad or m.
    deflection: Compensated<1>,
    drives: Vec<Drive>,
    /// `h/2 (u(t_m) - k Delta0)`
    constant: f64,
    /// `h k/4 + c/2`
    slope: f64,
    /// `d`
    travel: Vector3<f64>,
    /// `S . w` of the last step, N m s or N s.
    impulse: Vector3<f64>,
    /// `J` of (2), kg m^2 or kg.
    inertia: f64,
    /// `w c/2`
    late: f64,
}

/// The joints' forces, one entry a joint that has any. Writes their places into the nodes.
pub(in crate::variational) fn joint_forces(system: &System, state: &State, nodes: &mut [Node]) -> Vec<JointForce> {
    let mut tracker = CoordinateTracker::new(system);
    tracker.update(system, state, 0.0);
    let mut all = Vec::new();
    for i in 0..system.bodies.len() {
        let drives: Vec<Drive> = system.parts.drives.iter().filter(|drive| drive.body == i).cloned().collect();
        let JointSpring { stiffness, damping, rest, .. } = system.joint_spring(i);
        if stiffness == 0.0 && damping == 0.0 && drives.is_empty() {
            continue;
        }
        let theta = settled(tracker.joints[i].position[0], system.initial_coordinates[i].position[0]);
        nodes[i + 1].force = Some(all.len());
        all.push(JointForce {
            stiffness,
            damping,
            deflection: Compensated::new(SVector::<f64, 1>::new(theta - rest)),
            drives,
            constant: 0.0,
            slope: 0.0,
            travel: Vector3::zeros(),
            impulse: Vector3::zeros(),
            inertia: f64::INFINITY,
            late: 0.0,
        });
    }
    all
}

/// The position that the scene gave, where the one that the poses show is the same to roundoff.
fn settled(found: f64, given: f64) -> f64 {
    if (found - given).abs() <= 8.0 * f64::EPSILON * given.abs().max(1.0) { given } else { found }
}

impl JointForce {
    /// A planted fault: the damper's sign.
    pub(in crate::variational) fn push_instead_of_damping(&mut self) {
        self.damping = -self.damping;
    }

    /// Whether the force depends on the motion of the step, and so adds to `D`.
    pub(in crate::variational) fn is_implicit(&self) -> bool {
        self.stiffness > 0.0 || self.damping > 0.0
    }

    /// Takes in the articulated inertia along the joint at the start, kg m^2 or kg.
    pub(in crate::variational) fn start(&mut self, inertia: f64) {
        self.inertia = inertia;
    }

    /// Prepares (1) and (2) for a step of size `h` from `time`.
    pub(in crate::variational) fn begin(&mut self, time: f64, h: f64) {
        let effort: f64 = self.drives.iter().map(|drive| drive.at(time + 0.5 * h)).sum();
        self.constant = 0.5 * h * (effort - self.stiffness * self.deflection.value.x);
        self.slope = 0.25 * h * self.stiffness + 0.5 * self.damping;
        let z = h * self.damping / self.inertia;
        self.late = 0.5 * self.damping * (1.0 - 1.0 / (z * z)).max(0.0);
    }

    /// What it adds to `D` in the projection at the end of a step of size `h`, by (2).
    pub(in crate::variational) fn late(&self, h: f64) -> f64 {
        h * self.late
    }

    /// What it adds to `D` in a step of size `h`.
    pub(in crate::variational) fn implicit(&self, h: f64) -> f64 {
        h * self.slope
    }

    /// Takes in the change of the coordinates with the wrench `w` on the child. Returns by how much `S . w` exceeds
    /// (1).
    pub(in crate::variational) fn excess(&mut self, travel: Vector3<f64>, impulse: Vector3<f64>) -> Vector3<f64> {
        (self.travel, self.impulse) = (travel, impulse);
        let mut excess = impulse + self.slope * travel;
        excess.x -= self.constant;
        excess
    }

    /// Takes over the state of the same force in another copy of the integrator.
    pub(in crate::variational) fn copy_from(&mut self, other: &JointForce) {
        self.deflection = other.deflection;
        (self.travel, self.impulse, self.late) = (other.travel, other.impulse, other.late);
    }

    /// Accepts the step that was tried last.
    pub(in crate::variational) fn end(&mut self) {
        self.deflection.add(&SVector::<f64, 1>::new(self.travel.x));
    }

    /// Work on the system in the step of size `h` that was tried last, J.
    pub(in crate::variational) fn work(&self, h: f64) -> f64 {
        2.0 / h * self.impulse.dot(&self.travel)
    }

    /// The potential of the springs in the middle of the last step, `k/2 (Delta0 + d/2)^2`, J.
    pub(in crate::variational) fn potential(&self) -> f64 {
        0.5 * self.stiffness * (self.deflection.value.x - 0.5 * self.travel.x).powi(2)
    }

    /// The impulse of the second half kick, on the child about its joint point, but for what goes with the velocity at
    /// the end.
    pub(in crate::variational) fn second_half(&self, node: &Node, frame: &JointFrame) -> Wrench {
        wrench_of_coordinates(node, frame, &(self.impulse + self.late * self.travel))
    }
}
