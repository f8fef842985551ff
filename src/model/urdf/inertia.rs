//! Mass properties of a link as read, brought into the link frame and checked.

use nalgebra::{Isometry3, Matrix3, SymmetricEigen, Vector3};

use super::error::Problem;
use crate::model::link::Inertial;

/// A principal moment below `-NEGATIVE` times the largest one is an error; above it, it is roundoff of the file.
const NEGATIVE: f64 = 1e-9;

/// How far the largest moment may exceed the sum of the others, over the largest, before it is remarked: files print
/// six or seven digits.
const TRIANGLE: f64 = 1e-6;

/// Mass properties in the link frame: centre of mass at the origin of `origin`, inertia `R I R^T` with its rotation.
///
/// `None` for a link whose mass and inertia are zero. Remarks are added to `remarks`.
///
/// # Errors
/// Negative mass, inertia without mass, a negative principal moment.
pub(super) fn inertial(
    link: &str,
    mass: f64,
    origin: &Isometry3<f64>,
    inertia: Matrix3<f64>,
    remarks: &mut Vec<String>,
) -> Result<Option<Inertial>, Problem> {
    if mass < 0.0 {
        return Err(Problem::NegativeMass { link: link.to_owned(), value: mass });
    }
    if mass == 0.0 {
        let massless = inertia == Matrix3::zeros();
        return if massless { Ok(None) } else { Err(Problem::InertiaWithoutMass { link: link.to_owned() }) };
    }
    let moments = principal_moments(&inertia);
    if moments[0] < -NEGATIVE * moments[2].abs().max(moments[0].abs()) {
        let others = [moments[1], moments[2]];
        return Err(Problem::NegativeMoment { link: link.to_owned(), moment: moments[0], others });
    }
    let excess = moments[2] - moments[1] - moments[0];
    if moments[2] == 0.0 {
        remarks.push(format!("link '{link}': inertia is zero, so the link is a point mass"));
    } else if excess > TRIANGLE * moments[2] {
        remarks.push(format!(
            "link '{link}': principal moments of inertia {:.6e}, {:.6e}, {:.6e} kg m^2 break the triangle inequality, \
             so no body has them; they are used as written",
            moments[0], moments[1], moments[2]
        ));
    }
    let rotation = origin.rotation.to_rotation_matrix();
    let turned = rotation * inertia * rotation.transpose();
    let inertia = (turned + turned.transpose()) / 2.0;
    Ok(Some(Inertial { mass, com: origin.translation.vector, inertia }))
}

/// Eigenvalues of a symmetric tensor, smallest first. A diagonal tensor is not passed through the iteration.
fn principal_moments(inertia: &Matrix3<f64>) -> Vector3<f64> {
    let diagonal = inertia.diagonal();
    let mut moments = if *inertia == Matrix3::from_diagonal(&diagonal) {
        diagonal
    } else {
        SymmetricEigen::new(*inertia).eigenvalues
    };
    moments.as_mut_slice().sort_by(f64::total_cmp);
    moments
}

/// Sum of mass properties in one frame: masses add, inertia moves to the common centre by the parallel axis theorem.
pub(super) fn sum(parts: &[Inertial]) -> Option<Inertial> {
    let mass: f64 = parts.iter().map(|p| p.mass).sum();
    if mass <= 0.0 {
        return None;
    }
    let com = parts.iter().map(|p| p.mass * p.com).sum::<Vector3<f64>>() / mass;
    let about_com = |p: &Inertial| {
        let arm = p.com - com;
        p.inertia + p.mass * (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose())
    };
    Some(Inertial { mass, com, inertia: parts.iter().map(about_com).sum() })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use approx::assert_relative_eq;
    use nalgebra::{Translation3, UnitQuaternion};

    use super::*;

    fn turned(roll: f64, pitch: f64, yaw: f64) -> Isometry3<f64> {
        Isometry3::from_parts(Translation3::new(1.0, 2.0, 3.0), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
    }

    #[test]
    fn inertial_rpy_turns_the_tensor() {
        let tensor = Matrix3::from_diagonal(&Vector3::new(2.0, 3.0, 4.0));
        let read = inertial("a", 1.0, &turned(0.0, 0.0, FRAC_PI_2), tensor, &mut Vec::new()).unwrap().unwrap();
        // A quarter turn about z: the inertial frame's x axis points along the link's y.
        assert_relative_eq!(read.inertia, Matrix3::from_diagonal(&Vector3::new(3.0, 2.0, 4.0)), epsilon = 1e-15);
        assert_eq!(read.com, Vector3::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn off_diagonal_inertia_keeps_its_invariants_under_rotation() {
        let tensor = Matrix3::new(2.0, 0.3, -0.2, 0.3, 2.5, 0.1, -0.2, 0.1, 3.0);
        let read = inertial("a", 1.0, &turned(0.4, -1.1, 2.0), tensor, &mut Vec::new()).unwrap().unwrap();
        assert_relative_eq!(read.inertia.trace(), tensor.trace(), epsilon = 1e-14);
        assert_relative_eq!(read.inertia.determinant(), tensor.determinant(), epsilon = 1e-13);
        assert!((read.inertia - tensor).norm() > 0.1);
    }

    #[test]
    fn a_broken_triangle_inequality_is_remarked_and_kept() {
        let tensor = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 3.0));
        let mut remarks = Vec::new();
        let read = inertial("a", 1.0, &Isometry3::identity(), tensor, &mut remarks).unwrap().unwrap();
        assert_eq!(read.inertia, tensor);
        assert_eq!(
            remarks,
            ["link 'a': principal moments of inertia 1.000000e0, 1.000000e0, 3.000000e0 kg m^2 break the triangle \
              inequality, so no body has them; they are used as written"]
        );
    }

    #[test]
    fn roundoff_below_zero_is_no_error() {
        let tensor = Matrix3::from_diagonal(&Vector3::new(-1e-12, 1.0, 1.0));
        assert!(inertial("a", 1.0, &Isometry3::identity(), tensor, &mut Vec::new()).is_ok());
        let tensor = Matrix3::from_diagonal(&Vector3::new(-1e-6, 1.0, 1.0));
        assert!(inertial("a", 1.0, &Isometry3::identity(), tensor, &mut Vec::new()).is_err());
    }

    #[test]
    fn two_halves_make_a_whole_rod() {
        let half = |x: f64| Inertial {
            mass: 0.5,
            com: Vector3::new(x, 0.0, 0.0),
            inertia: Matrix3::from_diagonal(&Vector3::new(0.0, 0.5 * 0.25 / 12.0, 0.5 * 0.25 / 12.0)),
        };
        let whole = sum(&[half(0.25), half(0.75)]).unwrap();
        assert_eq!((whole.mass, whole.com), (1.0, Vector3::new(0.5, 0.0, 0.0)));
        let expected = Matrix3::from_diagonal(&Vector3::new(0.0, 1.0 / 12.0, 1.0 / 12.0));
        assert_relative_eq!(whole.inertia, expected, epsilon = 1e-16);
    }
}
