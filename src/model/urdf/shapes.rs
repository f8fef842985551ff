//! Mass properties of collision shapes filled with a uniform density, by parry.

use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, Vector3};
use parry3d::mass_properties::MassProperties;
use parry3d::math::Vector;

use super::error::Problem;
use super::inertia;
use crate::model::link::{Collision, Inertial, Shape};

/// A mesh whose outward areas add up to more than this part of its surface is not closed.
const OPEN_AREA: f64 = 1e-3;

/// Mass properties in the link frame of all collision shapes of a link, `density` in kg/m^3. `None` without shapes.
///
/// Shapes that overlap count twice. Mesh files are looked for from `folder`, the folder of the URDF.
///
/// # Errors
/// A length that is not positive, a mesh that is missing or has no volume.
pub(super) fn mass_of(
    link: &str,
    collisions: &[Collision],
    density: f64,
    folder: &Path,
    remarks: &mut Vec<String>,
) -> Result<Option<Inertial>, Problem> {
    let mut parts = Vec::with_capacity(collisions.len());
    for collision in collisions {
        let part = shape_mass(link, &collision.shape, density, folder, remarks)?;
        let turn = collision.origin.rotation.to_rotation_matrix();
        parts.push(Inertial {
            mass: part.mass,
            com: collision.origin.transform_point(&part.com.into()).coords,
            inertia: turn * part.inertia * turn.transpose(),
        });
    }
    Ok(inertia::sum(&parts))
}

/// Mass properties of a shape in its own frame.
fn shape_mass(
    link: &str,
    shape: &Shape,
    density: f64,
    folder: &Path,
    remarks: &mut Vec<String>,
) -> Result<Inertial, Problem> {
    let positive = |shape, what, value: f64| {
        let problem = Problem::ShapeSize { link: link.to_owned(), shape, what, value };
        if value > 0.0 { Ok(value) } else { Err(problem) }
    };
    Ok(match shape {
        Shape::Box { half_extents } => {
            for side in half_extents.iter() {
                positive("box", "size", 2.0 * side)?;
            }
            inertial(&MassProperties::from_cuboid(density, Vector::from(half_extents.data.0[0])))
        }
        Shape::Sphere { radius } => {
            inertial(&MassProperties::from_ball(density, positive("sphere", "radius", *radius)?))
        }
        Shape::Cylinder { radius, length } => {
            let radius = positive("cylinder", "radius", *radius)?;
            let half_length = positive("cylinder", "length", *length)? / 2.0;
            y_to_z(inertial(&MassProperties::from_cylinder(density, half_length, radius)))
        }
        Shape::Capsule { radius, length } => {
            let radius = positive("capsule", "radius", *radius)?;
            let end = Vector::new(0.0, positive("capsule", "length", *length)? / 2.0, 0.0);
            y_to_z(inertial(&MassProperties::from_capsule(density, -end, end, radius)))
        }
        Shape::Mesh { filename, scale } => mesh_mass(link, filename, scale, density, folder, remarks)?,
    })
}

fn inertial(mass: &MassProperties) -> Inertial {
    let tensor = mass.reconstruct_inertia_matrix().to_cols_array();
    Inertial {
        mass: mass.mass(),
        com: Vector3::from(mass.local_com.to_array()),
        inertia: Matrix3::from_column_slice(&tensor),
    }
}

/// parry's cylinders and capsules stand along y, those of URDF along z.
fn y_to_z(mut body: Inertial) -> Inertial {
    let moments = body.inertia.diagonal();
    body.inertia = Matrix3::from_diagonal(&Vector3::new(moments.x, moments.z, moments.y));
    body
}

