//! Work per accuracy: the position errors of the compositions on a planar double pendulum at 4000 RATTLE solves over 5 s.

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

/// The figures that this is compared with are those of another implementation in quadruple precision, of a planar double
/// pendulum whose parameters are not stated: 2.7e-5, 4.2e-8, 2.7e-10 (13 stages) and 2.8e-11 (17 stages). The pendulum
/// here is the one of the textbooks.
#[test]
fn position_errors_at_4000_solves_are_within_a_factor_two_of_those_of_quadruple_precision() {
    let system = double_pendulum();
    let truth = end(&system, &composition::ORDER_8, 4000);
    for (composition, quoted) in composition::ALL.iter().zip([2.7e-5, 4.2e-8, 2.7e-10, 2.8e-11]) {
        let n = (4000.0 / composition.stages() as f64).round() as usize;
        let reached = end(&system, composition, n);
        let pairs = reached.bodies.iter().zip(&truth.bodies);
        let error = pairs.map(|(a, b)| (a.position - b.position).norm()).fold(0.0, f64::max);
        println!("order {}: {error:e} m, {:.2} of the quoted", composition.order, error / quoted);
        // measured 1.5, 1.8, 1.9 and 1.0
        assert!((0.5..=2.0).contains(&(error / quoted)), "order {}: {error:e}", composition.order);
    }
}
