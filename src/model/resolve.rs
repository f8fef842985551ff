//! From a scene file to a [`Scene`]: names become indices, numbers are checked.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::error::Position;
use super::scene::{Anchor, Base, Drive, JointInitial, Loop, LoopKind, Place, Scene, Spring};
use super::scene_error::{SceneError, SceneProblem, not_negative, positive};
use super::scene_file::{
    AnchorFile, BaseFile, BaseStateFile, DriveFile, JointStateFile, LoopFile, LoopKindFile, Numbers, SceneFile,
    SpringFile,
};
use super::tree::WORLD;
use super::urdf::{direction, pose_of, read_text};
use super::{JointKind, Model, bounds, read_urdf_with_density};

/// How far the length of a quaternion may be from 1: the digits that files print.
const QUATERNION_LENGTH: f64 = 1e-6;

/// Reads a scene `.json` file and the URDF that it names.
pub(super) fn load(path: &Path) -> Result<Scene, SceneError> {
    let file: SceneFile = read_json(path)?;
    let urdf = path.parent().unwrap_or(Path::new("")).join(&file.model);
    let fault = |problem| SceneError::of(path, problem);
    if !urdf.is_file() {
        let at = urdf.display().to_string();
        return Err(fault(SceneProblem::ModelMissing { model: file.model, path: at }));
    }
    let density = file.density.map(|d| positive("density", "kg/m^3", d)).transpose().map_err(fault)?;
    let model = read_urdf_with_density(&urdf, density)?;
    scene(file, &name_of(path), model).map_err(fault)
}

/// A file of JSON, nothing before or after it.
pub(super) fn read_json<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, SceneError> {
    let text = read_text(path).map_err(|problem| SceneError::of(path, SceneProblem::File(problem)))?;
    let mut json = serde_json::Deserializer::from_str(&text);
    let file = serde_path_to_error::deserialize(&mut json).map_err(|e| {
        let key = e.path().to_string();
        json_error(path, &key, e.inner())
    })?;
    json.end().map_err(|e| json_error(path, ".", &e))?;
    Ok(file)
}

/// serde_json's own message, with its place put in front and in the words of JSON instead of those of Rust. `key` is `.`
/// for the file as a whole.
fn json_error(path: &Path, key: &str, error: &serde_json::Error) -> SceneError {
    let place = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let position = Position { line: place(error.line()), column: place(error.column()) };
    let mut detail = error.to_string();
    let suffix = format!(" at line {} column {}", error.line(), error.column());
    detail.truncate(detail.strip_suffix(&suffix).unwrap_or(&detail).len());
    for (rust, json) in [(" field ", " key "), ("variant", "value"), ("f64", "a number"), ("`", "'")] {
        detail = detail.replace(rust, json);
    }
    if key != "." {
        detail = format!("{key}: {detail}");
    }
    SceneError::Json { file: path.display().to_string(), position, detail }
}

/// The folder of a `scene.json`, the stem of any other file.
fn name_of(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let absolute = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    match absolute.parent().and_then(Path::file_name) {
        Some(folder) if stem == "scene" => folder.to_string_lossy().into_owned(),
        _ => stem,
    }
}

fn scene(file: SceneFile, name: &str, model: Model) -> Result<Scene, SceneProblem> {
    let names = Names::of(&model);
    let base = base(file.base, file.initial.base.as_ref(), &model)?;
    let mut initial = Scene::of_model(name, model.clone()).initial;
    for (joint, state) in &file.initial.joints {
        let index = names.joint(&format!("initial.joints.{joint}"), joint)?;
        initial[index] = joint_initial(joint, model.joints[index].kind, state)?;
    }
    Ok(Scene {
        loops: loops(&file.loops, &names)?,
        springs: numbered(&file.springs, "springs", |key, spring| names.spring(key, spring))?,
        drives: numbered(&file.drives, "drives", |key, drive| names.drive(key, drive))?,
        bounds: numbered(&file.bounds, "bounds", bounds::resolve)?,
        duration: positive("duration", "s", file.duration)?,
        steps: steps(&file.steps)?,
        name: name.to_owned(),
        description: file.description,
        gravity: Vector3::from(file.gravity),
        base,
        initial,
        model,
    })
}

