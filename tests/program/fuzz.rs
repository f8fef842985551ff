//! Random input: URDF text, scene text, small models. Nothing may panic, hang or return what is not a number.
//!
//! `PROPTEST_CASES=100000 cargo test --release --test program fuzz` searches longer.

use std::path::Path;

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use proptest::sample::{Index, select};

use rattlebench::engines::{self, Spec};
use rattlebench::mechanics::{State, System, constraint, energy};
use rattlebench::model::assemble::{Assembly, Mount};
use rattlebench::model::scene::JointInitial;
use rattlebench::model::{Inertial, JointKind, Scene, read_urdf};

use crate::common::rattlebench;

/// Words that have broken readers of XML, JSON and numbers.
const WORDS: &[&str] = &[
    "",
    "0",
    "-1",
    "1e999",
    "-1e999",
    "NaN",
    "inf",
    "1e-320",
    "9007199254740993",
    "0x10",
    "1,0",
    "\u{feff}",
    "\0",
    "é",
    "<",
    ">",
    "\"",
    "{",
    "}",
    "[",
    "]",
    "null",
    "true",
    "${x}",
    "&amp;",
    "<!--",
    "]]>",
    "<link name=\"base\"/>",
    "type=\"fixed\"",
    "type=\"floating\"",
    "<inertial/>",
    "<mass value=\"0\"/>",
    "xyz=\"0 0 0\"",
    "world",
];

/// Numbers, most of them possible.
const NUMBERS: &[&str] =
    &["0", "-1", "0.5", "3.14", "1e-3", "1e3", "-0", "1e-320", "9007199254740993", "1e12", "1e999", "NaN"];

/// An edit of a text.
#[derive(Clone, Debug)]
enum Edit {
    Delete(Index, usize),
    Repeat(Index, usize),
    Insert(Index, &'static str),
    /// Replaces the next number.
    Number(Index, &'static str),
    /// Replaces the next name in quotes by another that is in the text.
    Swap(Index, Index),
}

fn edit() -> impl Strategy<Value = Edit> {
    let place = any::<Index>;
    prop_oneof![
        (place(), 0..200usize).prop_map(|(at, n)| Edit::Delete(at, n)),
        (place(), 0..400usize).prop_map(|(at, n)| Edit::Repeat(at, n)),
        (place(), select(WORDS)).prop_map(|(at, word)| Edit::Insert(at, word)),
        (place(), select(WORDS)).prop_map(|(at, word)| Edit::Number(at, word)),
        (place(), place()).prop_map(|(a, b)| Edit::Swap(a, b)),
    ]
}

fn apply(text: &str, edit: &Edit) -> String {
    let letters: Vec<char> = text.chars().collect();
    let count = letters.len();
    if count == 0 {
        return text.to_string();
    }
    let part = |from: usize, to: usize| letters[from.min(count)..to.min(count)].iter().collect::<String>();
    match edit {
        Edit::Delete(at, n) => part(0, at.index(count)) + &part(at.index(count) + n, count),
        Edit::Repeat(at, n) => {
            let (at, end) = (at.index(count), (at.index(count) + n).min(count));
            part(0, end) + &part(at, count)
        }
        Edit::Insert(at, word) => part(0, at.index(count)) + word + &part(at.index(count), count),
        Edit::Number(at, word) => {
            let is_part = |c: char| c.is_ascii_digit() || ".-+e".contains(c);
            let from = (at.index(count)..count).find(|&i| letters[i].is_ascii_digit()).unwrap_or(0);
            let to = (from..count).find(|&i| !is_part(letters[i])).unwrap_or(count);
            part(0, from) + word + &part(to, count)
        }
        Edit::Swap(a, b) => {
            let pieces: Vec<&str> = text.split('"').collect();
            let (a, b) = (a.index(pieces.len()), b.index(pieces.len()));
            let swapped = pieces.iter().enumerate().map(|(i, piece)| if i == a { pieces[b] } else { piece });
            swapped.collect::<Vec<_>>().join("\"")
        }
    }
}

/// Texts after a few edits; half of them only after such as leave the text well-formed.
fn edited(texts: Vec<String>) -> impl Strategy<Value = String> {
    let place = any::<Index>;
    let gentle = prop_oneof![
        6 => (place(), select(NUMBERS)).prop_map(|(at, number)| Edit::Number(at, number)),
        1 => (place(), place()).prop_map(|(a, b)| Edit::Swap(a, b)),
    ];
    let edits = prop_oneof![prop::collection::vec(edit(), 1..6), prop::collection::vec(gentle, 1..3)];
    (select(texts), edits).prop_map(|(text, edits)| edits.iter().fold(text, |text, edit| apply(&text, edit)))
}

/// The texts of all shipped files with this ending, with one that has every kind of element.
fn shipped(ending: &str, more: &str) -> Vec<String> {
    let mut texts = vec![more.to_string()];
    for folder in std::fs::read_dir("models").expect("models/") {
        for file in std::fs::read_dir(folder.expect("readable").path()).expect("a folder") {
            let path = file.expect("readable").path();
            if path.extension().is_some_and(|e| e == ending) {
                texts.push(std::fs::read_to_string(path).expect("UTF-8"));
            }
        }
    }
    assert!(texts.len() > 5, "{} files end in .{ending}", texts.len());
    texts
}

const URDF: &str = r#"<robot name="r"><link name="base"/>
  <link name="arm"><inertial><origin xyz="0.1 0 0" rpy="0 0.1 0"/><mass value="1"/>
    <inertia ixx="0.1" ixy="0.01" ixz="0" iyy="0.2" iyz="0" izz="0.25"/></inertial>
    <collision><origin xyz="0 0 1"/><geometry><box size="1 2 3"/></geometry></collision></link>
  <link name="hand"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.25"/></inertial>
    <collision><geometry><mesh filename="missing.stl" scale="1 1 1"/></geometry></collision></link>
  <link name="tool"/>
  <joint name="elbow" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 1" rpy="0.1 0.2 0.3"/>
    <axis xyz="0 1 1"/><limit lower="-1" upper="1" effort="10" velocity="3"/><dynamics damping="0.1" friction="0.2"/></joint>
  <joint name="ball" type="spherical"><parent link="arm"/><child link="hand"/></joint>
  <joint name="weld" type="fixed"><parent link="hand"/><child link="tool"/></joint></robot>"#;

const SCENE: &str = r#"{"model": "m.urdf", "gravity": [0, 0, -9.81], "density": 1000, "base": "fixed",
  "initial": {"joints": {"elbow": {"position": 1, "velocity": [0.5]}, "ball": {"velocity": [1, 2, 3]}}},
  "loops": [{"name": "closure", "type": "revolute", "axis": [0, 2, 0], "parent": "tool",
             "parent_origin": {"xyz": [1, 0, 0]}, "child": "world", "child_origin": {"rpy": [0, 0, 1]}}],
  "springs": [{"joint": "elbow", "stiffness": 100, "damping": 0.1, "rest": 0.2},
              {"from": {"link": "arm", "point": [1, 2, 3]}, "to": {"link": "world"}, "stiffness": 5, "rest_length": 2}],
  "drives": [{"joint": "elbow", "effort": 1, "amplitude": 2, "frequency_hz": 3, "phase": 4}],
  "duration": 1, "steps": [0.01],
  "bounds": [{"engine": "rattle", "step": 0.001, "duration": 1000, "metric": "energy.final", "max": 1e-4}]}"#;

fn write(folder: &Path, name: &str, text: &str) -> std::path::PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    path
}

