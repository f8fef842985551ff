//! Mass properties of an assembly of links in its principal frame.

use nalgebra::{Isometry3, Matrix3, Rotation3, SymmetricEigen, Translation3, UnitQuaternion, Vector3};

use super::assemble::Assembly;
use crate::model::Model;

/// Mass properties of an assembly.
pub(super) struct Principal {
    pub(super) mass: f64,
    /// Principal moments, kg m^2.
    pub(super) moments: Vector3<f64>,
    /// The body frame (centre of mass, principal axes) in the assembly's frame.
    pub(super) body_in_assembly: Isometry3<f64>,
}

/// Adds up the links of an assembly (parallel axis theorem) and diagonalises the sum.
pub(super) fn principal(model: &Model, assembly: &Assembly) -> Principal {
    let inertials =
        || assembly.links.iter().filter_map(|(link, pose)| model.links[*link].inertial.as_ref().map(|i| (i, pose)));
    let mass = inertials().map(|(i, _)| i.mass).fold(0.0, |sum, mass| sum + mass);
    let weighted: Vector3<f64> =
        inertials().map(|(i, pose)| i.mass * (pose * nalgebra::Point3::from(i.com)).coords).sum();
    let com = if mass > 0.0 { weighted / mass } else { Vector3::zeros() };
    let inertia: Matrix3<f64> = inertials()
        .map(|(i, pose)| {
            let r = pose.rotation.to_rotation_matrix();
            let arm = (pose * nalgebra::Point3::from(i.com)).coords - com;
            r * i.inertia * r.transpose() + i.mass * (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose())
        })
        .sum();
    let (moments, axes) = diagonalise(&inertia);
    // Nothing can be divided by what is below the normal numbers: it is none.
    let normal = |x: f64| if x < f64::MIN_POSITIVE { 0.0 } else { x };
    let (mass, moments) = (normal(mass), moments.map(normal));
    Principal { mass, moments, body_in_assembly: Isometry3::from_parts(Translation3::from(com), axes) }
}

/// Principal moments and the rotation from principal axes to the given axes. A tensor that is diagonal already keeps
/// its axes; moments that roundoff made negative become zero.
fn diagonalise(inertia: &Matrix3<f64>) -> (Vector3<f64>, UnitQuaternion<f64>) {
    let off_diagonal = inertia[(0, 1)].abs().max(inertia[(0, 2)].abs()).max(inertia[(1, 2)].abs());
    if off_diagonal <= 1e-14 * inertia.diagonal().amax() {
        return (inertia.diagonal().map(|j| j.max(0.0)), UnitQuaternion::identity());
    }
    let eigen = SymmetricEigen::new(*inertia);
    let mut axes = eigen.eigenvectors;
    if axes.determinant() < 0.0 {
        axes.column_mut(2).neg_mut();
    }
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    (eigen.eigenvalues.map(|j| j.max(0.0)), rotation)
}