/// Resolves a list; `key` of an entry reads like `springs[0]`.
fn numbered<T, U>(
    list: &[T],
    name: &str,
    resolve: impl Fn(&str, &T) -> Result<U, SceneProblem>,
) -> Result<Vec<U>, SceneProblem> {
    list.iter().enumerate().map(|(i, entry)| resolve(&format!("{name}[{i}]"), entry)).collect()
}

fn steps(written: &[f64]) -> Result<Vec<f64>, SceneProblem> {
    if written.is_empty() {
        return Err(SceneProblem::NoSteps);
    }
    let mut steps = numbered(written, "steps", |key, step| positive(key, "s", *step))?;
    steps.sort_by(|a, b| b.total_cmp(a));
    steps.dedup();
    Ok(steps)
}

fn base(kind: BaseFile, state: Option<&BaseStateFile>, model: &Model) -> Result<Base, SceneProblem> {
    if kind == BaseFile::Fixed {
        return if state.is_some() { Err(SceneProblem::FixedBaseMoves) } else { Ok(Base::Fixed) };
    }
    if model.links[0].name == WORLD && model.links[0].inertial.is_none() {
        return Err(SceneProblem::WorldFloats);
    }
    let Some(state) = state else {
        let zero = Vector3::zeros();
        return Ok(Base::Floating { pose: Isometry3::identity(), linear_velocity: zero, angular_velocity: zero });
    };
    let [w, x, y, z] = state.quaternion_wxyz;
    let quaternion = Quaternion::new(w, x, y, z);
    if !((quaternion.norm() - 1.0).abs() <= QUATERNION_LENGTH) {
        return Err(SceneProblem::NotUnitQuaternion { length: quaternion.norm() });
    }
    let rotation = UnitQuaternion::new_normalize(quaternion);
    Ok(Base::Floating {
        pose: Isometry3::from_parts(Translation3::from(state.position), rotation),
        linear_velocity: Vector3::from(state.linear_velocity),
        angular_velocity: Vector3::from(state.angular_velocity),
    })
}

fn joint_initial(joint: &str, kind: JointKind, state: &JointStateFile) -> Result<JointInitial, SceneProblem> {
    let expected = kind.degrees_of_freedom();
    if expected == 0 {
        let key = format!("initial.joints.{joint}");
        return Err(SceneProblem::FixedJoint { key, joint: joint.to_owned() });
    }
    let values = |what: &str, written: &Option<Numbers>| {
        let values = match written {
            None => vec![0.0; expected],
            Some(Numbers::One(value)) => vec![*value],
            Some(Numbers::Many(values)) => values.clone(),
        };
        let (key, got) = (format!("initial.joints.{joint}.{what}"), values.len());
        let problem = SceneProblem::CoordinateCount { key, joint: joint.to_owned(), kind: kind.name(), expected, got };
        if got == expected { Ok(values) } else { Err(problem) }
    };
    Ok(JointInitial {
        position: values("position", &state.position)?,
        velocity: values("velocity", &state.velocity)?,
        position_given: state.position.is_some(),
        velocity_given: state.velocity.is_some(),
    })
}

fn loops(files: &[LoopFile], names: &Names) -> Result<Vec<Loop>, SceneProblem> {
    let mut used = HashSet::new();
    let resolved = numbered(files, "loops", |key, file| names.closure(key, file))?;
    for (i, closure) in resolved.iter().enumerate() {
        if !used.insert(&closure.name) {
            return Err(SceneProblem::DuplicateLoop { key: format!("loops[{i}]"), name: closure.name.clone() });
        }
    }
    Ok(resolved)
}

