//! The relatives of RATTLE on the constraint manifold: Lobatto IIIA-IIIB, the symplectic Euler maps, SHAKE.

use rattlebench::engines::{self, Spec};
use rattlebench::mechanics::{State, System};
use rattlebench::variational::method::{METHODS, Order, Steps};
use rattlebench::variational::{Ending, Lobatto, Map, Method, Rattle, composition};

use crate::common::*;

fn relative(system: &System, method: Method) -> Rattle {
    Rattle::new(system).unwrap().with_method(method)
}

fn lobatto(system: &System, stages: usize) -> Lobatto {
    Lobatto::new(system, stages).unwrap()
}

/// The state after `steps` steps; the joints hold after each.
fn run(mut map: impl Map, system: &System, h: f64, steps: usize) -> State {
    let (mut state, mut open) = (system.initial.clone(), Open::default());
    for _ in 0..steps {
        map.step(h).unwrap();
        map.write_state(&mut state);
        open.see(system, &state);
    }
    // measured at most 3.0e-15 m and 4.4e-15 m/s
    assert!(open.at_most(7e-15, 1.2e-14), "{open:?}");
    state
}

/// The five links at 0.4 s by order 8 with steps that leave roundoff alone.
fn reference(system: &System) -> State {
    let mut rattle = Rattle::new(system).unwrap();
    for _ in 0..400 {
        composition::ORDER_8.step(&mut rattle, 1e-3).unwrap();
    }
    let mut state = system.initial.clone();
    rattle.write_state(&mut state);
    state
}

/// Fitted order of the error in position and attitude at 0.4 s.
fn order<M: Map>(system: &System, reference: &State, steps: &[usize], map: impl Fn() -> M) -> (f64, Vec<(f64, f64)>) {
    let points: Vec<(f64, f64)> = steps
        .iter()
        .map(|&n| {
            let h = 0.4 / n as f64;
            (h, distance(&run(map(), system, h, n), reference))
        })
        .collect();
    (slope(&points), points)
}

#[test]
fn lobatto_methods_have_order_two_less_than_twice_their_stages() {
    let system = five_links();
    let reference = reference(&system);
    let cases: [(usize, &[usize]); 4] =
        [(2, &[100, 200, 400, 800]), (3, &[40, 80, 160, 320]), (4, &[40, 50, 64, 80]), (5, &[28, 32, 36, 40])];
    for (stages, steps) in cases {
        let (fitted, points) = order(&system, &reference, steps, || lobatto(&system, stages));
        println!("{stages} stages: order {fitted:.2}, {points:?}");
        assert!((fitted - (2 * stages - 2) as f64).abs() <= 0.2, "{stages} stages: order {fitted}");
        assert!(points.iter().all(|p| p.1 > 2e-13), "above roundoff");
    }
}

#[test]
fn two_stages_are_rattle() {
    let system = five_links();
    let (mut rattle, mut two) = (relative(&system, Method::Rattle), lobatto(&system, 2));
    let (mut a, mut b) = (system.initial.clone(), system.initial.clone());
    let mut worst = 0.0_f64;
    for _ in 0..1000 {
        rattle.step(1e-3).unwrap();
        two.step(1e-3).unwrap();
        rattle.write_state(&mut a);
        two.write_state(&mut b);
        worst = worst.max(distance(&a, &b));
    }
    println!("differ by {worst:.1e}");
    assert!(distance(&a, &system.initial) > 0.1, "it moves");
    // measured 2.3e-15
    assert!(worst <= 6e-15, "{worst:e}");
    let three = run(lobatto(&system, 3), &system, 1e-3, 1000);
    assert!(distance(&three, &a) > 1e-6, "three stages are another map");
}

/// Runs, turns the velocities round, and runs again.
fn missed<M: Map>(system: &System, map: impl Fn(&System) -> M) -> f64 {
    let mut state = run(map(system), system, 5e-3, 100);
    assert!(distance(&state, &system.initial) > 0.1);
    state = reversed(state);
    let back = System { initial: state, ..system.clone() };
    distance(&run(map(&back), &back, 5e-3, 100), &system.initial)
}

