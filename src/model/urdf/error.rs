//! Why a URDF could not be read: file, place, element, value and remedy in one line.

use std::fmt;

use crate::model::joint::JointKind;
use crate::model::names::known;

/// Why a URDF could not be read. Nothing is half-loaded: a model is whole or it is this.
#[derive(Debug, thiserror::Error)]
#[error("{file}{}: {problem}", .position.map(|p| format!(":{p}")).unwrap_or_default())]
pub struct ModelError {
    /// Path as given by the caller.
    pub file: String,
    /// Where in the file, when it is one place.
    pub position: Option<Position>,
    pub problem: Box<Problem>,
}

impl ModelError {
    /// A problem of the file as a whole, or of an element that its name is enough to find.
    pub(in crate::model) fn of(file: &str, problem: Problem) -> Self {
        ModelError { file: file.to_owned(), position: None, problem: Box::new(problem) }
    }
}

/// A place in a text file, both counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position {
    pub line: u32,
    pub column: u32,
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

/// What is wrong with a URDF. `element` reads like `joint 'elbow'`.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    #[error("no such file; give the path of a .urdf file or of a scene .json file")]
    Missing,
    #[error("cannot be read: {0}")]
    Unreadable(std::io::Error),
    #[error("is not UTF-8 text; a URDF is XML in UTF-8")]
    NotText,
    #[error("malformed XML: {detail}")]
    Malformed { detail: String },
    #[error("holds xacro that was not expanded: {found}; run `xacro FILE > model.urdf` first and give model.urdf")]
    Xacro { found: String },
    #[error("root element is <{found}>; a URDF has <robot>")]
    NotARobot { found: String },
    #[error("<robot> has no <link>; a model needs at least one")]
    NoLinks,
    #[error("<{tag}> has no name; give it name=\"...\"")]
    Unnamed { tag: String },
    #[error("{element}: has more than one <{tag}>; keep one")]
    Repeated { element: String, tag: String },
    #[error("{element}: <{tag}> is missing")]
    MissingElement { element: String, tag: String },
    #[error("{element}: <{tag}> has no attribute {attribute}=\"...\"")]
    MissingAttribute { element: String, tag: String, attribute: String },
    #[error("{element}: <{tag} {attribute}=\"{value}\"> is not {expected}")]
    NotANumber { element: String, tag: String, attribute: String, value: String, expected: String },
    #[error("{element}: <{tag} {attribute}=\"{value}\"> is not finite; write a finite number")]
    NotFinite { element: String, tag: String, attribute: String, value: String },
    #[error("{element}: <origin> has both rpy and quat_xyzw; keep one")]
    TwoRotations { element: String },
    #[error("{element}: <origin quat_xyzw=\"{value}\"> is zero; write a quaternion of length 1")]
    ZeroQuaternion { element: String, value: String },
    #[error(
        "joint '{joint}': type '{value}' is not known; types are: {}",
        JointKind::ALL.map(JointKind::name).join(", ")
    )]
    UnknownJointType { joint: String, value: String },
    #[error("{element}: is defined more than once; rename one of them")]
    Duplicate { element: String },
    #[error("joint '{joint}': {role} link '{link}' is not defined; {}", known("links", .link, .links))]
    UndefinedLink { joint: String, role: &'static str, link: String, links: Vec<String> },
    #[error(
        "link '{link}': is the child of joint '{first}' and of joint '{second}'; a link has one parent, and a loop is \
         closed by \"loops\" in a scene file"
    )]
    TwoParents { link: String, first: String, second: String },
    #[error(
        "joint '{joint}': closes a cycle of links {}; a URDF is a tree, and a loop is closed by \"loops\" in a scene \
         file",
        .path.join(" -> ")
    )]
    Cycle { joint: String, path: Vec<String> },
    #[error("has {} root links: {}; join them by joints, so that one is left", .roots.len(), .roots.join(", "))]
    SeveralRoots { roots: Vec<String> },
    #[error("joint '{joint}': axis is 0 0 0; give it a direction such as 0 0 1")]
    ZeroAxis { joint: String },
    #[error("joint '{joint}': damping must be >= 0, got {value}")]
    NegativeDamping { joint: String, value: f64 },
    #[error(
        "joint '{joint}': mimics joint '{source_joint}', which is not defined; {}",
        known("joints", .source_joint, .joints)
    )]
    UnknownMimic { joint: String, source_joint: String, joints: Vec<String> },
    #[error("joint '{joint}': mimics itself; name another joint")]
    MimicsItself { joint: String },
    #[error("link '{link}': mass must be >= 0 kg, got {value}")]
    NegativeMass { link: String, value: f64 },
    #[error(
        "link '{link}': mass is 0 kg but inertia is not zero; give it a mass, or inertia 0 for a link without mass"
    )]
    InertiaWithoutMass { link: String },
    #[error(
        "link '{link}': inertia has the negative principal moment {moment:.6e} kg m^2 (the others: {}); correct ixx, \
         ixy, ixz, iyy, iyz, izz",
        .others.map(|m| format!("{m:.6e}")).join(", ")
    )]
    NegativeMoment { link: String, moment: f64, others: [f64; 2] },
    #[error("link '{link}': density needs the size of its collision {shape}, and {what} must be > 0 m, got {value}")]
    ShapeSize { link: String, shape: &'static str, what: &'static str, value: f64 },
    #[error(
        "link '{link}': density needs collision mesh '{mesh}', which is not found at {}; put it there, or give the \
         link an <inertial>",
        .tried.join(" or ")
    )]
    MeshMissing { link: String, mesh: String, tried: Vec<String> },
    #[error(
        "link '{link}': density needs collision mesh '{mesh}', which cannot be used: {detail}; give the link an \
         <inertial>"
    )]
    MeshUnusable { link: String, mesh: String, detail: String },
    #[error("cannot be read as URDF: {detail}")]
    Urdf { detail: String },
}