/// The names of a model.
struct Names<'a> {
    model: &'a Model,
    links: HashMap<&'a str, usize>,
    joints: HashMap<&'a str, usize>,
}

impl<'a> Names<'a> {
    fn of(model: &'a Model) -> Self {
        let links = model.links.iter().enumerate().map(|(i, l)| (l.name.as_str(), i)).collect();
        let joints = model.joints.iter().enumerate().map(|(i, j)| (j.name.as_str(), i)).collect();
        Names { model, links, joints }
    }

    fn joint(&self, key: &str, joint: &str) -> Result<usize, SceneProblem> {
        let all = || self.model.joints.iter().map(|j| j.name.clone()).collect();
        let problem = || SceneProblem::UnknownJoint { key: key.to_owned(), joint: joint.to_owned(), joints: all() };
        self.joints.get(joint).copied().ok_or_else(problem)
    }

    /// A joint with exactly one coordinate.
    fn single(&self, key: &str, joint: &str) -> Result<usize, SceneProblem> {
        let index = self.joint(key, joint)?;
        let kind = self.model.joints[index].kind;
        let problem =
            || SceneProblem::NotOneCoordinate { key: key.to_owned(), joint: joint.to_owned(), kind: kind.name() };
        if kind.degrees_of_freedom() == 1 { Ok(index) } else { Err(problem()) }
    }

    /// `None` is the ground: `world`, unless the model defines a link of that name.
    fn link(&self, key: &str, link: &str) -> Result<Option<usize>, SceneProblem> {
        match self.links.get(link) {
            Some(&index) => Ok(Some(index)),
            None if link == WORLD => Ok(None),
            None => {
                let links = self.model.links.iter().map(|l| l.name.clone()).collect();
                Err(SceneProblem::UnknownLink { key: key.to_owned(), link: link.to_owned(), links })
            }
        }
    }

    fn closure(&self, key: &str, file: &LoopFile) -> Result<Loop, SceneProblem> {
        let kind = match file.kind {
            LoopKindFile::Revolute => LoopKind::Revolute,
            LoopKindFile::Spherical => LoopKind::Spherical,
            LoopKindFile::Fixed => LoopKind::Fixed,
            LoopKindFile::Prismatic => LoopKind::Prismatic,
        };
        let has_axis = matches!(kind, LoopKind::Revolute | LoopKind::Prismatic);
        let axis = match file.axis {
            Some(axis) => direction(&Vector3::from(axis)).ok_or(SceneProblem::ZeroAxis { key: key.to_owned() })?,
            None if has_axis => {
                let why = "a revolute or prismatic loop needs its axis in the parent_origin frame";
                return Err(SceneProblem::MissingKey { key: key.to_owned(), missing: "axis", why });
            }
            None => Vector3::x_axis(),
        };
        let parent = Place {
            link: self.link(&format!("{key}.parent"), &file.parent)?,
            origin: pose_of(file.parent_origin.xyz, file.parent_origin.rpy),
        };
        let child = Place {
            link: self.link(&format!("{key}.child"), &file.child)?,
            origin: pose_of(file.child_origin.xyz, file.child_origin.rpy),
        };
        if parent.link == child.link {
            return Err(SceneProblem::SameLink { key: key.to_owned(), link: file.parent.clone() });
        }
        Ok(Loop { name: file.name.clone(), kind, axis, parent, child })
    }

