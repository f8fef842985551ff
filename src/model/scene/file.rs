//! The scene file as JSON: its keys, their defaults and their descriptions. Names are resolved by `resolve`.

use std::fmt;
use std::marker::PhantomData;

use schemars::JsonSchema;
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::bounds::BoundFile;
use super::data;

/// A scene: a URDF model with gravity, an initial state, loops, springs, drives, a duration and bounds. SI units:
/// lengths in m, angles in rad, time in s, masses in kg.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "rattlebench scene")]
pub(crate) struct SceneFile {
    /// Path of the URDF file, relative to this file.
    pub model: String,
    /// What the scene shows, for reports.
    #[serde(default)]
    pub description: String,
    /// Gravity in world axes, m/s^2.
    #[serde(default = "default_gravity")]
    pub gravity: [f64; 3],
    /// Density in kg/m^3 that gives links without `<inertial>` mass and inertia from their collision shapes.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub density: Option<f64>,
    /// How the root link stands in the world.
    #[serde(default)]
    pub base: BaseFile,
    /// State at t = 0. What is left out is 0.
    #[serde(default)]
    pub initial: InitialFile,
    /// Joints that close loops of the tree.
    #[serde(default)]
    pub loops: Vec<LoopFile>,
    /// Springs with dampers, in joints or between points.
    #[serde(default)]
    pub springs: Vec<SpringFile>,
    /// Efforts that drive joints.
    #[serde(default)]
    pub drives: Vec<DriveFile>,
    /// Length of a run, s.
    #[serde(default = "default_duration")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub duration: f64,
    /// Step sizes that a comparison runs, s.
    #[serde(default = "default_steps")]
    #[schemars(length(min = 1))]
    pub steps: Vec<f64>,
    /// What `check` holds runs of this scene to.
    #[serde(default)]
    pub bounds: Vec<BoundFile>,
}

fn default_gravity() -> [f64; 3] {
    data::GRAVITY
}

fn default_duration() -> f64 {
    data::DURATION
}

fn default_steps() -> Vec<f64> {
    data::STEPS.to_vec()
}

/// How the root link stands in the world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum BaseFile {
    /// Bolted to the world, its frame being the world frame.
    #[default]
    Fixed,
    /// Free to move.
    Floating,
}

/// State at t = 0.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct InitialFile {
    /// By joint name.
    #[serde(default, deserialize_with = "named")]
    #[schemars(with = "std::collections::BTreeMap<String, JointStateFile>")]
    pub joints: Vec<(String, JointStateFile)>,
    /// Pose and velocity of the root link's frame; only with a floating base.
    #[serde(default)]
    pub base: Option<BaseStateFile>,
}

/// Coordinates and velocities of one joint. A planar joint has two lengths (along the axes that the shortest turn from
/// z to the joint axis makes of x and y) and an angle; a spherical joint has a rotation vector; a floating joint has
/// three lengths and a rotation vector.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointStateFile {
    /// rad or m
    #[serde(default)]
    pub position: Option<Numbers>,
    /// rad/s or m/s
    #[serde(default)]
    pub velocity: Option<Numbers>,
}

/// One number, or an array with one number a coordinate.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected a number or an array of numbers")]
pub enum Numbers {
    One(f64),
    Many(Vec<f64>),
}

/// Pose and velocity of the root link's frame, in world axes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BaseStateFile {
    /// m
    #[serde(default)]
    pub position: [f64; 3],
    /// Turns the root link's axes to world axes; scalar part first.
    #[serde(default = "identity")]
    pub quaternion_wxyz: [f64; 4],
    /// Velocity of the frame's origin, m/s.
    #[serde(default)]
    pub linear_velocity: [f64; 3],
    /// rad/s
    #[serde(default)]
    pub angular_velocity: [f64; 3],
}

fn identity() -> [f64; 4] {
    [1.0, 0.0, 0.0, 0.0]
}

