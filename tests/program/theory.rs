//! `rattlebench theory` as scripts see it: files, messages, exit codes.

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::common::rattlebench;

fn theory(arguments: &[&str]) -> Output {
    rattlebench(&["theory"]).args(arguments).output().expect("runs")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

fn folder_text(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Names of the files in a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|e| e.expect("an entry").file_name().into_string().expect("UTF-8")).collect();
    names.sort();
    names
}

#[test]
fn the_topics_asked_for_are_written_and_no_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().to_str().expect("UTF-8");
    let output = theory(&["small-steps", "figure1", "--out", out]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "");
    assert_eq!(
        names(folder.path()),
        ["figure1.json", "figure1.png", "index.html", "small-steps.json", "small-steps.md", "small-steps.png"]
    );
    let page = folder_text(folder.path(), "index.html");
    assert_eq!(page.matches("<img").count(), 2);
    assert!(!page.contains("http://") && !page.contains("src=\"fig"), "the page is self-contained");
    assert!(text(&output.stdout).starts_with("figure1: ") && text(&output.stdout).contains("\nsmall-steps: "));
}

/// Topics computed one at a time into one folder make the same page as topics computed together, and it links the files that
/// are there.
#[test]
fn the_page_has_the_topics_of_the_folder_whenever_they_were_computed() {
    let (one, both) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    let run = |arguments: &[&str], folder: &Path| {
        let output = theory(&[arguments, &["--out", folder.to_str().expect("UTF-8")]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        folder_text(folder, "index.html")
    };
    let links = |page: &str, name: &str| page.contains(&format!("href=\"{name}\""));
    let first = run(&["small-steps"], one.path());
    assert!(links(&first, "small-steps.json") && links(&first, "small-steps.md") && !links(&first, "figure1.json"));
    let second = run(&["figure1"], one.path());
    assert!(links(&second, "small-steps.json") && links(&second, "figure1.json") && !links(&second, "figure1.md"));
    assert!(second.find("id=\"figure1\"") < second.find("id=\"small-steps\""), "in the order of the list");
    let together = run(&["figure1", "small-steps"], both.path());
    let body = |page: &str| page.split("<h2>Command</h2>").next().map(str::to_string);
    assert_eq!(body(&second), body(&together));
    // A file that is not of the theory is named, with a remedy.
    fs::write(one.path().join("figure1.json"), "{}").expect("written");
    let output = theory(&["small-steps", "--out", one.path().to_str().expect("UTF-8")]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("figure1.json: not a file of `theory`"), "{}", text(&output.stderr));
}

#[test]
fn saved_topics_are_drawn_again_to_the_byte_and_match_their_schema() {
    let (folder, again) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    let output = theory(&["figure2", "small-steps", "--out", folder.path().to_str().expect("UTF-8")]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let run = |arguments: &[&str]| rattlebench(arguments).output().expect("runs");
    let before: Vec<Vec<u8>> =
        names(folder.path()).iter().map(|name| fs::read(folder.path().join(name)).expect("a file")).collect();
    let saved = folder.path().join("figure2.json");
    assert!(run(&["chart", saved.to_str().expect("UTF-8")]).status.success());
    let after: Vec<Vec<u8>> =
        names(folder.path()).iter().map(|name| fs::read(folder.path().join(name)).expect("a file")).collect();
    assert!(before == after, "drawn again in its folder");
    let out = again.path().to_str().expect("UTF-8");
    assert!(run(&["chart", saved.to_str().expect("UTF-8"), "--out", out]).status.success());
    assert_eq!(names(again.path()), ["figure2.png", "index.html"]);
    let schema: serde_json::Value = serde_json::from_slice(&run(&["schema", "theory"]).stdout).expect("JSON Schema");
    let file: serde_json::Value = serde_json::from_str(&folder_text(folder.path(), "figure2.json")).expect("JSON");
    for key in file.as_object().expect("an object").keys() {
        assert!(schema["properties"].get(key).is_some(), "{key} is in the schema");
    }
    // The data of another topic are refused.
    let wrong =
        folder_text(folder.path(), "small-steps.json").replace("\"topic\":\"small-steps\"", "\"topic\":\"orders\"");
    let path = again.path().join("wrong.json");
    fs::write(&path, wrong).expect("written");
    let output = run(&["chart", path.to_str().expect("UTF-8")]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("the data are not those of topic \"orders\""), "{}", text(&output.stderr));
}

/// The curves of figure 1 tell what the paper says: RK4 loses energy, Newmark does not.
#[test]
fn figure_1_as_json_holds_the_curves_that_the_picture_shows() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = theory(&["figure1", "--out", folder.path().to_str().expect("UTF-8")]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let json: serde_json::Value = serde_json::from_str(&folder_text(folder.path(), "figure1.json")).expect("JSON");
    assert_eq!(json["schema"], "rattlebench/theory/1");
    let curves = json["data"]["curves"].as_array().expect("curves");
    let energies = |i: usize| -> Vec<f64> {
        let list = curves[i]["energy_J"].as_array().expect("energies");
        list.iter().map(|x| x.as_f64().expect("a number")).collect()
    };
    let (exact, newmark, rk4) = (energies(0)[0], energies(1), energies(2));
    assert!(newmark.len() > 300 && newmark.len() == rk4.len());
    let late = |e: &[f64]| e[e.len() / 2..].iter().sum::<f64>() / (e.len() - e.len() / 2) as f64 / exact;
    // measured 0.981 and 0.659
    assert!((late(&newmark) - 1.0).abs() < 0.04, "{}", late(&newmark));
    assert!(late(&rk4) < 0.8, "{}", late(&rk4));
}

#[test]
fn an_unknown_topic_is_refused_with_the_list() {
    let output = theory(&["order"]);
    assert_eq!(output.status.code(), Some(2));
    let stderr = text(&output.stderr);
    assert!(stderr.starts_with("error: invalid value 'order' for '[TOPIC]...'"), "{stderr}");
    assert!(stderr.contains("[possible values: orders, figure1, figure2, long-time, small-steps]"), "{stderr}");
}

#[test]
fn a_folder_that_cannot_be_made_is_found_before_anything_is_computed() {
    let file = tempfile::NamedTempFile::new().expect("a file");
    let out = file.path().join("theory");
    let output = theory(&["orders", "--out", out.to_str().expect("UTF-8")]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("the folder cannot be made"), "{}", text(&output.stderr));
}