#[test]
fn symmetric_methods_return_to_the_start_and_the_euler_maps_do_not() {
    let system = five_links();
    let stages = [2, 3, 4, 5].map(|count| missed(&system, |s| lobatto(s, count)));
    let rattle = missed(&system, |s| relative(s, Method::Rattle));
    let euler = [Method::EulerA, Method::EulerB].map(|method| missed(&system, |s| relative(s, method)));
    println!("Lobatto {stages:?}, RATTLE {rattle:.1e}, Euler {euler:?}");
    // measured at most 3.2e-14
    assert!(stages.iter().chain([&rattle]).all(|m| *m <= 1e-13), "{stages:?} {rattle:e}");
    assert!(euler.iter().all(|m| *m > 1e-4), "{euler:?}");
}

#[test]
fn the_euler_maps_have_order_one() {
    let system = five_links();
    let reference = reference(&system);
    for method in [Method::EulerA, Method::EulerB] {
        let (fitted, points) = order(&system, &reference, &[400, 800, 1600, 3200], || relative(&system, method));
        println!("{method:?}: order {fitted:.2}, {points:?}");
        assert!((fitted - 1.0).abs() <= 0.2, "{method:?}: order {fitted}");
    }
}

/// `EulerB` with `-h` takes back what `EulerA` did with `h`.
#[test]
fn the_euler_maps_are_adjoints_of_each_other() {
    let system = five_links();
    let start = system.initial.clone();
    let back = |first: Method, second: Method| {
        let mut state = start.clone();
        let mut forward = Rattle::new(&system).unwrap().with_method(first);
        forward.step(5e-3).unwrap();
        forward.write_state(&mut state);
        let mut backward = Rattle::from_state(&system, &state).unwrap().with_method(second);
        backward.step(-5e-3).unwrap();
        backward.write_state(&mut state);
        let velocity = state
            .bodies
            .iter()
            .zip(&start.bodies)
            .map(|(a, b)| (a.velocity - b.velocity).norm().max((a.angular_velocity - b.angular_velocity).norm()));
        velocity.fold(distance(&state, &start), f64::max)
    };
    use Method::{EulerA, EulerB};
    let (adjoint, own) = ([back(EulerA, EulerB), back(EulerB, EulerA)], [back(EulerA, EulerA), back(EulerB, EulerB)]);
    println!("adjoint {adjoint:?}, own {own:?}");
    // measured at most 1.5e-15, and 9.5e-4
    assert!(adjoint.iter().all(|d| *d <= 5e-15), "{adjoint:?}");
    assert!(own.iter().all(|d| *d > 3e-4), "{own:?}");
}

#[test]
fn shake_has_the_states_of_rattle() {
    // measured at most 9.9e-12 in 60 starts, as two runs that differ by roundoff, and 3.0e-15 where dampers calm the motion
    let both = |start| [(start, five_links(), 2.5e-11), (start, damped(), 8e-15)];
    for (start, mut system, most) in (0..10).flat_map(both) {
        system.gravity *= 1.0 + 1e-3 * f64::from(start);
        let (mut rattle, mut shake) = (relative(&system, Method::Rattle), relative(&system, Method::Shake));
        let (mut a, mut b) = (system.initial.clone(), system.initial.clone());
        let (mut worst, mut open) = (0.0_f64, Open::default());
        for k in 0..1000 {
            // Steps of two sizes: the momenta of the middles belong to the means of neighbours.
            let h = if k % 3 == 0 { 1.5e-3 } else { 1e-3 };
            rattle.step(h).unwrap();
            shake.step(h).unwrap();
            rattle.write_state(&mut a);
            shake.write_state(&mut b);
            open.see(&system, &b);
            worst = worst.max(distance(&a, &b));
        }
        println!("differ by {worst:.1e}, {open:?}");
        // joints measured at most 2.6e-15 m and 7.1e-15 m/s in these 20 runs
        assert!(worst <= most && open.at_most(7e-15, 1.8e-14), "{worst:e} {open:?}");
    }
}

