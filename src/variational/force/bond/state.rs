//! A bond and its state.

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use crate::model::scene::LoopKind;
use crate::numeric::Compensated3;
use crate::variational::chain::Node;
use crate::variational::tree::spatial::{Spatial, Twist};

/// What a bond is.
#[derive(Clone, Debug)]
pub(super) enum Kind {
    /// A joint between two nodes of the tree. `ball` is the same as a ball joint where all motion is locked: the linear
    /// part of the lock is the ball joint's then, the angular part that of `joint`, a slider.
    Loop { kind: LoopKind, joint: Box<Node>, ball: Option<Box<Node>> },
    /// `theta(follower) - multiplier theta(source)` stays what it is.
    Coupling { source: usize, multiplier: f64 },
    /// A spring from the parent's point to the child's: one row along the way between them.
    Spring { from: Vector3<f64>, to: Vector3<f64>, stiffness: f64, damping: f64, rest: f64 },
    /// The same with the rest length 0: three rows along the world's axes, and one along the way if there is a damper.
    Pull { from: Vector3<f64>, to: Vector3<f64>, stiffness: f64, damping: f64 },
}

/// The largest `beta` with which the points of a spring may pass each other within a step: two bodies that pass on a
/// line for 20 000 steps change their energy by up to 0.2 at a `beta` of 0.01, by up to 0.05 at 1e-4, and without bound
/// from 0.16 on.
const PASS: f64 = 0.01;

/// The largest compliance of a row, m/(N s^2): its square root stays a number.
const SLACK: f64 = 1e200;

/// Rows of a spring, at most.
const SPRING_ROWS: usize = 4;

/// A bond, and where it is at the start of the step.
#[derive(Clone, Debug)]
pub(in crate::variational) struct Bond {
    pub(super) kind: Kind,
    pub(super) child: usize,
    pub(super) parent: usize,
    /// The rows `first..first + count`.
    pub(super) first: usize,
    pub(super) count: usize,
    /// From the bodies' centres of mass to the joint point or the springs' points, and the joint's axes.
    pub(super) arm: Vector3<f64>,
    pub(super) parent_arm: Vector3<f64>,
    pub(super) axes: Matrix3<f64>,
    /// The part of a loop's mismatch that the next step takes away.
    pub(super) gap0: Twist,
    /// The way from a spring's first point to its second, m.
    pub(super) span: Vector3<f64>,
    /// Of a spring how far it is stretched, m, as a vector if its rest length is 0; of a coupling what it is open by,
    /// rad or m.
    pub(super) length: Compensated3,
    /// Change of what each row sees over the step that is being tried. The first three belong to `length`.
    pub(super) change: [f64; SPRING_ROWS],
    /// A spring whose points must not pass each other, and how far apart they are on the far side in the step that is
    /// being tried, m.
    pub(super) stiff: bool,
    pub(super) passed: f64,
}

impl Bond {
    /// A bond between two nodes with its place among the rows, not yet placed.
    pub(super) fn new(kind: Kind, (child, parent): (usize, usize), rows: Range<usize>) -> Bond {
        Bond {
            kind,
            child,
            parent,
            first: rows.start,
            count: rows.len(),
            arm: Vector3::zeros(),
            parent_arm: Vector3::zeros(),
            axes: Matrix3::identity(),
            gap0: Spatial::ZERO,
            span: Vector3::zeros(),
            length: Vector3::zeros().into(),
            change: [0.0; SPRING_ROWS],
            stiff: false,
            passed: 0.0,
        }
    }

    pub(in crate::variational) fn is_spring(&self) -> bool {
        matches!(self.kind, Kind::Spring { .. } | Kind::Pull { .. })
    }

    pub(in crate::variational) fn rows(&self) -> Range<usize> {
        self.first..self.first + self.count
    }

    /// The compliances of a spring's rows over a step.
    pub(in crate::variational) fn compliances(&self, h: f64) -> impl Iterator<Item = f64> {
        (0..self.count).map(move |row| (1.0 / (self.kappa(row, h) * h)).min(SLACK))
    }

    pub(super) fn kappa(&self, row: usize, h: f64) -> f64 {
        match self.kind {
            Kind::Spring { stiffness, damping, .. } => 0.25 * h * stiffness + 0.5 * damping,
            Kind::Pull { stiffness, .. } if row < 3 => 0.25 * h * stiffness,
            Kind::Pull { damping, .. } => 0.5 * damping,
            Kind::Loop { .. } | Kind::Coupling { .. } => f64::INFINITY,
        }
    }

    /// Takes the mobility of a spring's first row, for a step of size `h`.
    pub(in crate::variational) fn measure_stiffness(&mut self, h: f64, mobility: f64) {
        self.stiff = self.kappa(0, h) * h * mobility > PASS;
    }

    /// Takes the stretch of a spring from the positions, before the first step. It is summed up and not the distance,
    /// whose roundoff would be a force of a stiff spring.
    pub(in crate::variational) fn start(&mut self) {
        self.length = self.stretch().into();
    }

    /// By how much a spring's points are farther apart than at rest, from the positions, m.
    pub(super) fn stretch(&self) -> Vector3<f64> {
        match self.kind {
            Kind::Spring { rest, .. } => Vector3::new(self.span.norm() - rest, 0.0, 0.0),
            Kind::Pull { .. } => self.span,
            Kind::Loop { .. } | Kind::Coupling { .. } => Vector3::zeros(),
        }
    }

    /// How fast what a spring's row sees changes over the step that is being tried, m/s.
    pub(in crate::variational) fn rate(&self, row: usize, h: f64) -> f64 {
        self.change[row] / h
    }

    /// By how much the points of a spring pass each other in the step that is being tried where they must not, m.
    pub(in crate::variational) fn passed(&self) -> f64 {
        self.passed
    }

    /// The potential of a spring in the middle of the last step, `k/2 |(D0 + D1)/2|^2` of its stretch `D`, J.
    pub(in crate::variational) fn potential(&self) -> f64 {
        let (stiffness, change) = match self.kind {
            Kind::Spring { stiffness, .. } => (stiffness, Vector3::new(self.change[0], 0.0, 0.0)),
            Kind::Pull { stiffness, .. } => (stiffness, Vector3::new(self.change[0], self.change[1], self.change[2])),
            Kind::Loop { .. } | Kind::Coupling { .. } => return 0.0,
        };
        0.5 * stiffness * (self.length.value - 0.5 * change).norm_squared()
    }

    /// Takes over the state of the same bond in another copy of the integrator.
    pub(in crate::variational) fn copy_from(&mut self, other: &Bond) {
        (self.length, self.change) = (other.length, other.change);
    }

    /// Takes over what the accepted step has changed.
    pub(in crate::variational) fn accept(&mut self, back: f64) {
        let [x, y, z, _] = self.change;
        let change = match self.kind {
            Kind::Loop { .. } => return,
            Kind::Coupling { .. } => Vector3::new(x, 0.0, 0.0),
            Kind::Spring { .. } => Vector3::new(x, 0.0, 0.0) + back * (self.stretch() - self.length.value),
            Kind::Pull { .. } => Vector3::new(x, y, z) + back * (self.stretch() - self.length.value),
        };
        self.length.add(&change);
    }
}
