//! What a kind of joint is: the motions that it leaves free, and its coordinates.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// The motions that a joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// One angle about z (URDF `revolute` and `continuous`).
    Revolute,
    /// One length along z.
    Prismatic,
    /// Lengths along x and y, and the angle about z.
    Planar,
    /// A rotation vector; its velocity is the relative angular velocity in the parent's joint frame.
    Spherical,
    /// Lengths along x, y, z, then a rotation vector; velocities in the parent's joint frame.
    Floating,
}

/// What a coordinate of a joint measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Coordinate {
    /// m
    Length,
    /// An angle about one axis, rad.
    Angle,
    /// Three numbers, rad.
    RotationVector,
}

impl JointKind {
    /// Which components of a relative twist (linear x, y, z, angular x, y, z) are free.
    pub const fn free(self) -> [bool; 6] {
        match self {
            JointKind::Revolute => [false, false, false, false, false, true],
            JointKind::Prismatic => [false, false, true, false, false, false],
            JointKind::Planar => [true, true, false, false, false, true],
            JointKind::Spherical => [false, false, false, true, true, true],
            JointKind::Floating => [true; 6],
        }
    }

    /// Number of coordinates, and of velocities.
    pub const fn degrees_of_freedom(self) -> usize {
        match self {
            JointKind::Revolute | JointKind::Prismatic => 1,
            JointKind::Planar | JointKind::Spherical => 3,
            JointKind::Floating => 6,
        }
    }

    /// Pose of the child's joint frame in the parent's at the given coordinates.
    pub(crate) fn transform(self, position: &[f64; 6]) -> Isometry3<f64> {
        let [a, b, c, d, e, f] = *position;
        let about_z = |angle| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        match self {
            JointKind::Revolute => Isometry3::from_parts(Translation3::identity(), about_z(a)),
            JointKind::Prismatic => Isometry3::translation(0.0, 0.0, a),
            JointKind::Planar => Isometry3::from_parts(Translation3::new(a, b, 0.0), about_z(c)),
            JointKind::Spherical => Isometry3::rotation(Vector3::new(a, b, c)),
            JointKind::Floating => Isometry3::new(Vector3::new(a, b, c), Vector3::new(d, e, f)),
        }
    }

    /// The relative twist (linear, angular; axes of the parent's joint frame) of the given coordinate velocities.
    pub(super) fn relative_twist(self, velocity: &[f64; 6]) -> (Vector3<f64>, Vector3<f64>) {
        let mut twist = [0.0; 6];
        let free = self.free();
        for (value, slot) in velocity.iter().zip((0..6).filter(|&i| free[i])) {
            twist[slot] = *value;
        }
        (Vector3::new(twist[0], twist[1], twist[2]), Vector3::new(twist[3], twist[4], twist[5]))
    }

    /// The coordinates of a relative pose, and what of it the joint does not allow: a length in m and an angle in rad
    /// for each of the three axes.
    pub(super) fn decompose(self, relative: &Isometry3<f64>) -> ([f64; 6], [f64; 6]) {
        let t = relative.translation.vector;
        let q = relative.rotation;
        match self {
            JointKind::Revolute => {
                let (angle, tilt) = about_z(&q);
                ([angle, 0., 0., 0., 0., 0.], [t.x, t.y, t.z, tilt[0], tilt[1], 0.])
            }
            JointKind::Prismatic => {
                let r = q.scaled_axis();
                ([t.z, 0., 0., 0., 0., 0.], [t.x, t.y, 0., r.x, r.y, r.z])
            }
            JointKind::Planar => {
                let (angle, tilt) = about_z(&q);
                ([t.x, t.y, angle, 0., 0., 0.], [0., 0., t.z, tilt[0], tilt[1], 0.])
            }
            JointKind::Spherical => {
                let r = q.scaled_axis();
                ([r.x, r.y, r.z, 0., 0., 0.], [t.x, t.y, t.z, 0., 0., 0.])
            }
            JointKind::Floating => {
                let r = q.scaled_axis();
                ([t.x, t.y, t.z, r.x, r.y, r.z], [0.; 6])
            }
        }
    }

