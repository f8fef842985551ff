//! Every bad input ends with one message that names file, element, value and remedy. The messages are pinned whole.

use std::fs;
use std::path::Path;

use proptest::prelude::*;
use rattlebench::model::Scene;

use crate::common::rattlebench;

/// The message for a URDF file `bad.urdf` of that text; the folder reads `<dir>`.
fn urdf(text: &str) -> String {
    message(&[("bad.urdf", text)], "bad.urdf")
}

/// The message for `links and joints` inside `<robot name="r">`, which starts on line 1.
fn robot(inside: &str) -> String {
    urdf(&format!("<robot name=\"r\">\n{inside}\n</robot>\n"))
}

/// The message for a scene file `scene.json` of that text beside a model of two links on one hinge, `elbow`, and one weld.
fn scene(text: &str) -> String {
    message(&[("scene.json", text), ("good.urdf", GOOD)], "scene.json")
}

/// As [`scene`], with the given keys besides `model`.
fn scene_with(keys: &str) -> String {
    scene(&format!("{{\"model\": \"good.urdf\",\n{keys}}}"))
}

fn message(files: &[(&str, &str)], load: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let error = Scene::load(folder.path().join(load)).expect_err("the input is bad").to_string();
    error.replace(&folder.path().display().to_string(), "<dir>")
}

const GOOD: &str = r#"<robot name="good">
  <link name="base"/>
  <link name="arm"><inertial><mass value="1"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="hand"/>
  <joint name="elbow" type="revolute"><parent link="base"/><child link="arm"/></joint>
  <joint name="weld" type="fixed"><parent link="arm"/><child link="hand"/></joint>
</robot>"#;

const AB: &str = r#"<link name="a"/><link name="b"/>"#;

/// A hinge `j` from `a` to `b` with something inside.
fn hinge(inside: &str) -> String {
    robot(&format!(r#"{AB}<joint name="j" type="revolute"><parent link="a"/><child link="b"/>{inside}</joint>"#))
}

/// A link `a` with that mass and inertia.
fn massive(mass: &str, moments: [&str; 6]) -> String {
    let [ixx, ixy, ixz, iyy, iyz, izz] = moments;
    robot(&format!(
        r#"<link name="a"><inertial><mass value="{mass}"/>
<inertia ixx="{ixx}" ixy="{ixy}" ixz="{ixz}" iyy="{iyy}" iyz="{iyz}" izz="{izz}"/></inertial></link>"#
    ))
}

const UNIT: [&str; 6] = ["1", "0", "0", "1", "0", "1"];

#[test]
fn good_input_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("good.urdf"), GOOD).unwrap();
    let scene = Scene::load(folder.path().join("good.urdf")).unwrap();
    assert_eq!((scene.model.links.len(), scene.model.joints.len()), (3, 2));
}

#[test]
fn missing_file() {
    let error = |path: &str| Scene::load(Path::new(path)).unwrap_err().to_string();
    insta::assert_snapshot!(error("no/such.urdf"), @"no/such.urdf: no such file; give the path of a .urdf file or of a scene .json file");
    insta::assert_snapshot!(error("no/such.json"), @"no/such.json: no such file; give the path of a .urdf file or of a scene .json file");
    insta::assert_snapshot!(error("Cargo.toml"), @"Cargo.toml: is neither a .urdf file nor a scene .json file; give one of these");
}

#[test]
fn a_folder_is_not_a_file() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("bad.urdf")).unwrap();
    let error = Scene::load(folder.path().join("bad.urdf")).unwrap_err().to_string();
    insta::assert_snapshot!(error.replace(&folder.path().display().to_string(), "<dir>"), @"<dir>/bad.urdf: cannot be read: Is a directory (os error 21)");
}

#[test]
fn bytes_that_are_not_text() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bad.urdf"), [0xff, 0xfe, 0x00]).unwrap();
    let error = Scene::load(folder.path().join("bad.urdf")).unwrap_err().to_string();
    insta::assert_snapshot!(error.replace(&folder.path().display().to_string(), "<dir>"), @"<dir>/bad.urdf: is not UTF-8 text; a URDF is XML in UTF-8");
}

