//! What failures are named by, and what their messages say.

use crate::mechanics::System;
use crate::variational::Failure;

/// What failures are named by.
pub(super) struct Names {
    pub bodies: Vec<String>,
    pub joints: Vec<String>,
    /// Loops, then couplings, then springs between points.
    pub bonds: Vec<String>,
    /// The first of the springs among them.
    pub first_spring: usize,
}

impl Names {
    pub(super) fn of(system: &System) -> Names {
        let parts = &system.parts;
        let joint = |body: usize| &system.bodies[body].joint.name;
        let loops = parts.loops.iter().map(|closure| format!("loop '{}'", closure.name));
        let couplings = parts.couplings.iter().map(|c| format!("the mimic of joint '{}'", joint(c.follower)));
        let springs = (0..parts.point_springs.len()).map(|i| format!("spring {i} between points"));
        Names {
            bodies: system.bodies.iter().map(|b| b.name.clone()).collect(),
            joints: system.bodies.iter().map(|b| b.joint.name.clone()).collect(),
            bonds: loops.chain(couplings).chain(springs).collect(),
            first_spring: parts.loops.len() + parts.couplings.len(),
        }
    }
}

/// A failure with names, time and remedy.
pub(super) fn describe(failure: Failure, time: f64, step: f64, names: &Names) -> String {
    match failure {
        Failure::Rotation { body, angle } => format!(
            "t = {time:.6} s: body '{}' turns by h |Omega| = {angle:.3} rad in one step of {step} s, too far for the \
             Moser-Veselov equation; take a step below {:.1e} s, or rotation=auto",
            names.bodies[body],
            0.5 * step / angle
        ),
        Failure::Constraint { joint, rounds, residual } => format!(
            "t = {time:.6} s: joint '{}' does not close after {rounds} rounds, residual {residual:.1e} m at a step of \
             {step} s; take a smaller step",
            names.joints[joint]
        ),
        Failure::Loop { index, rounds, residual } if index >= names.first_spring => format!(
            "t = {time:.6} s: {} does not settle in {rounds} rounds, {residual:.1e} m at a step of {step} s, as where \
             its points would pass each other within the step; take a smaller step",
            names.bonds[index]
        ),
        Failure::Loop { index, rounds, residual } => format!(
            "t = {time:.6} s: {} does not close after {rounds} rounds, residual {residual:.1e} m at a step of {step} \
             s; take a smaller step",
            names.bonds[index]
        ),
        Failure::Leap { gained } => format!(
            "t = {time:.6} s: a step of {step} s goes to a false solution only, with {gained:.2} of the kinetic \
             energy from nowhere; take a smaller step"
        ),
        Failure::Stalled { step } => format!(
            "t = {time:.6} s: a step of {step:.1e} s is too short for the time to advance; take a larger tol or step"
        ),
        Failure::NoStep { step, energy, missed } => format!(
            "t = {time:.6} s: no step near the last one keeps the discrete energy of {energy:.6e} J; the nearest, of \
             {step:.3e} s, misses it by {:.1e} J, as before a turning point, where it does not depend on the step; \
             use method=rattle, or a smaller step to come nearer",
            missed.abs()
        ),
        Failure::Singular { joint } => format!(
            "t = {time:.6} s: joint '{}' can move without moving any mass; give the links behind it mass and inertia",
            names.joints[joint]
        ),
        Failure::NotFinite { body } => {
            format!("t = {time:.6} s: the state of body '{}' is not a number at a step of {step} s", names.bodies[body])
        }
    }
}