    /// What the coordinates measure, each with the place of its first number.
    pub(crate) const fn coordinates(self) -> &'static [(usize, Coordinate)] {
        use Coordinate::{Angle, Length, RotationVector};
        match self {
            JointKind::Revolute => &[(0, Angle)],
            JointKind::Prismatic => &[(0, Length)],
            JointKind::Planar => &[(0, Length), (1, Length), (2, Angle)],
            JointKind::Spherical => &[(0, RotationVector)],
            JointKind::Floating => &[(0, Length), (1, Length), (2, Length), (3, RotationVector)],
        }
    }

    /// Place of the coordinate that is an angle about one axis and so can be unwrapped.
    pub(crate) fn angle_index(self) -> Option<usize> {
        self.place_of(Coordinate::Angle)
    }

    /// Place of the first of three numbers that are a rotation vector.
    pub(crate) fn rotation_vector_index(self) -> Option<usize> {
        self.place_of(Coordinate::RotationVector)
    }

    fn place_of(self, wanted: Coordinate) -> Option<usize> {
        self.coordinates().iter().find(|(_, coordinate)| *coordinate == wanted).map(|(place, _)| *place)
    }

    /// Whether nothing is held: there is no constraint.
    pub(crate) fn is_free(self) -> bool {
        self.degrees_of_freedom() == 6
    }

    /// Whether the motions have an axis: the joint frame's z axis then lies along that of the model.
    pub(crate) const fn has_axis(self) -> bool {
        match self {
            JointKind::Revolute | JointKind::Prismatic | JointKind::Planar => true,
            JointKind::Spherical | JointKind::Floating => false,
        }
    }
}

/// Splits a rotation into one about z by an angle in (-pi, pi] and the tilt of the z axis (rotation vector, x and y).
fn about_z(q: &UnitQuaternion<f64>) -> (f64, [f64; 2]) {
    let angle = 2.0 * q.k.atan2(q.w);
    let wrapped = if angle > std::f64::consts::PI {
        angle - TAU
    } else if angle <= -std::f64::consts::PI {
        angle + TAU
    } else {
        angle
    };
    // q = q_tilt q_z, where q_tilt has no z part: its vector part is (x w - y z, y w + x z) / |(w, z)|.
    let norm = q.k.hypot(q.w);
    if norm == 0.0 {
        return (wrapped, [std::f64::consts::PI, 0.0]);
    }
    let (sx, sy) = ((q.i * q.w - q.j * q.k) / norm, (q.j * q.w + q.i * q.k) / norm);
    let half_sine = sx.hypot(sy);
    let stretch = if half_sine > 0.0 { 2.0 * half_sine.atan2(norm) / half_sine } else { 2.0 };
    (wrapped, [stretch * sx, stretch * sy])
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [JointKind; 5] =
        [JointKind::Revolute, JointKind::Prismatic, JointKind::Planar, JointKind::Spherical, JointKind::Floating];

    #[test]
    fn free_motions_coordinates_and_their_number_agree() {
        for kind in ALL {
            let free = kind.free();
            let count = |range: std::ops::Range<usize>| range.filter(|&i| free[i]).count();
            let numbers = |wanted: Coordinate, each: usize| {
                each * kind.coordinates().iter().filter(|(_, coordinate)| *coordinate == wanted).count()
            };
            assert_eq!(count(0..6), kind.degrees_of_freedom(), "{kind:?}");
            assert_eq!(count(0..3), numbers(Coordinate::Length, 1), "{kind:?}");
            let turns = numbers(Coordinate::Angle, 1) + numbers(Coordinate::RotationVector, 3);
            assert_eq!(count(3..6), turns, "{kind:?}");
        }
    }

    #[test]
    fn a_pose_is_decomposed_into_the_coordinates_that_it_was_built_from() {
        for kind in ALL {
            let mut theta = [0.0; 6];
            theta[..kind.degrees_of_freedom()]
                .copy_from_slice(&[0.3, -0.4, 0.5, 0.2, -0.1, 0.6][..kind.degrees_of_freedom()]);
            let (found, locked) = kind.decompose(&kind.transform(&theta));
            for k in 0..6 {
                // measured 1.1e-16
                assert!(
                    (found[k] - theta[k]).abs() <= 4e-16 && locked[k].abs() <= 4e-16,
                    "{kind:?} {found:?} {locked:?}"
                );
            }
        }
    }
}
