//! From a scene file to a [`Scene`]: names become indices, numbers are checked.

use std::collections::HashSet;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::bounds;
use super::data::{Base, JointInitial, Scene};
use super::error::{SceneProblem, positive};
use super::file::{BaseFile, BaseStateFile, JointStateFile, LoopFile, Numbers, SceneFile};
use super::index::Names;
use super::parts::Loop;
use crate::model::joint::JointKind;
use crate::model::robot::Model;
use crate::model::urdf::WORLD;

/// How far the length of a quaternion may be from 1: the digits that files print.
const QUATERNION_LENGTH: f64 = 1e-6;

pub(super) fn scene(file: SceneFile, name: &str, model: Model) -> Result<Scene, SceneProblem> {
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

#[cfg(test)]
mod tests {
    use super::super::bounds::Limit;
    use super::super::parts::{Anchor, Drive, LoopKind, Spring};
    use super::*;

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
                        {"from": {"link": "arm", "point": [1, 2, 3]}, "to": {"link": "world"}, "stiffness": 5,
                         "rest_length": 2}],
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
