//! Work per accuracy: the position errors of the compositions on a planar double pendulum at 4000 RATTLE solves over 5 s.

use rattlebench::engines::reference::trajectory;
use rattlebench::mechanics::{State, System};
use rattlebench::variational::Rattle;
use rattlebench::variational::composition::{self, Composition};

use crate::common::*;

/// The state after 5 s of `n` steps.
fn end(system: &System, composition: &Composition, n: usize) -> State {
    let (mut rattle, mut state) = (Rattle::new(system).unwrap(), system.initial.clone());
    for _ in 0..n {
        composition.step(&mut rattle, 5.0 / n as f64).unwrap();
    }
    rattle.write_state(&mut state);
    state
}

/// Two points of 1 kg on rods of 1 m, from horizontal, with g = 9.81 m/s^2; the truth is the reference in joint coordinates.
#[test]
fn position_errors_at_4000_solves_are_as_measured() {
    let system = double_pendulum();
    let truth = &trajectory(&system, &[5.0]).unwrap().states[0];
    // m
    let measured = [4.04e-5, 7.68e-8, 4.98e-10, 2.74e-11];
    for (composition, measured) in composition::ALL.iter().zip(measured) {
        let n = (4000.0 / composition.stages() as f64).round() as usize;
        let reached = end(&system, composition, n);
        let pairs = reached.bodies.iter().zip(&truth.bodies);
        let error = pairs.map(|(a, b)| (a.position - b.position).norm()).fold(0.0, f64::max);
        println!("order {}: {error:e} m", composition.order);
        assert!((0.5..=2.0).contains(&(error / measured)), "order {}: {error:e}", composition.order);
    }
}