/// A joint that closes a loop of the tree.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LoopFile {
    pub name: String,
    /// What the joint leaves free.
    #[serde(rename = "type")]
    pub kind: LoopKindFile,
    /// Axis in the parent_origin frame; needed by revolute and prismatic.
    #[serde(default)]
    pub axis: Option<[f64; 3]>,
    /// Link name, or `world` for the ground.
    pub parent: String,
    /// Frame of the joint in the parent link's frame.
    #[serde(default)]
    pub parent_origin: OriginFile,
    /// Link name, or `world` for the ground.
    pub child: String,
    /// Frame of the joint in the child link's frame.
    #[serde(default)]
    pub child_origin: OriginFile,
}

/// What a loop joint leaves free.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum LoopKindFile {
    /// One angle about the axis.
    Revolute,
    /// Every rotation.
    Spherical,
    /// Nothing.
    Fixed,
    /// One length along the axis.
    Prismatic,
}

/// A frame, as a URDF origin.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct OriginFile {
    /// m
    #[serde(default)]
    pub xyz: [f64; 3],
    /// Roll, pitch, yaw about fixed axes, rad.
    #[serde(default)]
    pub rpy: [f64; 3],
}

/// A spring with a damper beside it: in a joint (`joint`, `rest`), or between two points (`from`, `to`, `rest_length`).
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [
    {
        "required": ["joint"],
        "not": { "anyOf": [{ "required": ["from"] }, { "required": ["to"] }, { "required": ["rest_length"] }] }
    },
    { "required": ["from", "to"], "not": { "anyOf": [{ "required": ["joint"] }, { "required": ["rest"] }] } }
]))]
pub(crate) struct SpringFile {
    /// Joint of one coordinate that the spring acts in.
    #[serde(default)]
    pub joint: Option<String>,
    /// One end of a spring between points.
    #[serde(default)]
    pub from: Option<AnchorFile>,
    /// The other end.
    #[serde(default)]
    pub to: Option<AnchorFile>,
    /// N m/rad in a joint that turns, N/m otherwise.
    #[schemars(range(min = 0.0))]
    pub stiffness: f64,
    /// N m s/rad in a joint that turns, N s/m otherwise.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub damping: f64,
    /// Joint position without force, rad or m. Default 0.
    #[serde(default)]
    pub rest: Option<f64>,
    /// Distance of the points without force, m. Default 0.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub rest_length: Option<f64>,
}

/// A point fixed in a link.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct AnchorFile {
    /// Link name, or `world` for the ground.
    pub link: String,
    /// In the link's frame, m.
    #[serde(default)]
    pub point: [f64; 3],
}

/// Effort `effort + amplitude sin(2 pi frequency_hz t + phase)` in a joint of one coordinate.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct DriveFile {
    pub joint: String,
    /// Constant part, N m or N.
    #[serde(default)]
    pub effort: f64,
    /// N m or N
    #[serde(default)]
    pub amplitude: f64,
    /// Hz; needed with an amplitude.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub frequency_hz: Option<f64>,
    /// rad
    #[serde(default)]
    pub phase: f64,
}

/// A JSON object as a list in the order of the file; a name that stands twice is an error.
fn named<'de, D, T>(deserializer: D) -> Result<Vec<(String, T)>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    struct Named<T>(PhantomData<T>);

    impl<'de, T: Deserialize<'de>> Visitor<'de> for Named<T> {
        type Value = Vec<(String, T)>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("an object")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut list: Vec<(String, T)> = Vec::new();
            let mut names = std::collections::HashSet::new();
            while let Some(name) = map.next_key::<String>()? {
                if !names.insert(name.clone()) {
                    return Err(de::Error::custom(format!("'{name}' stands twice")));
                }
                list.push((name, map.next_value()?));
            }
            Ok(list)
        }
    }

    deserializer.deserialize_map(Named(PhantomData))
}