/// Compiles what was read and takes a few steps with the core: a result or a named failure, and never what is not a number.
fn run_a_little(scene: &Scene) -> Result<(), TestCaseError> {
    let Ok(system) = System::compile(scene) else { return Ok(()) };
    prop_assert!(system.initial.is_finite(), "the initial state is not a number");
    run(&system, "rattle", 0.01, 3)
}

/// Steps an engine; every state that it returns before a named failure is a number, and so are its figures.
fn run(system: &System, engine: &str, step: f64, steps: usize) -> Result<(), TestCaseError> {
    let spec = Spec::parse(engine).expect("a spec");
    let mut engine = match engines::build(&spec, system, step) {
        Ok(engine) => engine,
        Err(unsupported) => {
            prop_assert!(!unsupported.what.is_empty());
            return Ok(());
        }
    };
    let mut state: State = system.initial.clone();
    for n in 0..steps {
        if let Err(failure) = engine.step() {
            prop_assert!(failure.to_string().len() > 10, "{failure}");
            engine.write_state(&mut state);
            prop_assert!(state.is_finite(), "the state after a failed step {n}");
            return Ok(());
        }
        engine.write_state(&mut state);
        prop_assert!(state.is_finite(), "step {n} of {step} s");
        let residual = constraint::residual(system, &state);
        prop_assert!(residual.position.is_finite() && residual.velocity.is_finite(), "step {n}");
        prop_assert!(energy::energy(system, &state).total().is_finite(), "step {n}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn urdf_text_is_read_or_refused_with_a_message(text in edited(shipped("urdf", URDF))) {
        let folder = tempfile::tempdir().expect("a folder");
        match read_urdf(write(folder.path(), "m.urdf", &text)) {
            Err(error) => prop_assert!(error.to_string().contains("m.urdf:"), "{error}"),
            Ok(model) => run_a_little(&Scene::of_model("m", model))?,
        }
    }

    #[test]
    fn scene_text_is_read_or_refused_with_a_message(text in edited(shipped("json", SCENE))) {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["m.urdf", "double_pendulum.urdf", "pendulum.urdf", "arm.urdf"] {
            write(folder.path(), name, URDF);
        }
        match Scene::load(write(folder.path(), "scene.json", &text)) {
            Err(error) => prop_assert!(error.to_string().contains(": "), "{error}"),
            Ok(scene) => run_a_little(&scene)?,
        }
    }
}

/// A number whose size spans decades.
fn decades(from: i32, to: i32) -> impl Strategy<Value = f64> {
    (f64::from(from)..f64::from(to)).prop_map(|x| 10f64.powf(x))
}

fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-size..size).prop_map(Vector3::from)
}