fn mesh_mass(
    link: &str,
    filename: &str,
    scale: &Vector3<f64>,
    density: f64,
    folder: &Path,
    remarks: &mut Vec<String>,
) -> Result<Inertial, Problem> {
    let unusable = |detail: String| Problem::MeshUnusable { link: link.to_owned(), mesh: filename.to_owned(), detail };
    let candidates = mesh_paths(filename, folder);
    let Some(path) = candidates.iter().find(|p| p.is_file()) else {
        let tried = candidates.iter().map(|p| p.display().to_string()).collect();
        return Err(Problem::MeshMissing { link: link.to_owned(), mesh: filename.to_owned(), tried });
    };
    let scene = mesh_loader::Loader::default().load(path).map_err(|e| match e.kind() {
        std::io::ErrorKind::Unsupported => unusable("it is no STL, OBJ or COLLADA file".to_owned()),
        _ => unusable(e.to_string()),
    })?;
    let mut parts = Vec::new();
    for mesh in scene.meshes.iter().filter(|m| !m.faces.is_empty()) {
        let vertices: Vec<Vector> =
            mesh.vertices.iter().map(|v| Vector::from(v.map(f64::from)) * Vector::from(scale.data.0[0])).collect();
        if mesh.faces.iter().flatten().any(|i| *i as usize >= vertices.len()) {
            return Err(unusable("a face names a vertex that is not there".to_owned()));
        }
        let (outward, surface) = areas(&vertices, &mesh.faces);
        if outward > OPEN_AREA * surface {
            remarks.push(format!("link '{link}': collision mesh '{filename}' is not closed; its mass is only rough"));
        }
        parts.push(inertial(&MassProperties::from_trimesh(density, &vertices, &mesh.faces)));
    }
    let whole = inertia::sum(&parts).filter(|m| m.mass.is_finite() && m.inertia.iter().all(|x| x.is_finite()));
    whole.ok_or_else(|| unusable("it encloses no volume".to_owned()))
}

/// Length of the sum of the outward area vectors, zero for a closed surface, and the area, both doubled.
fn areas(vertices: &[Vector], faces: &[[u32; 3]]) -> (f64, f64) {
    let (mut outward, mut surface) = (Vector::ZERO, 0.0);
    for face in faces {
        let [a, b, c] = face.map(|i| vertices[i as usize]);
        let area = (b - a).cross(c - a);
        outward += area;
        surface += area.length();
    }
    (outward.length(), surface)
}

