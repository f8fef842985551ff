//! Loops: closing them at the start, and keeping them closed.
use rattlebench::mechanics::{System, constraint};
use rattlebench::model::Scene;

#[test]
fn a_four_bar_is_closed_from_its_crank() {
    let scene = Scene::load("models/four_bar/scene.json").unwrap();
    let system = System::compile(&scene).unwrap();
    println!("{:?} {:?}", system.mobility, constraint::residual(&system, &system.initial));
    println!("{:?}", system.initial_coordinates);
}