fn inertial() -> impl Strategy<Value = Inertial> {
    (decades(-6, 6), vector(1.0), prop::array::uniform3(decades(-4, 0)), vector(3.0)).prop_map(
        |(mass, com, m, turn)| {
            let axes = UnitQuaternion::new(turn).to_rotation_matrix().into_inner();
            let inertia = axes * Matrix3::from_diagonal(&(mass * Vector3::from(m))) * axes.transpose();
            Inertial { mass, com, inertia: 0.5 * (inertia + inertia.transpose()) }
        },
    )
}

/// A joint with its place, its damping, the choice of its parent, and its initial coordinates.
type Limb = (JointKind, Vector3<f64>, Vector3<f64>, Vector3<f64>, f64, Index, [f64; 6], [f64; 6], Inertial);

fn limb() -> impl Strategy<Value = Limb> {
    use JointKind::{Continuous, Fixed, Planar, Prismatic, Spherical};
    let kind = select(vec![Continuous, Continuous, Prismatic, Spherical, Planar, Fixed]);
    let damping = prop_oneof![3 => Just(0.0), 1 => decades(-6, 12)];
    let (position, velocity) = (prop::array::uniform6(-4.0..4.0), prop::array::uniform6(-20.0..20.0));
    let axis = vector(1.0).prop_filter("an axis has a direction", |a| a.norm() > 1e-3);
    (kind, axis, vector(1.0), vector(3.0), damping, any::<Index>(), position, velocity, inertial())
}

fn random_scene(limbs: &[Limb], gravity: Vector3<f64>) -> Scene {
    let mut assembly = Assembly::new("random");
    for (i, (kind, axis, place, turn, damping, parent, _, _, inertial)) in limbs.iter().enumerate() {
        let origin = Isometry3::from_parts(Translation3::from(*place), UnitQuaternion::new(*turn));
        let axis = nalgebra::Unit::new_normalize(*axis);
        assembly.add(
            parent.index(i + 1),
            Mount { kind: *kind, axis, origin, damping: *damping },
            Some(inertial.clone()),
        );
    }
    let mut scene = Scene { gravity, ..assembly.scene() };
    for (initial, limb) in scene.initial.iter_mut().zip(limbs) {
        let count = initial.position.len();
        let (position, velocity) = (limb.6[..count].to_vec(), limb.7[..count].to_vec());
        *initial = JointInitial { position, velocity, position_given: true, velocity_given: true };
    }
    scene
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_models_run_or_are_refused_with_a_reason(
        limbs in prop::collection::vec(limb(), 1..6),
        gravity in vector(10.0),
        step in decades(-6, -1),
        engine in select(vec!["rattle", "rattle:rotation=cayley", "rattle:order=4", "rapier:preset=strong", "rapier"]),
    ) {
        if let Ok(system) = System::compile(&random_scene(&limbs, gravity)) {
            run(&system, engine, step, 50)?;
        }
    }
}

/// The command itself, on a few: exit code 0 or 3, and no row that holds what is not a number.
#[test]
fn simulate_writes_numbers_or_ends_with_a_reason() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let texts = edited(shipped("urdf", URDF));
    let folder = tempfile::tempdir().expect("a folder");
    let (mut ran, mut refused) = (0, 0);
    for _ in 0..60 {
        let text = texts.new_tree(&mut runner).expect("a text").current();
        let path = write(folder.path(), "m.urdf", &text);
        let path = path.to_str().expect("UTF-8");
        let mut command = rattlebench(&["simulate", path, "--engine", "rattle", "--step", "0.01", "--duration", "0.1"]);
        let output = command.output().expect("runs");
        let (rows, message) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        match output.status.code() {
            Some(0) => ran += 1,
            Some(2 | 3) => {
                refused += 1;
                assert!(message.contains("error: ") && !message.contains("panicked"), "{message}\n{text}");
            }
            code => panic!("exit code {code:?}: {message}\n{text}"),
        }
        let numbers = rows.lines().skip(1).flat_map(|row| row.split(','));
        assert!(numbers.map(str::parse).all(|x: Result<f64, _>| x.is_ok_and(f64::is_finite)), "{rows}\n{text}");
    }
    assert!(ran >= 5 && refused >= 5, "{ran} ran, {refused} were refused");
}
