//! Loops: closing them at the start, and keeping them closed.
use rattlebench::mechanics::{System, constraint, energy};
use rattlebench::model::Scene;
use rattlebench::variational::Rattle;

#[test]
fn a_four_bar_is_closed_from_its_crank() {
    let scene = Scene::load("models/four_bar/scene.json").unwrap();
    let system = System::compile(&scene).unwrap();
    println!("{:?} {:?}", system.mobility, constraint::residual(&system, &system.initial));
    for h in [0.01, 0.005, 0.002, 0.001, 0.0005] {
        let mut rattle = Rattle::new(&system).unwrap();
        let mut state = system.initial.clone();
        let e0 = energy::energy(&system, &state).total();
        let (mut worst, mut res) = (0.0_f64, (0.0_f64, 0.0_f64));
        let n = (10.0 / h) as usize;
        for k in 0..n {
            if let Err(f) = rattle.step(h) {
                println!("{k} {f:?}");
                break;
            }
            rattle.write_state(&mut state);
            let e = energy::energy(&system, &state).total();
            let r = constraint::residual(&system, &state);
            worst = worst.max((e - e0).abs() / system.energy_scale);
            res = (res.0.max(r.position), res.1.max(r.velocity));
        }
        println!("{h} {worst:e} {res:?} rounds {}", rattle.rounds() as f64 / n as f64);
    }
}
