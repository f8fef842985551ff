//! A URDF as read.

use super::joint::Joint;
use super::link::Link;

/// A URDF as read: a tree of links. `links[0]` is the root, and every joint's parent stands before its child.
#[derive(Clone, Debug)]
pub struct Model {
    pub name: String,
    pub links: Vec<Link>,
    /// In tree order: the joint of a link's parent comes before the joint of the link. Joint `j` carries link `j + 1`.
    pub joints: Vec<Joint>,
    /// What the file holds and a run does not use, in the order of the file.
    pub ignored: Vec<Ignored>,
    /// What was read but deserves a second look, one sentence each.
    pub remarks: Vec<String>,
}

/// Something that the file holds and that a run does not use.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Ignored {
    /// Where it stands, such as `joint 'elbow'`.
    pub element: String,
    /// What it is, such as `limit`.
    pub what: String,
    /// What was read, such as `lower -1.57, upper 1.57`.
    pub value: String,
}
