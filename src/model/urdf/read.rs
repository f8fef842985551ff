//! Reads a URDF file into a [`Model`]: form by `document`, values by urdf-rs, then everything that a parser does not
//! check.

use std::path::Path;

use nalgebra::{Isometry3, Matrix3, Vector3};

use super::document;
use super::error::{ModelError, Problem};
use super::order::{self, Edge, WORLD};
use super::pose::{direction, pose_of};
use super::text::read_text;
use super::walk::Document;
use super::{inertia, shapes};
use crate::model::joint::{Joint, JointKind, Mimic};
use crate::model::link::{Collision, Inertial, Link, Shape};
use crate::model::robot::Model;

/// How far the length of an axis may be from 1 without a remark: files print few digits.
const AXIS_LENGTH: f64 = 1e-3;

/// Reads a URDF file. Links without `<inertial>` have no mass.
///
/// # Errors
/// Any of [`Problem`]; the message names file, element, value and remedy.
pub fn read_urdf(path: impl AsRef<Path>) -> Result<Model, ModelError> {
    read_urdf_with_density(path, None)
}

/// Reads a URDF file; links without `<inertial>` get mass and inertia from their collision shapes, filled with
/// `density` (kg/m^3).
///
/// # Errors
/// Any of [`Problem`]; the message names file, element, value and remedy.
pub(crate) fn read_urdf_with_density(path: impl AsRef<Path>, density: Option<f64>) -> Result<Model, ModelError> {
    let path = path.as_ref();
    let file = path.display().to_string();
    let text = read_text(path).map_err(|problem| ModelError::of(&file, problem))?;
    let document = document::read(&file, &text)?;
    let robot = urdf_rs::read_from_string(&document.essence)
        .map_err(|e| ModelError::of(&file, Problem::Urdf { detail: e.to_string() }))?;
    let density = density.map(|density| (density, path.parent().unwrap_or(Path::new(""))));
    model(&robot, document, density).map_err(|problem| ModelError::of(&file, problem))
}

fn model(robot: &urdf_rs::Robot, document: Document, density: Option<(f64, &Path)>) -> Result<Model, Problem> {
    let names: Vec<&str> = robot.links.iter().map(|l| l.name.as_str()).collect();
    let edges: Vec<Edge> =
        robot.joints.iter().map(|j| Edge { joint: &j.name, parent: &j.parent.link, child: &j.child.link }).collect();
    let order = order::order(&names, &edges)?;
    let Document { has_inertial, ignored, mut remarks, .. } = document;

    // Links in the file's order first, so that remarks come in the file's order too.
    let mut read = Vec::with_capacity(robot.links.len());
    for (source, has_inertial) in robot.links.iter().zip(has_inertial) {
        read.push(Some(link(source, has_inertial, density, &mut remarks)?));
    }
    let mut links = Vec::with_capacity(robot.links.len() + 1);
    match order.root {
        Some(root) => links.extend(read[root].take()),
        None => {
            links.push(Link { name: WORLD.to_owned(), inertial: None, collisions: Vec::new() });
            remarks.insert(0, format!("parent link '{WORLD}' is not defined; it is taken as the ground"));
        }
    }
    links.extend(order.children.iter().filter_map(|l| read[*l].take()));

    // A joint carries the link after its own place, so a link's place tells where its own joint went.
    let mut place = vec![0; robot.links.len()];
    order.children.iter().enumerate().for_each(|(k, l)| place[*l] = k + 1);
    let by_name: std::collections::HashMap<&str, usize> =
        names.iter().enumerate().map(|(l, n)| (*n, place[l])).collect();
    let mut joint_place = vec![0; robot.joints.len()];
    order.joints.iter().enumerate().for_each(|(k, j)| joint_place[*j] = k);
    let joint_names: Vec<String> = robot.joints.iter().map(|j| j.name.clone()).collect();
    let joint_by_name: std::collections::HashMap<&str, usize> =
        joint_names.iter().enumerate().map(|(j, n)| (n.as_str(), joint_place[j])).collect();

    let mut joints: Vec<Option<Joint>> = vec![None; robot.joints.len()];
    for (j, source) in robot.joints.iter().enumerate() {
        let mimic = match &source.mimic {
            None => None,
            Some(m) if m.joint == source.name => return Err(Problem::MimicsItself { joint: source.name.clone() }),
            Some(m) => Some(Mimic {
                source: *joint_by_name.get(m.joint.as_str()).ok_or_else(|| Problem::UnknownMimic {
                    joint: source.name.clone(),
                    source_joint: m.joint.clone(),
                    joints: joint_names.clone(),
                })?,
                multiplier: m.multiplier.unwrap_or(1.0),
                offset: m.offset.unwrap_or(0.0),
            }),
        };
        // The ground has no place of its own in the file; it is link 0.
        let parent = by_name.get(source.parent.link.as_str()).copied().unwrap_or(0);
        joints[joint_place[j]] = Some(joint(source, parent, joint_place[j] + 1, mimic, &mut remarks)?);
    }
    Ok(Model { name: robot.name.clone(), links, joints: joints.into_iter().flatten().collect(), ignored, remarks })
}