#[test]
fn malformed_xml() {
    insta::assert_snapshot!(urdf(""), @"<dir>/bad.urdf:1:1: malformed XML: the document does not have a root node");
    insta::assert_snapshot!(urdf("<robot name=\"r\">\n  <link name=\"a\">\n</robot>"), @"<dir>/bad.urdf:3:1: malformed XML: expected 'link' tag, not 'robot'");
    insta::assert_snapshot!(urdf("<robot name=\"r\">\n  <link name=\"a\"/>"), @"<dir>/bad.urdf:2:19: malformed XML: the root node was opened but never closed");
    insta::assert_snapshot!(robot("<link name=\"a\" name=\"b\"/>"), @"<dir>/bad.urdf:2:16: malformed XML: attribute 'name' is already defined");
    insta::assert_snapshot!(urdf("<!DOCTYPE robot [<!ENTITY a \"b\">]><robot name=\"r\"/>"), @"<dir>/bad.urdf:1:1: malformed XML: document types are not read; remove <!DOCTYPE ...>");
    insta::assert_snapshot!(urdf("<sdf version=\"1.9\"/>"), @"<dir>/bad.urdf:1:1: root element is <sdf>; a URDF has <robot>");
    insta::assert_snapshot!(robot(""), @"<dir>/bad.urdf:1:1: <robot> has no <link>; a model needs at least one");
}

