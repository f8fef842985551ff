//! The free directions of a joint, eliminated: one block a kind of joint.

use nalgebra::{Cholesky, Const, Matrix3, Matrix6, Vector3};

use super::spatial::{Spatial, Wrench};
use crate::mechanics::JointKind;

/// The free directions of a joint, eliminated. Chains are mostly hinges, so what is large stands elsewhere.
#[derive(Clone, Debug)]
pub(super) enum Elimination {
    /// One rotation about `n`.
    Hinge { n: Vector3<f64>, u: Wrench, d_inverse: f64 },
    /// One translation along `n`.
    Slider { n: Vector3<f64>, u: Wrench, d_inverse: f64 },
    /// Three directions.
    Three(Box<Three>),
    /// All six: nothing passes to the parent.
    Free(Box<Cholesky<f64, Const<6>>>),
}

/// Three free directions `s`, eliminated.
#[derive(Clone, Debug)]
pub(super) struct Three {
    pub(super) s: [Spatial; 3],
    pub(super) u: [Wrench; 3],
    pub(super) d_inverse: Matrix3<f64>,
}

impl Elimination {
    /// Room for that of a joint.
    pub(super) fn of(kind: JointKind) -> Elimination {
        let (n, u, d_inverse) = (Vector3::zeros(), Spatial::ZERO, 0.0);
        match kind {
            JointKind::Revolute => Elimination::Hinge { n, u, d_inverse },
            JointKind::Prismatic => Elimination::Slider { n, u, d_inverse },
            JointKind::Planar | JointKind::Spherical => {
                Elimination::Three(Box::new(Three { s: [u; 3], u: [u; 3], d_inverse: Matrix3::zeros() }))
            }
            JointKind::Floating => Elimination::Free(Box::new(Cholesky::pack_dirty(Matrix6::identity()))),
        }
    }
}

/// The articulated inertia along a joint is not positive: the joint can move without moving any mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::variational) struct Singular {
    pub node: usize,
}

/// `1 / d` for a number above `least`.
pub(super) fn reciprocal(d: f64, least: f64) -> Option<f64> {
    (d > least && d.is_finite()).then(|| 1.0 / d)
}

/// Inverse of a positive definite matrix.
pub(super) fn inverse_of_symmetric(d: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    Cholesky::new(*d).map(|c| c.inverse())
}

/// The free directions of a joint with at most three of them, at its joint point; zero where there are fewer. A joint
/// that is free has no need of them.
pub(super) fn directions(kind: JointKind, axes: &Matrix3<f64>) -> [Spatial; 3] {
    let axis = |k: usize| axes.column(k).into_owned();
    let slide = |k| Spatial::new(axis(k), Vector3::zeros());
    let turn = |k| Spatial::new(Vector3::zeros(), axis(k));
    match kind {
        JointKind::Revolute => [turn(2), Spatial::ZERO, Spatial::ZERO],
        JointKind::Prismatic => [slide(2), Spatial::ZERO, Spatial::ZERO],
        JointKind::Planar => [slide(0), slide(1), turn(2)],
        JointKind::Spherical => [turn(0), turn(1), turn(2)],
        JointKind::Floating => [Spatial::ZERO; 3],
    }
}

/// The columns of `[u0 u1 u2] D^-1`.
pub(super) fn combine(u: &[Wrench; 3], d_inverse: &Matrix3<f64>) -> [Wrench; 3] {
    std::array::from_fn(|k| {
        u[0].scaled(d_inverse[(0, k)]) + u[1].scaled(d_inverse[(1, k)]) + u[2].scaled(d_inverse[(2, k)])
    })
}