fn link(
    source: &urdf_rs::Link,
    has_inertial: bool,
    density: Option<(f64, &Path)>,
    remarks: &mut Vec<String>,
) -> Result<Link, Problem> {
    let collisions: Vec<Collision> =
        source.collision.iter().map(|c| Collision { origin: pose(&c.origin), shape: shape(&c.geometry) }).collect();
    let inertial: Option<Inertial> = match density {
        _ if has_inertial => {
            let urdf_rs::Inertia { ixx, ixy, ixz, iyy, iyz, izz } = source.inertial.inertia;
            let tensor = Matrix3::new(ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz);
            let origin = pose(&source.inertial.origin);
            inertia::inertial(&source.name, source.inertial.mass.value, &origin, tensor, remarks)?
        }
        Some((density, folder)) => shapes::mass_of(&source.name, &collisions, density, folder, remarks)?,
        None => None,
    };
    Ok(Link { name: source.name.clone(), inertial, collisions })
}

fn joint(
    source: &urdf_rs::Joint,
    parent: usize,
    child: usize,
    mimic: Option<Mimic>,
    remarks: &mut Vec<String>,
) -> Result<Joint, Problem> {
    let name = source.name.clone();
    let kind = match source.joint_type {
        urdf_rs::JointType::Fixed => JointKind::Fixed,
        urdf_rs::JointType::Revolute => JointKind::Revolute,
        urdf_rs::JointType::Continuous => JointKind::Continuous,
        urdf_rs::JointType::Prismatic => JointKind::Prismatic,
        urdf_rs::JointType::Planar => JointKind::Planar,
        urdf_rs::JointType::Spherical => JointKind::Spherical,
        urdf_rs::JointType::Floating => JointKind::Floating,
    };
    let axis = if kind.has_axis() {
        let written = Vector3::from(source.axis.xyz.0);
        let axis = direction(&written).ok_or_else(|| Problem::ZeroAxis { joint: name.clone() })?;
        if !((written.norm() - 1.0).abs() <= AXIS_LENGTH) {
            remarks.push(format!(
                "joint '{name}': axis {} {} {} has length {:.6}; it is normalised",
                written.x,
                written.y,
                written.z,
                written.norm()
            ));
        }
        axis
    } else {
        Vector3::x_axis()
    };
    let dynamics = source.dynamics.clone().unwrap_or_default();
    if dynamics.damping < 0.0 {
        return Err(Problem::NegativeDamping { joint: name, value: dynamics.damping });
    }
    let urdf_rs::Dynamics { damping, friction } = dynamics;
    Ok(Joint { name, kind, parent, child, origin: pose(&source.origin), axis, damping, friction, mimic })
}

fn pose(origin: &urdf_rs::Pose) -> Isometry3<f64> {
    pose_of(origin.xyz.0, origin.rpy.0)
}

