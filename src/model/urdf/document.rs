//! The form of a URDF file: well-formed XML, numbers that are numbers, nothing passed over in silence.
//!
//! urdf-rs knows what URDF elements mean, but it reports no places, fills in what is absent, and passes over what it
//! does not know. So the file is walked once before: what a model is made from is checked and copied for urdf-rs, and
//! all else goes into the list of what is ignored.

use nalgebra::{Quaternion, UnitQuaternion};
use roxmltree::Node;

use super::error::{ModelError, Position, Problem};
use super::walk::{Document, Walk, attributes_text, count_of, elements, parse, tag};
use crate::model::joint::JointKind;

/// Walks the text of a URDF file. `file` is for messages only.
///
/// # Errors
/// Malformed XML, xacro, elements or attributes that are missing or repeated, text where a finite number belongs.
pub(super) fn read(file: &str, text: &str) -> Result<Document, ModelError> {
    let xml = roxmltree::Document::parse(text).map_err(|e| malformed(file, text, &e))?;
    let mut walk = Walk {
        file,
        xml: &xml,
        found: Document { essence: String::new(), has_inertial: Vec::new(), ignored: Vec::new(), remarks: Vec::new() },
    };
    walk.refuse_xacro()?;
    walk.robot(xml.root_element())?;
    Ok(walk.found)
}

/// XML that does not parse. A xacro prefix that nothing declares fails here too, and is named as what it is.
fn malformed(file: &str, text: &str, error: &roxmltree::Error) -> ModelError {
    use roxmltree::Error;
    let pos = error.pos();
    let position = match error {
        // Not a place of their own: the text ended.
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream => end_of(text),
        _ => Position { line: pos.row, column: pos.col },
    };
    let xacro_element = || Problem::Xacro { found: "an element <xacro:...>".to_owned() };
    let problem = match error {
        Error::UnknownNamespace(prefix, _) if prefix == "xacro" => xacro_element(),
        _ if text.contains("<xacro:") => xacro_element(),
        Error::DtdDetected => {
            Problem::Malformed { detail: "document types are not read; remove <!DOCTYPE ...>".to_owned() }
        }
        _ => Problem::Malformed { detail: error.to_string().replace(&format!(" at {pos}"), "") },
    };
    let position = Some(position);
    ModelError { file: file.to_owned(), position, problem: Box::new(problem) }
}

fn end_of(text: &str) -> Position {
    let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let last = text.rsplit('\n').next().unwrap_or_default();
    Position { line: count(text.matches('\n').count() + 1), column: count(last.chars().count() + 1) }
}

impl<'a> Walk<'a> {
    fn refuse_xacro(&self) -> Result<(), ModelError> {
        for node in self.xml.descendants() {
            let by_prefix = node.tag_name().namespace().is_some_and(|n| n.contains("xacro"));
            let found = if by_prefix {
                Some(format!("<{}>", tag(node)))
            } else if let Some(text) = node.is_text().then(|| node.text().unwrap_or_default()) {
                text.contains("${").then(|| format!("'{}'", text.trim()))
            } else {
                let value = node.attributes().find(|a| a.value().contains("${") || a.value().contains("$("));
                value.map(|a| format!("{}=\"{}\"", a.name(), a.value()))
            };
            if let Some(found) = found {
                return Err(self.fault(node, Problem::Xacro { found }));
            }
        }
        Ok(())
    }

    fn robot(&mut self, robot: Node<'a, 'a>) -> Result<(), ModelError> {
        if robot.tag_name().name() != "robot" {
            return Err(self.fault(robot, Problem::NotARobot { found: tag(robot) }));
        }
        self.open("robot", &[("name", robot.attribute("name").unwrap_or_default())]);
        for child in elements(robot) {
            match tag(child).as_str() {
                "link" => self.link(child)?,
                "joint" => self.joint(child)?,
                other => self.ignore("robot", other, attributes_text(child)),
            }
        }
        self.close("robot");
        if self.found.has_inertial.is_empty() {
            return Err(self.fault(robot, Problem::NoLinks));
        }
        Ok(())
    }