#[test]
fn xacro_left_in() {
    insta::assert_snapshot!(robot("<link name=\"${prefix}arm\"/>"), @r#"<dir>/bad.urdf:2:1: holds xacro that was not expanded: name="${prefix}arm"; run `xacro FILE > model.urdf` first and give model.urdf"#);
    insta::assert_snapshot!(robot("<xacro:arm parent=\"base\"/>"), @"<dir>/bad.urdf:2:2: holds xacro that was not expanded: an element <xacro:...>; run `xacro FILE > model.urdf` first and give model.urdf");
    let declared = "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n<xacro:property name=\"m\" value=\"1\"/></robot>";
    insta::assert_snapshot!(urdf(declared), @"<dir>/bad.urdf:2:1: holds xacro that was not expanded: <xacro:property>; run `xacro FILE > model.urdf` first and give model.urdf");
    insta::assert_snapshot!(robot("<link name=\"a\"><inertial><mass value=\"$(arg mass)\"/></inertial></link>"), @r#"<dir>/bad.urdf:2:26: holds xacro that was not expanded: value="$(arg mass)"; run `xacro FILE > model.urdf` first and give model.urdf"#);
}

#[test]
fn undefined_link() {
    let joint = |parent: &str, child: &str| {
        format!(r#"<joint name="elbow" type="fixed"><parent link="{parent}"/><child link="{child}"/></joint>"#)
    };
    let links = r#"<link name="base"/><link name="upper_arm"/>"#;
    insta::assert_snapshot!(robot(&format!("{links}{}", joint("forearm", "base"))), @"<dir>/bad.urdf: joint 'elbow': parent link 'forearm' is not defined; links are: base, upper_arm");
    insta::assert_snapshot!(robot(&format!("{links}{}", joint("base", "upper_arn"))), @"<dir>/bad.urdf: joint 'elbow': child link 'upper_arn' is not defined; did you mean 'upper_arm'? links are: base, upper_arm");
    insta::assert_snapshot!(robot(&format!("{links}{}", joint("base", "world"))), @"<dir>/bad.urdf: joint 'elbow': child link 'world' is not defined; links are: base, upper_arm");
}

#[test]
fn duplicate_names() {
    insta::assert_snapshot!(robot(r#"<link name="a"/><link name="a"/>"#), @"<dir>/bad.urdf: link 'a': is defined more than once; rename one of them");
    let joint =
        |child: &str| format!(r#"<joint name="j" type="fixed"><parent link="a"/><child link="{child}"/></joint>"#);
    insta::assert_snapshot!(robot(&format!(r#"{AB}<link name="c"/>{}{}"#, joint("b"), joint("c"))), @"<dir>/bad.urdf: joint 'j': is defined more than once; rename one of them");
}

#[test]
fn names_and_elements_that_are_missing_or_repeated() {
    insta::assert_snapshot!(robot("<link/>"), @r#"<dir>/bad.urdf:2:1: <link> has no name; give it name="...""#);
    insta::assert_snapshot!(robot(&format!("{AB}<joint name=\" \" type=\"fixed\"/>")), @r#"<dir>/bad.urdf:2:33: <joint> has no name; give it name="...""#);
    insta::assert_snapshot!(robot(&format!("{AB}<joint name=\"j\"/>")), @r#"<dir>/bad.urdf:2:33: joint 'j': <joint> has no attribute type="...""#);
    insta::assert_snapshot!(robot(&format!("{AB}<joint name=\"j\" type=\"fixed\"><child link=\"b\"/></joint>")), @"<dir>/bad.urdf:2:33: joint 'j': <parent> is missing");
    insta::assert_snapshot!(robot(&format!("{AB}<joint name=\"j\" type=\"fixed\"><parent/><child link=\"b\"/></joint>")), @r#"<dir>/bad.urdf:2:62: joint 'j': <parent> has no attribute link="...""#);
    insta::assert_snapshot!(hinge("<parent link=\"b\"/>"), @"<dir>/bad.urdf:2:100: joint 'j': has more than one <parent>; keep one");
    insta::assert_snapshot!(robot("<link name=\"a\"><inertial><mass value=\"1\"/></inertial></link>"), @"<dir>/bad.urdf:2:16: link 'a': <inertia> is missing");
    insta::assert_snapshot!(robot("<link name=\"a\"><inertial/><inertial/></link>"), @"<dir>/bad.urdf:2:27: link 'a': has more than one <inertial>; keep one");
}

#[test]
fn two_parents() {
    let joint = |name: &str, parent: &str| {
        format!(r#"<joint name="{name}" type="fixed"><parent link="{parent}"/><child link="c"/></joint>"#)
    };
    let text = format!(r#"{AB}<link name="c"/>{}{}"#, joint("j1", "a"), joint("j2", "b"));
    insta::assert_snapshot!(robot(&text), @r#"<dir>/bad.urdf: link 'c': is the child of joint 'j1' and of joint 'j2'; a link has one parent, and a loop is closed by "loops" in a scene file"#);
}

#[test]
fn a_cycle() {
    let joint = |name: &str, parent: &str, child: &str| {
        format!(r#"<joint name="{name}" type="fixed"><parent link="{parent}"/><child link="{child}"/></joint>"#)
    };
    insta::assert_snapshot!(robot(&format!("{AB}{}{}", joint("j1", "a", "b"), joint("j2", "b", "a"))), @r#"<dir>/bad.urdf: joint 'j2': closes a cycle of links a -> b -> a; a URDF is a tree, and a loop is closed by "loops" in a scene file"#);
    insta::assert_snapshot!(robot(&format!("{AB}{}", joint("j1", "b", "b"))), @r#"<dir>/bad.urdf: joint 'j1': closes a cycle of links b -> b; a URDF is a tree, and a loop is closed by "loops" in a scene file"#);
}

#[test]
fn several_roots() {
    insta::assert_snapshot!(robot(r#"<link name="a"/><link name="b"/><link name="c"/>"#), @"<dir>/bad.urdf: has 3 root links: a, b, c; join them by joints, so that one is left");
    let world = r#"<joint name="j" type="fixed"><parent link="world"/><child link="b"/></joint>"#;
    insta::assert_snapshot!(robot(&format!("{AB}{world}")), @"<dir>/bad.urdf: has 2 root links: world, a; join them by joints, so that one is left");
}

#[test]
fn unknown_joint_type() {
    let joint = r#"<joint name="j" type="ball"><parent link="a"/><child link="b"/></joint>"#;
    insta::assert_snapshot!(robot(&format!("{AB}{joint}")), @"<dir>/bad.urdf:2:33: joint 'j': type 'ball' is not known; types are: fixed, revolute, continuous, prismatic, planar, spherical, floating");
}

#[test]
fn zero_axis() {
    insta::assert_snapshot!(hinge(r#"<axis xyz="0 0 0"/>"#), @"<dir>/bad.urdf: joint 'j': axis is 0 0 0; give it a direction such as 0 0 1");
}

#[test]
fn numbers_that_are_none() {
    insta::assert_snapshot!(hinge(r#"<axis xyz="0 1"/>"#), @r#"<dir>/bad.urdf:2:100: joint 'j': <axis xyz="0 1"> is not 3 numbers"#);
    insta::assert_snapshot!(hinge(r#"<axis xyz="0 one 0"/>"#), @r#"<dir>/bad.urdf:2:100: joint 'j': <axis xyz="0 one 0"> is not 3 numbers"#);
    insta::assert_snapshot!(hinge(r#"<axis xyz="0 1 0 up"/>"#), @r#"<dir>/bad.urdf:2:100: joint 'j': <axis xyz="0 1 0 up"> is not 3 numbers"#);
    insta::assert_snapshot!(hinge("<axis/>"), @r#"<dir>/bad.urdf:2:100: joint 'j': <axis> has no attribute xyz="...""#);
    insta::assert_snapshot!(massive("1 kg", UNIT), @r#"<dir>/bad.urdf:2:26: link 'a': <mass value="1 kg"> is not a number"#);
}

#[test]
fn numbers_that_are_not_finite() {
    insta::assert_snapshot!(massive("nan", UNIT), @r#"<dir>/bad.urdf:2:26: link 'a': <mass value="nan"> is not finite; write a finite number"#);
    insta::assert_snapshot!(massive("1", ["1", "0", "0", "inf", "0", "1"]), @r#"<dir>/bad.urdf:3:1: link 'a': <inertia iyy="inf"> is not finite; write a finite number"#);
    insta::assert_snapshot!(hinge(r#"<origin xyz="0 0 1e999"/>"#), @r#"<dir>/bad.urdf:2:100: joint 'j': <origin xyz="0 0 1e999"> is not finite; write a finite number"#);
    insta::assert_snapshot!(hinge(r#"<dynamics damping="-inf"/>"#), @r#"<dir>/bad.urdf:2:100: joint 'j': <dynamics damping="-inf"> is not finite; write a finite number"#);
}

#[test]
fn impossible_quaternions() {
    insta::assert_snapshot!(hinge(r#"<origin quat_xyzw="0 0 0 0"/>"#), @r#"<dir>/bad.urdf:2:100: joint 'j': <origin quat_xyzw="0 0 0 0"> is zero; write a quaternion of length 1"#);
    insta::assert_snapshot!(hinge(r#"<origin rpy="0 0 0" quat_xyzw="0 0 0 1"/>"#), @"<dir>/bad.urdf:2:100: joint 'j': <origin> has both rpy and quat_xyzw; keep one");
}

#[test]
fn negative_mass() {
    insta::assert_snapshot!(massive("-1", UNIT), @"<dir>/bad.urdf: link 'a': mass must be >= 0 kg, got -1");
}

#[test]
fn inertia_without_mass() {
    insta::assert_snapshot!(massive("0", UNIT), @"<dir>/bad.urdf: link 'a': mass is 0 kg but inertia is not zero; give it a mass, or inertia 0 for a link without mass");
}

#[test]
fn inertia_with_a_negative_eigenvalue() {
    insta::assert_snapshot!(massive("1", ["1", "0", "0", "-0.5", "0", "1"]), @"<dir>/bad.urdf: link 'a': inertia has the negative principal moment -5.000000e-1 kg m^2 (the others: 1.000000e0, 1.000000e0); correct ixx, ixy, ixz, iyy, iyz, izz");
    // Every entry is positive and so is the diagonal; the eigenvalues are -1, 3 and 5.
    insta::assert_snapshot!(massive("1", ["1", "2", "0", "1", "0", "5"]), @"<dir>/bad.urdf: link 'a': inertia has the negative principal moment -1.000000e0 kg m^2 (the others: 3.000000e0, 5.000000e0); correct ixx, ixy, ixz, iyy, iyz, izz");
}

#[test]
fn negative_damping() {
    insta::assert_snapshot!(hinge(r#"<dynamics damping="-0.1"/>"#), @"<dir>/bad.urdf: joint 'j': damping must be >= 0, got -0.1");
}

#[test]
fn mimic_of_no_joint() {
    insta::assert_snapshot!(hinge(r#"<mimic joint="k"/>"#), @"<dir>/bad.urdf: joint 'j': mimics joint 'k', which is not defined; joints are: j");
    insta::assert_snapshot!(hinge(r#"<mimic joint="j"/>"#), @"<dir>/bad.urdf: joint 'j': mimics itself; name another joint");
}

#[test]
fn scene_that_is_no_json() {
    insta::assert_snapshot!(scene(""), @"<dir>/scene.json:1:0: EOF while parsing a value; `rattlebench schema scene` prints what a scene may hold");
    insta::assert_snapshot!(scene("{\"model\": \"good.urdf\",\n \"gravity\": [0, 0]}"), @"<dir>/scene.json:2:18: gravity: invalid length 2, expected an array of length 3; `rattlebench schema scene` prints what a scene may hold");
    insta::assert_snapshot!(scene("{\"model\": \"good.urdf\",\n \"duration\": 1e999}"), @"<dir>/scene.json:2:18: duration: number out of range; `rattlebench schema scene` prints what a scene may hold");
    insta::assert_snapshot!(scene("{\"model\": \"good.urdf\",\n \"duration\": NaN}"), @"<dir>/scene.json:2:14: duration: expected value; `rattlebench schema scene` prints what a scene may hold");
    insta::assert_snapshot!(scene("{}"), @"<dir>/scene.json:1:2: missing key 'model'; `rattlebench schema scene` prints what a scene may hold");
}

#[test]
fn unknown_key_in_the_scene() {
    insta::assert_snapshot!(scene_with(r#""gravty": [0, 0, 0]"#), @"<dir>/scene.json:2:8: gravty: unknown key 'gravty', expected one of 'model', 'description', 'gravity', 'density', 'base', 'initial', 'loops', 'springs', 'drives', 'duration', 'steps', 'bounds'; `rattlebench schema scene` prints what a scene may hold");
    insta::assert_snapshot!(scene_with(r#""springs": [{"joint": "elbow", "stifness": 1}]"#), @"<dir>/scene.json:2:41: springs[0].stifness: unknown key 'stifness', expected one of 'joint', 'from', 'to', 'stiffness', 'damping', 'rest', 'rest_length'; `rattlebench schema scene` prints what a scene may hold");
    insta::assert_snapshot!(scene_with(r#""base": "free""#), @"<dir>/scene.json:2:14: base: unknown value 'free', expected 'fixed' or 'floating'; `rattlebench schema scene` prints what a scene may hold");
    insta::assert_snapshot!(scene_with(r#""duration": 1, "duration": 2"#), @"<dir>/scene.json:2:25: duplicate key 'duration'; `rattlebench schema scene` prints what a scene may hold");
    insta::assert_snapshot!(scene_with(r#""initial": {"joints": {"elbow": {}, "elbow": {}}}"#), @"<dir>/scene.json:2:43: initial.joints: 'elbow' stands twice; `rattlebench schema scene` prints what a scene may hold");
}

#[test]
fn unknown_joint_or_link_in_the_scene() {
    insta::assert_snapshot!(scene_with(r#""initial": {"joints": {"elbw": {"position": 1}}}"#), @"<dir>/scene.json: initial.joints.elbw: joint 'elbw' is not defined; did you mean 'elbow'? joints are: elbow, weld");
    insta::assert_snapshot!(scene_with(r#""drives": [{"joint": "knee", "effort": 1}]"#), @"<dir>/scene.json: drives[0].joint: joint 'knee' is not defined; joints are: elbow, weld");
    insta::assert_snapshot!(scene_with(
        r#""loops": [{"name": "l", "type": "spherical", "parent": "base", "child": "foot"}]"#
    ), @"<dir>/scene.json: loops[0].child: link 'foot' is not defined; links are: base, arm, hand, and world");
    insta::assert_snapshot!(scene_with(
        r#""springs": [{"from": {"link": "world"}, "to": {"link": "arms"}, "stiffness": 1}]"#
    ), @"<dir>/scene.json: springs[0].to.link: link 'arms' is not defined; did you mean 'arm'? links are: base, arm, hand, and world");
}

#[test]
fn model_that_is_not_there() {
    insta::assert_snapshot!(scene(r#"{"model": "goood.urdf"}"#), @"<dir>/scene.json: model 'goood.urdf' is not found at <dir>/goood.urdf; the path is relative to the scene file");
}

#[test]
fn errors_of_the_model_name_the_model() {
    let files = [("scene.json", r#"{"model": "bad.urdf"}"#), ("bad.urdf", "<robot name=\"r\"/>")];
    insta::assert_snapshot!(message(&files, "scene.json"), @"<dir>/bad.urdf:1:1: <robot> has no <link>; a model needs at least one");
}

#[test]
fn steps_and_durations_that_are_not_positive() {
    insta::assert_snapshot!(scene_with(r#""steps": [0.01, -0.001]"#), @"<dir>/scene.json: steps[1] must be > 0 s, got -0.001");
    insta::assert_snapshot!(scene_with(r#""steps": [0]"#), @"<dir>/scene.json: steps[0] must be > 0 s, got 0");
    insta::assert_snapshot!(scene_with(r#""steps": []"#), @"<dir>/scene.json: steps is empty; list at least one step in s, or leave it out");
    insta::assert_snapshot!(scene_with(r#""steps": ["small"]"#), @r#"<dir>/scene.json:2:17: steps[0]: invalid type: string "small", expected a number; `rattlebench schema scene` prints what a scene may hold"#);
    insta::assert_snapshot!(scene_with(r#""duration": 0"#), @"<dir>/scene.json: duration must be > 0 s, got 0");
    insta::assert_snapshot!(scene_with(r#""density": -1000"#), @"<dir>/scene.json: density must be > 0 kg/m^3, got -1000");
}

#[test]
fn impossible_initial_states() {
    insta::assert_snapshot!(scene_with(r#""initial": {"joints": {"weld": {"position": 1}}}"#), @"<dir>/scene.json: initial.joints.weld: joint 'weld' is fixed and has no coordinates; remove it here");
    insta::assert_snapshot!(scene_with(r#""initial": {"joints": {"elbow": {"velocity": [1, 2]}}}"#), @"<dir>/scene.json: initial.joints.elbow.velocity: joint 'elbow' is revolute and takes 1 number, got 2");
    insta::assert_snapshot!(scene_with(r#""initial": {"joints": {"elbow": {"position": "up"}}}"#), @"<dir>/scene.json:2:50: initial.joints.elbow.position: expected a number or an array of numbers; `rattlebench schema scene` prints what a scene may hold");
    insta::assert_snapshot!(scene_with(r#""initial": {"base": {"position": [0, 0, 1]}}"#), @r#"<dir>/scene.json: initial.base is given, but the base is fixed; add "base": "floating" or remove initial.base"#);
    insta::assert_snapshot!(
        scene_with(r#""base": "floating", "initial": {"base": {"quaternion_wxyz": [1, 1, 0, 0]}}"#), @"<dir>/scene.json: initial.base.quaternion_wxyz has length 1.4142135623730951; write a quaternion of length 1"
    );
}

#[test]
fn a_world_that_floats() {
    let model = r#"<robot name="r"><link name="a"/>
        <joint name="j" type="floating"><parent link="world"/><child link="a"/></joint></robot>"#;
    let files = [("scene.json", r#"{"model": "m.urdf", "base": "floating"}"#), ("m.urdf", model)];
    insta::assert_snapshot!(message(&files, "scene.json"), @r#"<dir>/scene.json: base is floating, but the root link 'world' is the ground; use "base": "fixed", or name the root otherwise"#);
}

#[test]
fn impossible_loops() {
    let closure = |rest: &str| scene_with(&format!(r#""loops": [{{"name": "l", {rest}}}]"#));
    insta::assert_snapshot!(closure(r#""type": "revolute", "parent": "base", "child": "arm""#), @"<dir>/scene.json: loops[0]: axis is missing; a revolute or prismatic loop needs its axis in the parent_origin frame");
    insta::assert_snapshot!(closure(r#""type": "prismatic", "axis": [0, 0, 0], "parent": "base", "child": "arm""#), @"<dir>/scene.json: loops[0].axis is 0 0 0; give it a direction such as [0, 0, 1]");
    insta::assert_snapshot!(closure(r#""type": "ball", "parent": "base", "child": "arm""#), @"<dir>/scene.json:2:38: loops[0].type: unknown value 'ball', expected one of 'revolute', 'spherical', 'fixed', 'prismatic'; `rattlebench schema scene` prints what a scene may hold");
    insta::assert_snapshot!(closure(r#""type": "fixed", "parent": "arm", "child": "arm""#), @"<dir>/scene.json: loops[0]: both ends are on 'arm'; name two links that move against each other");
    let twice = r#"{"name": "l", "type": "fixed", "parent": "base", "child": "arm"}"#;
    insta::assert_snapshot!(scene_with(&format!(r#""loops": [{twice}, {twice}]"#)), @"<dir>/scene.json: loops[1]: name 'l' is used before; rename one of them");
}

#[test]
fn impossible_springs_and_drives() {
    let spring = |text: &str| scene_with(&format!(r#""springs": [{{{text}}}]"#));
    insta::assert_snapshot!(spring(r#""stiffness": 1"#), @r#"<dir>/scene.json: springs[0]: from is missing; a spring needs "joint", or "from" and "to""#);
    insta::assert_snapshot!(spring(r#""joint": "elbow", "stiffness": -1"#), @"<dir>/scene.json: springs[0].stiffness must be >= 0 N/m or N m/rad, got -1");
    insta::assert_snapshot!(spring(r#""joint": "elbow", "stiffness": 1, "damping": -2"#), @"<dir>/scene.json: springs[0].damping must be >= 0 N s/m or N m s/rad, got -2");
    insta::assert_snapshot!(spring(r#""joint": "weld", "stiffness": 1"#), @"<dir>/scene.json: springs[0].joint: joint 'weld' is fixed; it must be revolute, continuous or prismatic");
    insta::assert_snapshot!(spring(r#""joint": "elbow", "stiffness": 1, "rest_length": 1"#), @"<dir>/scene.json: springs[0]: rest_length does not go with joint; remove it");
    insta::assert_snapshot!(spring(r#""from": {"link": "arm"}, "stiffness": 1"#), @r#"<dir>/scene.json: springs[0]: to is missing; a spring needs "joint", or "from" and "to""#);
    insta::assert_snapshot!(spring(r#""from": {"link": "arm"}, "to": {"link": "arm"}, "stiffness": 1"#), @"<dir>/scene.json: springs[0]: both ends are on 'arm'; name two links that move against each other");
    insta::assert_snapshot!(scene_with(r#""drives": [{"joint": "elbow", "amplitude": 1}]"#), @"<dir>/scene.json: drives[0]: frequency_hz is missing; an amplitude needs a frequency in Hz");
}

#[test]
fn a_bound_without_a_bound() {
    let bound = r#""bounds": [{"engine": "rattle", "step": 0.01, "duration": 1, "metric": "energy.final"}]"#;
    insta::assert_snapshot!(scene_with(bound), @r#"<dir>/scene.json: bounds[0]: max is missing; a bound needs "max", "min" or both"#);
}

#[test]
fn density_that_a_shape_cannot_use() {
    let with_shape = |shape: &str| {
        let model = format!(
            r#"<robot name="r"><link name="a"><collision><geometry>{shape}</geometry></collision></link></robot>"#
        );
        message(&[("scene.json", r#"{"model": "m.urdf", "density": 1000}"#), ("m.urdf", &model)], "scene.json")
    };
    insta::assert_snapshot!(with_shape(r#"<sphere radius="-0.1"/>"#), @"<dir>/m.urdf: link 'a': density needs the size of its collision sphere, and radius must be > 0 m, got -0.1");
    insta::assert_snapshot!(with_shape(r#"<box size="1 0 1"/>"#), @"<dir>/m.urdf: link 'a': density needs the size of its collision box, and size must be > 0 m, got 0");
    insta::assert_snapshot!(with_shape(r#"<cylinder radius="1"/>"#), @r#"<dir>/m.urdf:1:53: link 'a': <cylinder> has no attribute length="...""#);
    insta::assert_snapshot!(with_shape(r#"<mesh filename="part.stl"/>"#), @"<dir>/m.urdf: link 'a': density needs collision mesh 'part.stl', which is not found at <dir>/part.stl; put it there, or give the link an <inertial>");
    insta::assert_snapshot!(with_shape(r#"<mesh filename="package://robot/meshes/part.stl"/>"#), @"<dir>/m.urdf: link 'a': density needs collision mesh 'package://robot/meshes/part.stl', which is not found at <dir>/robot/meshes/part.stl; put it there, or give the link an <inertial>");
    insta::assert_snapshot!(with_shape(r#"<mesh filename="m.urdf"/>"#), @"<dir>/m.urdf: link 'a': density needs collision mesh 'm.urdf', which cannot be used: it is no STL, OBJ or COLLADA file; give the link an <inertial>");
}

#[test]
fn the_command_line_says_it_once_and_ends_with_code_2() {
    let run = |arguments: &[&str]| {
        let output = rattlebench(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(output.stdout.is_empty());
        String::from_utf8(output.stderr).unwrap()
    };
    insta::assert_snapshot!(run(&["inspect", "no/such.urdf"]), @"error: no/such.urdf: no such file; give the path of a .urdf file or of a scene .json file");
    insta::assert_snapshot!(run(&["inspect", "no/such.json", "--json"]), @"error: no/such.json: no such file; give the path of a .urdf file or of a scene .json file");
    insta::assert_snapshot!(run(&["generate", "chain", "--length", "-1"]), @"error: --length must be > 0 m, got -1");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        load_both(&bytes);
    }

    /// One to four cuts, doublings and replacements in a good file.
    #[test]
    fn mutated_files_never_panic(edits in proptest::collection::vec((any::<prop::sample::Index>(), 0..40_usize, 0..SPARE.len()), 1..5)) {
        for good in [RICH, RICH_SCENE] {
            let mut bytes = good.as_bytes().to_vec();
            for (place, length, spare) in &edits {
                let start = place.index(bytes.len() + 1);
                let end = (start + length).min(bytes.len());
                bytes.splice(start..end, SPARE[*spare].bytes());
            }
            load_both(&bytes);
        }
    }
}

/// What a mutation may put in.
const SPARE: [&str; 14] =
    ["", "\"", "<", "/>", "nan", "-1", "1e400", "0 0 0", "world", "<link name=\"a\"/>", "&amp;", "\u{0}", "[]", "é"];

/// Every element that is read.
const RICH: &str = r#"<?xml version="1.0"?><robot name="good" version="1.2"><link name="base"/>
<link name="arm"><inertial><origin xyz="0 0 1" rpy="0 0.1 0"/><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0.1" iyy="1" iyz="0" izz="1"/></inertial><collision><origin xyz="1 0 0"/>
<geometry><cylinder radius="0.1" length="1"/></geometry></collision></link>
<link name="hand"><collision><geometry><mesh filename="a.stl" scale="1 1 1"/></geometry></collision></link>
<joint name="elbow" type="revolute"><origin quat_xyzw="0 0 0 1"/><parent link="base"/><child link="arm"/><axis xyz="0 2 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/><dynamics damping="0.1" friction="0.2"/></joint>
<joint name="ball" type="spherical"><parent link="arm"/><child link="hand"/><mimic joint="elbow" multiplier="2"/></joint>
<transmission name="t"/></robot>"#;

const RICH_SCENE: &str = r#"{"model": "input.urdf", "gravity": [0, 0, -9.81], "density": 1000, "base": "floating",
"initial": {"joints": {"elbow": {"position": 1, "velocity": [0.5]}}, "base": {"quaternion_wxyz": [1, 0, 0, 0]}},
"loops": [{"name": "l", "type": "revolute", "axis": [0, 1, 0], "parent": "arm", "child": "world"}],
"springs": [{"joint": "elbow", "stiffness": 1}, {"from": {"link": "arm"}, "to": {"link": "base"}, "stiffness": 1}],
"drives": [{"joint": "elbow", "amplitude": 1, "frequency_hz": 2}], "duration": 1, "steps": [0.1],
"bounds": [{"engine": "rattle", "step": 0.1, "duration": 1, "metric": "m", "max": 1}]}"#;

/// Loads the bytes as a URDF, with and without density, and as a scene. Errors are fine; a message is never empty.
fn load_both(bytes: &[u8]) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("input.urdf"), bytes).unwrap();
    fs::write(folder.path().join("scene.json"), bytes).unwrap();
    fs::write(folder.path().join("dense.json"), r#"{"model": "input.urdf", "density": 1000}"#).unwrap();
    for file in ["input.urdf", "scene.json", "dense.json"] {
        if let Err(error) = Scene::load(folder.path().join(file)) {
            assert!(!error.to_string().is_empty());
        }
    }
}
