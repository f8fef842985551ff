//! The relatives of RATTLE on the constraint manifold: Lobatto IIIA-IIIB, the symplectic Euler maps, SHAKE.

mod common;

use common::*;
use rattlebench::mechanics::{State, System, constraint};
use rattlebench::variational::{Failure, Lobatto, Method, Rattle, composition};

/// A map from a state to the next.
enum Map {
    Rattle(Rattle),
    Lobatto(Lobatto),
}

impl Map {
    fn rattle(system: &System, method: Method) -> Map {
        Map::Rattle(Rattle::new(system).unwrap().with_method(method))
    }

    fn lobatto(system: &System, stages: usize) -> Map {
        Map::Lobatto(Lobatto::new(system, stages).unwrap())
    }

    fn step(&mut self, h: f64) -> Result<(), Failure> {
        match self {
            Map::Rattle(rattle) => rattle.step(h),
            Map::Lobatto(lobatto) => lobatto.step(h),
        }
    }

    fn write_state(&self, out: &mut State) {
        match self {
            Map::Rattle(rattle) => rattle.write_state(out),
            Map::Lobatto(lobatto) => lobatto.write_state(out),
        }
    }

    /// The state after `steps` steps; the joints hold after each.
    fn run(mut self, system: &System, h: f64, steps: usize) -> State {
        let mut state = system.initial.clone();
        for _ in 0..steps {
            self.step(h).unwrap();
            self.write_state(&mut state);
            let residual = constraint::residual(system, &state);
            assert!(residual.position <= 1e-13 && residual.velocity <= 1e-12, "{residual:?}");
        }
        state
    }
}

/// The five links at 0.4 s by order 8 with steps that leave roundoff alone.
fn reference(system: &System) -> State {
    let mut rattle = Rattle::new(system).unwrap();
    for _ in 0..400 {
        for weight in composition::ORDER_8.weights() {
            rattle.step(weight * 1e-3).unwrap();
        }
    }
    let mut state = system.initial.clone();
    rattle.write_state(&mut state);
    state
}

/// Fitted order of the error in position and attitude at 0.4 s.
fn order(system: &System, reference: &State, steps: &[usize], map: impl Fn() -> Map) -> (f64, Vec<(f64, f64)>) {
    let points: Vec<(f64, f64)> = steps
        .iter()
        .map(|&n| {
            let h = 0.4 / n as f64;
            (h, distance(&map().run(system, h, n), reference))
        })
        .collect();
    (slope(&points), points)
}

#[test]
fn lobatto_methods_have_order_two_less_than_twice_their_stages() {
    let system = five_links();
    let reference = reference(&system);
    let cases: [(usize, &[usize]); 4] = [
        (2, &[100, 200, 400, 800]),
        (3, &[40, 80, 160, 320]),
        (4, &[20, 28, 40, 56]),
        (5, &[12, 16, 20, 28]),
    ];
    for (stages, steps) in cases {
        let (fitted, points) = order(&system, &reference, steps, || Map::lobatto(&system, stages));
        println!("{stages} stages: order {fitted:.2}, {points:?}");
        assert!((fitted - (2 * stages - 2) as f64).abs() <= 0.2, "{stages} stages: order {fitted}");
        assert!(points.iter().all(|p| p.1 > 1e-13), "above roundoff");
    }
}