    fn link(&mut self, node: Node<'a, 'a>) -> Result<(), ModelError> {
        let name = self.name(node)?;
        let element = format!("link '{name}'");
        self.open("link", &[("name", name)]);
        self.ignore_other_attributes(node, &element, &["name"]);
        let inertial = self.only(node, &element, "inertial")?;
        self.found.has_inertial.push(inertial.is_some());
        if let Some(inertial) = inertial {
            self.inertial(inertial, &element)?;
        }
        let (mut visuals, mut collisions) = (0, 0);
        for child in elements(node) {
            match tag(child).as_str() {
                "inertial" => {}
                "visual" => visuals += 1,
                "collision" => {
                    collisions += 1;
                    self.collision(child, &element)?;
                }
                other => self.ignore(&element, other, attributes_text(child)),
            }
        }
        self.close("link");
        for (count, what) in [(visuals, "visual"), (collisions, "collision")] {
            if count > 0 {
                self.ignore(&element, what, count_of(count, "shape"));
            }
        }
        Ok(())
    }

    fn inertial(&mut self, node: Node<'a, 'a>, element: &str) -> Result<(), ModelError> {
        self.open("inertial", &[]);
        self.origin(node, element)?;
        let mass = self.required(node, element, "mass")?;
        let value = self.required_numbers(mass, element, "value", 1)?;
        self.leaf("mass", &[("value", value)]);
        let inertia = self.required(node, element, "inertia")?;
        let mut moments = Vec::with_capacity(6);
        for moment in ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"] {
            moments.push((moment, self.required_numbers(inertia, element, moment, 1)?));
        }
        self.leaf("inertia", &moments);
        self.close("inertial");
        self.ignore_other_children(node, element, &["origin", "mass", "inertia"]);
        Ok(())
    }

    /// Copies a collision whose shape is known; another one gives no mass, and that is said.
    fn collision(&mut self, node: Node<'a, 'a>, element: &str) -> Result<(), ModelError> {
        let geometry = self.required(node, element, "geometry")?;
        let Some(shape) = elements(geometry).next() else {
            return Err(
                self.fault(geometry, Problem::MissingElement { element: element.to_owned(), tag: "box".into() })
            );
        };
        let known: &[(&str, usize)] = match tag(shape).as_str() {
            "box" => &[("size", 3)],
            "cylinder" | "capsule" => &[("radius", 1), ("length", 1)],
            "sphere" => &[("radius", 1)],
            "mesh" => &[],
            other => {
                self.found.remarks.push(format!("{element}: collision shape <{other}> is not known and gives no mass"));
                return Ok(());
            }
        };
        let mut attributes = Vec::new();
        for (attribute, count) in known {
            attributes.push((*attribute, self.required_numbers(shape, element, attribute, *count)?));
        }
        if tag(shape) == "mesh" {
            attributes.push(("filename", self.required_attribute(shape, element, "filename")?));
            attributes.extend(self.numbers(shape, element, "scale", 3)?.map(|scale| ("scale", scale)));
        }
        self.open("collision", &[]);
        self.origin(node, element)?;
        self.open("geometry", &[]);
        self.leaf(&tag(shape), &attributes);
        self.close("geometry");
        self.close("collision");
        Ok(())
    }

    fn joint(&mut self, node: Node<'a, 'a>) -> Result<(), ModelError> {
        let name = self.name(node)?;
        let element = format!("joint '{name}'");
        let kind = self.required_attribute(node, &element, "type")?;
        if !JointKind::ALL.iter().any(|known| known.name() == kind) {
            let problem = Problem::UnknownJointType { joint: name.to_owned(), value: kind.to_owned() };
            return Err(self.fault(node, problem));
        }
        self.open("joint", &[("name", name), ("type", kind)]);
        self.ignore_other_attributes(node, &element, &["name", "type"]);
        self.origin(node, &element)?;
        for end in ["parent", "child"] {
            let end_node = self.required(node, &element, end)?;
            let link = self.required_attribute(end_node, &element, "link")?;
            self.leaf(end, &[("link", link)]);
        }
        if let Some(axis) = self.only(node, &element, "axis")? {
            let xyz = self.required_numbers(axis, &element, "xyz", 3)?;
            self.leaf("axis", &[("xyz", xyz)]);
        }
        for child in elements(node) {
            match tag(child).as_str() {
                "origin" | "parent" | "child" | "axis" => {}
                "dynamics" => self.dynamics(node, child, &element, kind)?,
                "mimic" => self.mimic(node, child, &element)?,
                other => self.ignore(&element, other, attributes_text(child)),
            }
        }
        self.close("joint");
        Ok(())
    }

    fn dynamics(
        &mut self,
        joint: Node<'a, 'a>,
        node: Node<'a, 'a>,
        element: &str,
        kind: &str,
    ) -> Result<(), ModelError> {
        self.only(joint, element, "dynamics")?;
        let damping = self.numbers(node, element, "damping", 1)?;
        let friction = self.numbers(node, element, "friction", 1)?;
        let present = [("damping", damping), ("friction", friction)];
        let present: Vec<_> = present.into_iter().filter_map(|(a, value)| Some((a, value?))).collect();
        self.leaf("dynamics", &present);
        let unused = |attribute: &str| attribute == "friction" || kind == "fixed";
        for (attribute, value) in present.into_iter().filter(|(a, _)| unused(a)) {
            if value.trim().parse() != Ok(0.0) {
                self.ignore(element, attribute, value.trim().to_owned());
            }
        }
        self.ignore_other_attributes(node, element, &["damping", "friction"]);
        Ok(())
    }

    fn mimic(&mut self, joint: Node<'a, 'a>, node: Node<'a, 'a>, element: &str) -> Result<(), ModelError> {
        self.only(joint, element, "mimic")?;
        let mut attributes = vec![("joint", self.required_attribute(node, element, "joint")?)];
        for attribute in ["multiplier", "offset"] {
            attributes.extend(self.numbers(node, element, attribute, 1)?.map(|value| (attribute, value)));
        }
        self.leaf("mimic", &attributes);
        Ok(())
    }

    /// Copies the origin of a node, a quaternion (URDF 1.1) turned into roll, pitch and yaw.
    fn origin(&mut self, node: Node<'a, 'a>, element: &str) -> Result<(), ModelError> {
        let Some(origin) = self.only(node, element, "origin")? else { return Ok(()) };
        let xyz = self.numbers(origin, element, "xyz", 3)?;
        let mut rpy = self.numbers(origin, element, "rpy", 3)?.map(str::to_owned);
        if let Some(value) = self.numbers(origin, element, "quat_xyzw", 4)? {
            if rpy.is_some() {
                return Err(self.fault(origin, Problem::TwoRotations { element: element.to_owned() }));
            }
            let q = parse(value).collect::<Vec<_>>();
            let quaternion = Quaternion::new(q[3], q[0], q[1], q[2]);
            let Some(rotation) = UnitQuaternion::try_new(quaternion, f64::MIN_POSITIVE) else {
                let problem = Problem::ZeroQuaternion { element: element.to_owned(), value: value.to_owned() };
                return Err(self.fault(origin, problem));
            };
            let (roll, pitch, yaw) = rotation.euler_angles();
            rpy = Some(format!("{roll} {pitch} {yaw}"));
        }
        let present = [("xyz", xyz), ("rpy", rpy.as_deref())];
        let present: Vec<_> = present.into_iter().filter_map(|(a, value)| Some((a, value?))).collect();
        self.leaf("origin", &present);
        self.ignore_other_attributes(origin, element, &["xyz", "rpy", "quat_xyzw"]);
        Ok(())
    }
}
