//! The energy error of order 8 grows like a random walk of roundoff (Brouwer 1937; Hairer, McLachlan and Razakarivony 2008).

mod common;

use common::*;
use rattlebench::mechanics::{System, energy};
use rattlebench::model::Scene;
use rattlebench::variational::{Failure, Rattle, composition};

/// Perturbed starts.
const RUNS: usize = 12;

/// s
const STEP: f64 = 2e-3;

/// Relative energy errors over all runs at times that double up to the end.
struct Ensemble {
    /// Number of solves and rms error.
    rms: Vec<(f64, f64)>,
    /// Mean and its standard error at the end.
    mean: (f64, f64),
}

/// Twelve runs, each of the given number of RATTLE solves.
fn ensemble(start: fn(usize) -> System, solves: usize, tolerance: f64) -> Result<Ensemble, Failure> {
    let errors: Vec<Vec<(f64, f64)>> =
        (0..RUNS).map(|run| errors(&start(run), solves, tolerance)).collect::<Result<_, _>>()?;
    let rms = |k: usize| (errors.iter().map(|run| run[k].1.powi(2)).sum::<f64>() / RUNS as f64).sqrt();
    let points = errors[0].len();
    let mean = errors.iter().map(|run| run[points - 1].1).sum::<f64>() / RUNS as f64;
    let variance =
        errors.iter().map(|run| (run[points - 1].1 - mean).powi(2)).sum::<f64>() / (RUNS * (RUNS - 1)) as f64;
    Ok(Ensemble { rms: (0..points).map(|k| (errors[0][k].0, rms(k))).collect(), mean: (mean, variance.sqrt()) })
}

/// A spatial chain of three links, hinges about y, z and y, released bent and at rest, each time a little differently.
fn chain_of_three(run: usize) -> System {
    let mut scene = alternating(3);
    for (k, joint) in scene.initial.iter_mut().enumerate() {
        joint.position = vec![[0.3, 0.4, -0.5][k] + 1e-3 * run as f64];
    }
    compile(&scene)
}

/// The shipped crank-rocker, whose crank goes round, each time with a little more gravity.
fn four_bar(run: usize) -> System {
    let mut scene = Scene::load(format!("{}/models/four_bar/scene.json", env!("CARGO_MANIFEST_DIR"))).unwrap();
    scene.gravity *= 1.0 + 1e-3 * run as f64;
    compile(&scene)
}

/// The error at the solves `n, n/2, n/4, ...`, newest last: the mean over the sixteenth of the run before, in which what the method
/// itself leaves oscillates.
fn errors(system: &System, solves: usize, tolerance: f64) -> Result<Vec<(f64, f64)>, Failure> {
    let weights: Vec<f64> = composition::ORDER_8.weights().map(|w| w * STEP).collect();
    let steps = solves / weights.len();
    let mut rattle = Rattle::new(system).unwrap().with_tolerance(tolerance);
    let mut state = system.initial.clone();
    let start = energy::energy(system, &state).total();
    let marks: Vec<usize> = (0..6).rev().map(|k| steps >> k).collect();
    let (mut out, mut sum, mut count) = (Vec::new(), 0.0, 0);
    for step in 1..=steps {
        for weight in &weights {
            rattle.step(*weight)?;
        }
        let mark = marks[out.len()];
        if step > mark - mark / 16 - 1 {
            rattle.write_state(&mut state);
            sum += (energy::energy(system, &state).total() - start) / system.energy_scale;
            count += 1;
        }
        if step == mark {
            out.push(((step * weights.len()) as f64, sum / count as f64));
            (sum, count) = (0.0, 0);
        }
    }
    Ok(out)
}

/// A step that is refused, as with a loop left open, is none.
fn is_a_random_walk(found: &Result<Ensemble, Failure>, most: f64) -> bool {
    let found = match found {
        Ok(found) => found,
        Err(failure) => {
            println!("{failure:?}");
            return false;
        }
    };
    let end = found.rms[found.rms.len() - 1].1;
    let exponent = slope(&found.rms);
    println!(
        "rms {end:.1e}, exponent {exponent:.2}, mean {:.1e} +- {:.1e}, {:?}",
        found.mean.0, found.mean.1, found.rms
    );
    end <= most && (0.3..=0.7).contains(&exponent) && found.mean.0.abs() <= 3.0 * found.mean.1
}

/// A short twin of the tests below.
#[test]
fn roundoff_leaves_a_random_walk_and_a_loose_tolerance_does_not() {
    // measured 1.2e-16, exponent 0.39, mean -8.5e-18 +- 3.6e-17
    assert!(is_a_random_walk(&ensemble(chain_of_three, 100_000, 0.0), 4e-16));
    // Negative control
    assert!(!is_a_random_walk(&ensemble(chain_of_three, 30_000, 1e-8), 4e-16));
}

#[test]
fn roundoff_leaves_a_random_walk_on_a_linkage() {
    // measured 5.2e-16, exponent 0.55, mean -2.3e-16 +- 1.4e-16; a drift of 2.2e-20 a solve leaves 6.6e-15
    assert!(is_a_random_walk(&ensemble(four_bar, 300_000, 0.0), 1.5e-15));
    // Negative control: the loop is left open.
    assert!(!is_a_random_walk(&ensemble(four_bar, 30_000, 1e-8), 1.5e-15));
}

/// `cargo test --release --test brouwer -- --ignored --nocapture` takes about ten minutes for the chain, fifteen for the linkage.
#[test]
#[ignore = "takes minutes"]
fn ten_million_solves_leave_a_random_walk() {
    assert!(is_a_random_walk(&ensemble(chain_of_three, 10_000_000, 0.0), 1e-13));
    assert!(!is_a_random_walk(&ensemble(chain_of_three, 1_000_000, 1e-8), 1e-13));
}

#[test]
#[ignore = "takes minutes"]
fn ten_million_solves_of_a_linkage_leave_a_random_walk() {
    assert!(is_a_random_walk(&ensemble(four_bar, 10_000_000, 0.0), 1e-13));
    assert!(!is_a_random_walk(&ensemble(four_bar, 1_000_000, 1e-8), 1e-13));
}