/// Where a mesh may be: beside the URDF; for `package://NAME/REST` in a folder NAME that is or lies in a folder above.
fn mesh_paths(filename: &str, folder: &Path) -> Vec<PathBuf> {
    let Some((scheme, rest)) = filename.split_once("://") else { return vec![folder.join(filename)] };
    if scheme == "file" {
        return vec![PathBuf::from(rest)];
    }
    let package = rest.split_once('/').map_or(rest, |(name, _)| name);
    let inside = rest.split_once('/').map_or("", |(_, inside)| inside);
    let absolute = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let candidates = absolute.ancestors().flat_map(|above| {
        let itself = (above.file_name().is_some_and(|n| n == package)).then(|| above.join(inside));
        itself.into_iter().chain([above.join(rest)])
    });
    let all: Vec<PathBuf> = candidates.collect();
    match all.iter().find(|p| p.is_file()) {
        Some(found) => vec![found.clone()],
        None => vec![folder.join(rest)],
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;
    use nalgebra::{Isometry3, Translation3, UnitQuaternion};

    use super::*;

    fn mass(shape: Shape) -> Inertial {
        let collision = Collision { origin: Isometry3::identity(), shape };
        mass_of("a", &[collision], 1000.0, Path::new("."), &mut Vec::new()).unwrap().unwrap()
    }

    fn diagonal(x: f64, y: f64, z: f64) -> Matrix3<f64> {
        Matrix3::from_diagonal(&Vector3::new(x, y, z))
    }

    #[test]
    fn a_box_weighs_what_the_closed_form_says() {
        let body = mass(Shape::Box { half_extents: Vector3::new(0.05, 0.1, 0.15) });
        assert_relative_eq!(body.mass, 6.0, epsilon = 1e-13);
        let i = |a: f64, b: f64| 6.0 / 12.0 * (a * a + b * b);
        assert_relative_eq!(body.inertia, diagonal(i(0.2, 0.3), i(0.1, 0.3), i(0.1, 0.2)), epsilon = 1e-15);
    }

    #[test]
    fn a_cylinder_stands_along_z() {
        let (r, l) = (0.1, 0.5);
        let body = mass(Shape::Cylinder { radius: r, length: l });
        let m = 1000.0 * PI * r * r * l;
        let side = m * (3.0 * r * r + l * l) / 12.0;
        assert_relative_eq!(body.mass, m, epsilon = 1e-13);
        assert_relative_eq!(body.inertia, diagonal(side, side, m * r * r / 2.0), epsilon = 1e-15);
    }

    #[test]
    fn a_sphere_weighs_what_the_closed_form_says() {
        let body = mass(Shape::Sphere { radius: 0.2 });
        let m = 1000.0 * 4.0 / 3.0 * PI * 0.008;
        let i = 0.4 * m * 0.04;
        assert_relative_eq!(body.mass, m, epsilon = 1e-13);
        assert_relative_eq!(body.inertia, diagonal(i, i, i), epsilon = 1e-15);
    }

    /// Cylinder of length l and two half balls, each with its centre 3r/8 beyond the end of the cylinder.
    #[test]
    fn a_capsule_is_a_cylinder_and_two_half_balls() {
        let (r, l) = (0.1, 0.4);
        let body = mass(Shape::Capsule { radius: r, length: l });
        let cylinder = 1000.0 * PI * r * r * l;
        let ball = 1000.0 * 4.0 / 3.0 * PI * r.powi(3);
        let about_end_plane = 0.4 * ball * r * r;
        let d = 3.0 * r / 8.0;
        let shifted = about_end_plane + ball * ((l / 2.0 + d).powi(2) - d * d);
        let side = cylinder * (3.0 * r * r + l * l) / 12.0 + shifted;
        assert_relative_eq!(body.mass, cylinder + ball, epsilon = 1e-13);
        let along = cylinder * r * r / 2.0 + about_end_plane;
        assert_relative_eq!(body.inertia, diagonal(side, side, along), epsilon = 1e-14);
    }

    #[test]
    fn placed_shapes_add_up_about_their_common_centre() {
        let shape = || Shape::Cylinder { radius: 0.1, length: 1.0 };
        let lying = UnitQuaternion::from_euler_angles(0.0, PI / 2.0, 0.0);
        let at =
            |x: f64| Collision { origin: Isometry3::from_parts(Translation3::new(x, 0.0, 0.2), lying), shape: shape() };
        let two = mass_of("a", &[at(0.5), at(1.5)], 1000.0, Path::new("."), &mut Vec::new()).unwrap().unwrap();
        let (r, l) = (0.1, 2.0);
        let m = 1000.0 * PI * r * r * l;
        let side = m * (3.0 * r * r + l * l) / 12.0;
        assert_relative_eq!(two.com, Vector3::new(1.0, 0.0, 0.2), epsilon = 1e-14);
        assert_relative_eq!(two.inertia, diagonal(m * r * r / 2.0, side, side), epsilon = 1e-13);
    }

    /// A unit cube as an STL of twelve triangles, scaled to 0.2 m and mirrored.
    #[test]
    fn a_mesh_file_weighs_what_its_box_weighs() {
        let folder = tempfile::tempdir().unwrap();
        let nested = folder.path().join("robot_description/urdf");
        std::fs::create_dir_all(&nested).unwrap();
        std::fs::create_dir_all(folder.path().join("robot_description/meshes")).unwrap();
        std::fs::write(folder.path().join("robot_description/meshes/cube.stl"), cube_stl()).unwrap();
        let filename = "package://robot_description/meshes/cube.stl".to_owned();
        let collision = Collision {
            origin: Isometry3::identity(),
            shape: Shape::Mesh { filename, scale: Vector3::new(-0.2, 0.2, 0.2) },
        };
        let mut remarks = Vec::new();
        let body = mass_of("a", &[collision], 1000.0, &nested, &mut remarks).unwrap().unwrap();
        // STL holds single precision; the vertices 0 and 1 are exact in it.
        assert_relative_eq!(body.mass, 8.0, epsilon = 1e-13);
        assert_relative_eq!(body.com, Vector3::new(-0.1, 0.1, 0.1), epsilon = 1e-15);
        let i = 8.0 * 0.08 / 12.0;
        assert_relative_eq!(body.inertia, diagonal(i, i, i), epsilon = 1e-15);
        assert!(remarks.is_empty());
    }

    fn cube_stl() -> String {
        let mut text = String::from("solid cube\n");
        let corner = |i: usize| format!("vertex {} {} {}\n", i & 1, i >> 1 & 1, i >> 2 & 1);
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        for [a, b, c, d] in faces {
            for triangle in [[a, b, c], [a, c, d]] {
                text.push_str("facet normal 0 0 0\nouter loop\n");
                triangle.into_iter().for_each(|i| text.push_str(&corner(i)));
                text.push_str("endloop\nendfacet\n");
            }
        }
        text + "endsolid cube\n"
    }
}