/// The five links with a damper in a hinge and in the ball joint.
fn damped() -> System {
    let mut system = five_links();
    system.bodies[1].joint.damping = 0.05;
    system.bodies[2].joint.damping = 0.1;
    system
}

#[test]
fn lobatto_refuses_what_it_cannot_do_by_name() {
    use rattlebench::variational::lobatto::Unfit;
    assert_eq!(Lobatto::new(&damped(), 3).unwrap_err(), Unfit::Damped { joint: 1 });
    let mut plate = five_links();
    plate.bodies[4].inertia = nalgebra::Vector3::new(0.01, 0.02, 0.03);
    assert!(matches!(Lobatto::new(&plate, 3).unwrap_err(), Unfit::Flat { body: 4, .. }));
}

/// Order and reversibility; but for the method with steps of its own, whose order shows in its first step only
/// (`energy_momentum.rs`).
#[test]
fn every_method_is_what_its_row_of_facts_says() {
    let system = five_links();
    let reference = reference(&system);
    for facts in METHODS.iter().filter(|facts| facts.steps != Steps::HoldingEnergy) {
        let spec = Spec::parse(&format!("rattle:method={}", facts.name)).unwrap();
        let end = |system: &System, n: usize| {
            let mut engine = engines::build(&spec, system, 0.4 / n as f64).unwrap();
            (0..n).for_each(|_| engine.step().unwrap());
            let mut state = system.initial.clone();
            engine.write_state(&mut state);
            state
        };
        let (order, counts) = match facts.order {
            Order::Fixed(1) => (1.0, [400, 800, 1600, 3200]),
            Order::Fixed(order) => (f64::from(order), [100, 200, 400, 800]),
            // three stages, the default
            Order::OfStages => (4.0, [40, 80, 160, 320]),
        };
        let points = counts.map(|n| (0.4 / n as f64, distance(&end(&system, n), &reference)));
        let fitted = slope(&points);
        let back = System { initial: reversed(end(&system, 80)), ..system.clone() };
        let missed = distance(&end(&back, 80), &system.initial);
        println!("{}: order {fitted:.2}, comes back to {missed:.1e}", facts.name);
        assert!((fitted - order).abs() <= 0.2, "{}: order {fitted}", facts.name);
        // measured at most 1.2e-13 (shake), and 3e-2 and more where it is not reversible
        assert_eq!(missed <= 3e-13, facts.time_reversible, "{}: {missed:e}", facts.name);
        assert!(facts.time_reversible || missed > 1e-2, "{}: {missed:e}", facts.name);
    }
}

#[test]
fn every_solve_is_ended_by_one_rule() {
    let steps = 500;
    for (system, tolerance, unbiased) in [
        (five_links(), 0.0, false),
        (five_links(), 1e-8, false),
        (five_links(), 0.0, true),
        (shipped("four_bar"), 0.0, false),
    ] {
        let mut rattle = Rattle::new(&system).unwrap().with_tolerance(tolerance);
        if unbiased {
            rattle = rattle.with_unbiased_roundoff();
        }
        (0..steps).for_each(|_| rattle.step(1e-3).unwrap());
        let counters = rattle.counters();
        let ended: u64 = counters.endings().map(|(_, count)| count).sum();
        println!("{counters:?}");
        assert!(counters.solves == steps && ended == steps && counters.rounds >= steps, "{counters:?}");
        let by = |rule: Ending| counters.endings().find(|(ending, _)| *ending == rule).unwrap().1;
        assert_eq!(by(Ending::Tolerance) > 0, tolerance > 0.0, "{counters:?}");
        assert_eq!(by(Ending::Unbiased) > 0, unbiased, "{counters:?}");
    }
}