fn shape(geometry: &urdf_rs::Geometry) -> Shape {
    match geometry {
        urdf_rs::Geometry::Box { size } => Shape::Box { half_extents: Vector3::from(size.0) / 2.0 },
        urdf_rs::Geometry::Cylinder { radius, length } => Shape::Cylinder { radius: *radius, length: *length },
        urdf_rs::Geometry::Capsule { radius, length } => Shape::Capsule { radius: *radius, length: *length },
        urdf_rs::Geometry::Sphere { radius } => Shape::Sphere { radius: *radius },
        urdf_rs::Geometry::Mesh { filename, scale } => Shape::Mesh {
            filename: filename.clone(),
            scale: scale.map_or(Vector3::repeat(1.0), |s| Vector3::from(s.0)),
        },
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use approx::assert_relative_eq;
    use nalgebra::UnitQuaternion;

    use super::*;

    fn read(text: &str, density: Option<f64>) -> Model {
        let file = tempfile::NamedTempFile::with_suffix(".urdf").unwrap();
        std::fs::write(file.path(), text).unwrap();
        read_urdf_with_density(file.path(), density).unwrap()
    }

    /// Links `a` and `b` with a joint of that type between them, and what is inside it.
    fn joined(kind: &str, inside: &str) -> Model {
        let text = format!(
            r#"<robot name="r"><link name="a"/><link name="b"/>
            <joint name="j" type="{kind}"><parent link="a"/><child link="b"/>{inside}</joint></robot>"#
        );
        read(&text, None)
    }

    #[test]
    fn every_joint_type_is_read() {
        for kind in JointKind::ALL {
            assert_eq!(joined(kind.name(), "").joints[0].kind, kind);
        }
    }

    #[test]
    fn an_axis_left_out_is_x() {
        assert_eq!(joined("revolute", "").joints[0].axis, Vector3::x_axis());
    }

    #[test]
    fn a_long_axis_is_normalised_with_a_remark_and_a_rounded_one_without() {
        let long = joined("revolute", r#"<axis xyz="0 3 4"/>"#);
        assert_relative_eq!(long.joints[0].axis.into_inner(), Vector3::new(0.0, 0.6, 0.8), epsilon = 1e-15);
        assert_eq!(long.remarks, ["joint 'j': axis 0 3 4 has length 5.000000; it is normalised"]);
        let rounded = joined("revolute", r#"<axis xyz="0 0.7071 0.7071"/>"#);
        assert_relative_eq!(rounded.joints[0].axis.norm(), 1.0, epsilon = 1e-15);
        assert!(rounded.remarks.is_empty());
    }

    #[test]
    fn axes_of_any_length_keep_their_direction() {
        for length in ["1e-320", "1e-200", "1e200"] {
            let axis = joined("revolute", &format!(r#"<axis xyz="0 {length} 0"/>"#)).joints[0].axis;
            assert_eq!(axis, Vector3::y_axis(), "{length}");
        }
    }

    #[test]
    fn a_fixed_joint_may_have_a_zero_axis() {
        assert!(joined("fixed", r#"<axis xyz="0 0 0"/>"#).remarks.is_empty());
    }

    #[test]
    fn roll_pitch_and_yaw_turn_about_fixed_axes_in_this_order() {
        let joint = &joined("fixed", &format!(r#"<origin xyz="1 2 3" rpy="{FRAC_PI_2} 0 {FRAC_PI_2}"/>"#)).joints[0];
        // Roll takes y to z, yaw leaves z and takes x to y.
        assert_relative_eq!(joint.origin.rotation * Vector3::y(), Vector3::z(), epsilon = 1e-15);
        assert_relative_eq!(joint.origin.rotation * Vector3::x(), Vector3::y(), epsilon = 1e-15);
        assert_eq!(joint.origin.translation.vector, Vector3::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn a_quaternion_is_the_rotation_it_says_even_near_the_pole_of_pitch() {
        for angle in [0.3, FRAC_PI_2 - 1e-3, FRAC_PI_2, -FRAC_PI_2] {
            let q = UnitQuaternion::from_euler_angles(0.2, angle, -0.4);
            let text = format!(r#"<origin quat_xyzw="{} {} {} {}"/>"#, q.i, q.j, q.k, q.w);
            let read = joined("fixed", &text).joints[0].origin.rotation;
            // measured 1.2e-13 beside the pole, where three angles are ill conditioned, and 1.3e-16 elsewhere
            assert!(read.angle_to(&q) < 3e-13, "{angle}: {:e}", read.angle_to(&q));
        }
    }

    #[test]
    fn an_undefined_world_is_the_ground_with_a_remark() {
        let text = r#"<robot name="r"><link name="a"/><link name="b"/>
            <joint name="j" type="fixed"><parent link="world"/><child link="b"/></joint>
            <joint name="k" type="spherical"><parent link="b"/><child link="a"/></joint></robot>"#;
        let model = read(text, None);
        let names: Vec<&str> = model.links.iter().map(|l| l.name.as_str()).collect();
        assert_eq!(names, ["world", "b", "a"]);
        let ends: Vec<_> = model.joints.iter().map(|j| (j.parent, j.child)).collect();
        assert_eq!(ends, [(0, 1), (1, 2)]);
        assert_eq!(model.remarks, ["parent link 'world' is not defined; it is taken as the ground"]);
    }

    #[test]
    fn density_gives_mass_only_to_links_without_inertial() {
        let shape = r#"<collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision>"#;
        let text = format!(
            r#"<robot name="r"><link name="a"><inertial><mass value="5"/>
            <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>{shape}</link>
            <link name="b">{shape}</link><link name="c"/>
            <joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>
            <joint name="k" type="fixed"><parent link="b"/><child link="c"/></joint></robot>"#
        );
        let masses = |density| -> Vec<Option<f64>> {
            read(&text, density).links.iter().map(|l| l.inertial.as_ref().map(|i| i.mass)).collect()
        };
        assert_eq!(masses(None), [Some(5.0), None, None]);
        let dense = masses(Some(2000.0));
        assert_eq!((dense[0], dense[2]), (Some(5.0), None));
        assert_relative_eq!(dense[1].unwrap(), 12.0, epsilon = 1e-13);
    }

    #[test]
    fn what_is_not_simulated_is_listed_in_the_order_of_the_file() {
        let text = r#"<robot name="r"><material name="red"/>
            <link name="a"><visual><geometry><box size="1 1 1"/></geometry></visual><sensor kind="imu"/></link>
            <link name="b"/>
            <joint name="j" type="revolute"><parent link="a"/><child link="b"/>
              <limit lower="-1.57" upper="1.57" effort="10" velocity="2"/>
              <dynamics damping="0.5" friction="0.2" spring_reference="1"/>
              <safety_controller k_velocity="3"/><calibration rising="0"/></joint>
            <joint name="k" type="fixed"><parent link="b"/><child link="c"/>
              <dynamics damping="0.5" friction="0"/></joint>
            <link name="c"/>
            <joint name="l" type="continuous"><parent link="c"/><child link="d"/>
              <mimic joint="j" multiplier="2"/></joint>
            <link name="d"/>
            <transmission name="t"/><gazebo reference="a"/></robot>"#;
        let model = read(text, None);
        let list: Vec<String> =
            model.ignored.iter().map(|i| format!("{}: {} ({})", i.element, i.what, i.value)).collect();
        assert_eq!(
            list,
            [
                "robot: material (name red)",
                "link 'a': sensor (kind imu)",
                "link 'a': visual (1 shape)",
                "joint 'j': limit (lower -1.57, upper 1.57, effort 10, velocity 2)",
                "joint 'j': friction (0.2)",
                "joint 'j': attribute spring_reference of <dynamics> (1)",
                "joint 'j': safety_controller (k_velocity 3)",
                "joint 'j': calibration (rising 0)",
                "joint 'k': damping (0.5)",
                "robot: transmission (name t)",
                "robot: gazebo (reference a)",
            ]
        );
        assert_eq!((model.joints[0].damping, model.joints[0].friction), (0.5, 0.2));
        assert_eq!(model.joints[2].mimic, Some(Mimic { source: 0, multiplier: 2.0, offset: 0.0 }));
    }

    #[test]
    fn elements_of_other_namespaces_are_listed_and_not_taken_for_urdf() {
        let text = r#"<robot name="r" xmlns:drake="http://drake.mit.edu"><link name="a"><collision>
            <geometry><drake:ellipsoid a="1"/></geometry></collision></link><drake:joint name="x"/></robot>"#;
        let model = read(text, None);
        assert_eq!((model.links.len(), model.joints.len(), model.links[0].collisions.len()), (1, 0, 0));
        assert_eq!(model.remarks, ["link 'a': collision shape <drake:ellipsoid> is not known and gives no mass"]);
        assert_eq!(model.ignored[1].what, "drake:joint");
    }

    #[test]
    fn names_keep_their_special_characters() {
        let text = r#"<robot name="r"><link name="a &amp; &lt;b&gt; &quot;é&quot;"/></robot>"#;
        assert_eq!(read(text, None).links[0].name, "a & <b> \"é\"");
    }
}