    fn spring(&self, key: &str, file: &SpringFile) -> Result<Spring, SceneProblem> {
        let extra = |present: bool, extra, with| {
            let problem = SceneProblem::ExtraKey { key: key.to_owned(), extra, with };
            if present { Err(problem) } else { Ok(()) }
        };
        let stiffness = not_negative(&format!("{key}.stiffness"), "N/m or N m/rad", file.stiffness)?;
        let damping = not_negative(&format!("{key}.damping"), "N s/m or N m s/rad", file.damping)?;
        if let Some(joint) = &file.joint {
            extra(file.from.is_some(), "from", "joint")?;
            extra(file.to.is_some(), "to", "joint")?;
            extra(file.rest_length.is_some(), "rest_length", "joint")?;
            let joint = self.single(&format!("{key}.joint"), joint)?;
            return Ok(Spring::Joint { joint, stiffness, damping, rest: file.rest.unwrap_or(0.0) });
        }
        extra(file.rest.is_some(), "rest", "from and to")?;
        let missing = |missing| {
            let why = "a spring needs \"joint\", or \"from\" and \"to\"";
            SceneProblem::MissingKey { key: key.to_owned(), missing, why }
        };
        let from = self.anchor(&format!("{key}.from"), file.from.as_ref().ok_or_else(|| missing("from"))?)?;
        let to_file = file.to.as_ref().ok_or_else(|| missing("to"))?;
        let to = self.anchor(&format!("{key}.to"), to_file)?;
        if from.link == to.link {
            return Err(SceneProblem::SameLink { key: key.to_owned(), link: to_file.link.clone() });
        }
        let rest_length = not_negative(&format!("{key}.rest_length"), "m", file.rest_length.unwrap_or(0.0))?;
        Ok(Spring::Points { from, to, stiffness, damping, rest_length })
    }

    fn anchor(&self, key: &str, file: &AnchorFile) -> Result<Anchor, SceneProblem> {
        Ok(Anchor { link: self.link(&format!("{key}.link"), &file.link)?, point: Vector3::from(file.point) })
    }

    fn drive(&self, key: &str, file: &DriveFile) -> Result<Drive, SceneProblem> {
        let joint = self.single(&format!("{key}.joint"), &file.joint)?;
        let frequency_hz = match file.frequency_hz {
            Some(frequency) => not_negative(&format!("{key}.frequency_hz"), "Hz", frequency)?,
            None if file.amplitude != 0.0 => {
                let why = "an amplitude needs a frequency in Hz";
                return Err(SceneProblem::MissingKey { key: key.to_owned(), missing: "frequency_hz", why });
            }
            None => 0.0,
        };
        Ok(Drive { joint, effort: file.effort, amplitude: file.amplitude, frequency_hz, phase: file.phase })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::bounds::Limit;

    /// A scene on a model with a hinge `elbow`, a ball joint `ball` and a weld `weld`.
    fn load(text: &str) -> Scene {
        let folder = tempfile::tempdir().unwrap();
        let model = r#"<robot name="r"><link name="base"/><link name="arm"/><link name="hand"/><link name="tool"/>
            <joint name="elbow" type="revolute"><parent link="base"/><child link="arm"/></joint>
            <joint name="ball" type="spherical"><parent link="arm"/><child link="hand"/></joint>
            <joint name="weld" type="fixed"><parent link="hand"/><child link="tool"/></joint></robot>"#;
        let inside = folder.path().join("example");
        std::fs::create_dir(&inside).unwrap();
        std::fs::write(inside.join("m.urdf"), model).unwrap();
        std::fs::write(inside.join("scene.json"), text).unwrap();
        Scene::load(inside.join("scene.json")).unwrap()
    }

    #[test]
    fn a_scene_left_bare_has_the_defaults() {
        let scene = load(r#"{"model": "m.urdf"}"#);
        assert_eq!(scene.name, "example");
        assert_eq!(scene.gravity, Vector3::new(0.0, 0.0, -9.81));
        assert!(matches!(scene.base, Base::Fixed));
        assert_eq!(scene.duration, 10.0);
        assert_eq!(scene.steps, [0.01, 0.005, 0.002, 0.001]);
        let lengths: Vec<_> = scene.initial.iter().map(|i| (i.position.len(), i.velocity.len())).collect();
        assert_eq!(lengths, [(1, 1), (3, 3), (0, 0)]);
    }

    #[test]
    fn initial_values_are_numbers_or_arrays() {
        let scene = load(
            r#"{"model": "m.urdf", "steps": [0.001, 0.01, 0.001], "initial": {"joints": {
                "elbow": {"position": 1, "velocity": [0.5]}, "ball": {"velocity": [1, 2, 3]}}}}"#,
        );
        let both =
            JointInitial { position: vec![1.0], velocity: vec![0.5], position_given: true, velocity_given: true };
        assert_eq!(scene.initial[0], both);
        let turning = JointInitial { position: vec![0.0; 3], velocity: vec![1.0, 2.0, 3.0], ..both };
        assert_eq!(scene.initial[1], JointInitial { position_given: false, ..turning });
        assert_eq!(scene.steps, [0.01, 0.001]);
    }

    #[test]
    fn a_floating_base_has_a_pose_and_velocities() {
        let scene = load(
            r#"{"model": "m.urdf", "base": "floating", "initial": {"base": {"position": [1, 2, 3],
                "quaternion_wxyz": [0.7071068, 0, 0, 0.7071068], "linear_velocity": [4, 5, 6]}}}"#,
        );
        let Base::Floating { pose, linear_velocity, angular_velocity } = scene.base else {
            panic!("the base is fixed")
        };
        assert_eq!(pose.translation.vector, Vector3::new(1.0, 2.0, 3.0));
        approx::assert_relative_eq!(pose.rotation * Vector3::x(), Vector3::y(), epsilon = 1e-15);
        assert_eq!((linear_velocity, angular_velocity), (Vector3::new(4.0, 5.0, 6.0), Vector3::zeros()));
    }

    #[test]
    fn loops_springs_drives_and_bounds_are_kept() {
        let scene = load(
            r#"{"model": "m.urdf",
            "loops": [{"name": "closure", "type": "revolute", "axis": [0, 2, 0], "parent": "tool",
                       "parent_origin": {"xyz": [1, 0, 0]}, "child": "world", "child_origin": {"rpy": [0, 0, 1]}}],
            "springs": [{"joint": "elbow", "stiffness": 100, "damping": 0.1, "rest": 0.2},
                        {"from": {"link": "arm", "point": [1, 2, 3]}, "to": {"link": "world"}, "stiffness": 5, "rest_length": 2}],
            "drives": [{"joint": "elbow", "effort": 1, "amplitude": 2, "frequency_hz": 3, "phase": 4}],
            "bounds": [{"engine": "rattle", "step": 0.001, "duration": 1000, "metric": "energy.final", "max": 1e-4}]}"#,
        );
        let closure = &scene.loops[0];
        assert_eq!((closure.kind, closure.parent.link, closure.child.link), (LoopKind::Revolute, Some(3), None));
        assert_eq!(closure.axis, Vector3::y_axis());
        assert_eq!(closure.parent.origin.translation.x, 1.0);
        assert!((closure.child.origin.rotation.angle() - 1.0).abs() < 1e-15);
        assert!(matches!(scene.springs[0], Spring::Joint { joint: 0, stiffness: 100.0, damping: 0.1, rest: 0.2 }));
        let Spring::Points { from, to, rest_length, .. } = &scene.springs[1] else { panic!("a spring between points") };
        assert_eq!(*from, Anchor { link: Some(1), point: Vector3::new(1.0, 2.0, 3.0) });
        assert_eq!((to.link, *rest_length), (None, 2.0));
        let drive = Drive { joint: 0, effort: 1.0, amplitude: 2.0, frequency_hz: 3.0, phase: 4.0 };
        assert_eq!(scene.drives, [drive]);
        assert_eq!((&scene.bounds[0].max, &scene.bounds[0].min), (&Some(Limit::Number(1e-4)), &None));
        let needs = ["revolute joints", "ball joints", "welded links", "gravity", "revolute loops"];
        assert_eq!(scene.needs()[..5], needs);
        assert_eq!(scene.needs()[5..], ["joint springs", "point springs", "drives"]);
    }
}
