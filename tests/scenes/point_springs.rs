//! Springs with dampers between points of bodies: the closed form of their map, the rigid limit, stiffness without bound,
//! order, energy balance and reversibility.

use nalgebra::{Matrix3, Vector3};
use rattlebench::engines::{self, Spec};
use rattlebench::mechanics::{Anchor, PointSpring, State, System, energy};
use rattlebench::model::JointKind::*;
use rattlebench::variational::composition::{self, Composition};
use rattlebench::variational::{Failure, Rattle};

use crate::common::*;

fn anchor(body: Option<usize>, x: f64, y: f64, z: f64) -> Anchor {
    Anchor { body, point: Vector3::new(x, y, z) }
}

fn spring(from: Anchor, to: Anchor, stiffness: f64, damping: f64, rest_length: f64) -> PointSpring {
    PointSpring { from, to, stiffness, damping, rest_length }
}

/// The same system with these springs, its energy scale made anew.
fn sprung(system: &System, springs: Vec<PointSpring>) -> System {
    let mut sprung = system.clone();
    sprung.parts.point_springs = springs;
    sprung.energy_scale = energy::scale(&sprung);
    sprung
}

/// States after every step.
fn run(system: &System, composition: &Composition, h: f64, steps: usize, mut see: impl FnMut(&State)) {
    let mut rattle = Rattle::new(system).unwrap();
    let mut state = system.initial.clone();
    for _ in 0..steps {
        composition.step(&mut rattle, h).unwrap();
        rattle.write_state(&mut state);
        assert!(state.is_finite());
        see(&state);
    }
}

/// Largest relative energy error of a run without dampers.
fn energy_error(system: &System, composition: &Composition, h: f64, steps: usize) -> f64 {
    let start = energy::energy(system, &system.initial).total();
    let mut worst = 0.0_f64;
    run(system, composition, h, steps, |state| {
        worst = worst.max((energy::energy(system, state).total() - start).abs() / system.energy_scale);
    });
    worst
}

/// The states at ten times within 1 s, of `n` steps a second.
fn sampled(system: &System, composition: &Composition, n: usize) -> Vec<State> {
    let mut states = Vec::new();
    let mut taken = 0;
    run(system, composition, 1.0 / n as f64, n, |state| {
        taken += 1;
        if taken * 10 % n == 0 {
            states.push(state.clone());
        }
    });
    states
}

fn farthest(a: &[State], b: &[State]) -> f64 {
    a.iter().zip(b).map(|(a, b)| distance(a, b)).fold(0.0, f64::max)
}

/// Three rods on a hinge, a ball joint and a hinge, with a spring from the ground to the last rod and one between rods.
fn chain_on_springs(damping: f64) -> System {
    let mut scene = chain(&[(Revolute, Vector3::y()), (Spherical, Vector3::x()), (Revolute, Vector3::z())]);
    scene.initial[1].position = vec![0.3, -0.2, 0.5];
    scene.initial[1].velocity = vec![0.5, -1.0, 0.7];
    scene.initial[2].position = vec![0.8];
    let springs = vec![
        spring(anchor(None, 0.2, 0.3, 0.4), anchor(Some(2), 0.15, 0.02, 0.01), 120.0, damping, 0.3),
        spring(anchor(Some(0), 0.1, 0.05, 0.0), anchor(Some(2), -0.1, 0.0, 0.03), 60.0, damping, 0.2),
    ];
    sprung(&compile(&scene), springs)
}

#[test]
fn compositions_keep_their_order_with_springs_between_points() {
    let system = chain_on_springs(0.0);
    let truth = sampled(&system, &composition::ORDER_8, 1000);
    let counts =
        [(2, [400, 800, 1600, 3200]), (4, [200, 300, 400, 600]), (6, [150, 200, 250, 300]), (8, [180, 220, 260, 300])];
    for (order, counts) in counts {
        let composition = composition::ALL.iter().find(|c| c.order == order).unwrap();
        let errors = counts.map(|n| (1.0 / n as f64, farthest(&sampled(&system, composition, n), &truth)));
        let fitted = slope(&errors);
        println!("order {order}: fitted {fitted:.3}, {errors:?}");
        assert!(errors[3].1 > 1e-13 && (fitted - f64::from(order)).abs() <= 0.2, "{order}: {fitted}");
    }
}

/// Two free rods, end towards end, on one spring along the line of their centres; no gravity.
fn dumbbell(stiffness: f64, damping: f64, rest: f64, stretch: f64) -> System {
    let mut scene = chain(&[(Floating, Vector3::x()), (Prismatic, Vector3::x())]);
    scene.gravity = Vector3::zeros();
    scene.initial[1].position = vec![stretch + rest];
    let ends = [anchor(Some(0), 0.15, 0.0, 0.0), anchor(Some(1), -0.15, 0.0, 0.0)];
    let [from, to] = ends;
    sprung(&compile(&scene), vec![spring(from, to, stiffness, damping, rest)])
}

/// The distance follows the midpoint rule: a turn by `phi` a step, `tan(phi / 2) = x / 2`, `x = h sqrt(k / mu)` with the
/// reduced mass `mu`, beyond the bound 2 of explicit methods too (Hairer, Lubich and Wanner 2006, section VI.4).
#[test]
fn two_bodies_on_a_spring_oscillate_at_the_frequency_of_the_midpoint_rule() {
    let (h, rest, reduced) = (1e-3, 0.7, 0.5);
    let amplitude = 2e-3;
    for x in [1e-3_f64, 0.1, 2.5] {
        let stiffness = reduced * (x / h).powi(2);
        let system = dumbbell(stiffness, 0.0, rest, amplitude);
        let phi = 2.0 * (0.5 * x).atan();
        let (mut n, mut worst) = (0, 0.0_f64);
        run(&system, &composition::ORDER_2, h, 2000, |state| {
            n += 1;
            let expected = rest + amplitude * (f64::from(n) * phi).cos();
            worst = worst.max((system.parts.point_springs[0].distance(state).0 - expected).abs() / amplitude);
        });
        println!("x {x}: {worst:e}");
        // measured 1.1e-13, 1.1e-13, 3.9e-13
        assert!(worst <= 1e-12, "{x}: {worst:e}");
    }
}

/// The same with a large amplitude: the points would pass each other within a step but for the spring, and the equations of
/// the step have a second solution, on the far side. So stiff and so far stretched that they must pass, it is refused.
#[test]
fn stiff_springs_with_large_amplitudes_find_the_right_side() {
    let (h, rest, reduced) = (1e-3, 0.7, 0.5);
    for amplitude in [0.05, 0.3, 0.6] {
        for x in [10.0_f64, 1e3, 1e4, 1e6] {
            let system = dumbbell(reduced * (x / h).powi(2), 0.0, rest, amplitude);
            let phi = 2.0 * (0.5 * x).atan();
            let (mut n, mut worst) = (0, 0.0_f64);
            run(&system, &composition::ORDER_2, h, 2000, |state| {
                n += 1;
                let expected = rest + amplitude * (f64::from(n) * phi).cos();
                worst = worst.max((system.parts.point_springs[0].distance(state).0 - expected).abs() / amplitude);
            });
            println!("amplitude {amplitude}, x {x:e}: {worst:e}");
            // measured at most 1.8e-11
            assert!(worst <= 5e-11, "{amplitude} {x}: {worst:e}");
        }
    }
    for x in [0.8_f64, 2.5, 10.0, 1e4] {
        let mut rattle = Rattle::new(&dumbbell(reduced * (x / h).powi(2), 0.0, rest, 0.9)).unwrap();
        let failure = (0..100).find_map(|_| rattle.step(h).err()).unwrap();
        println!("x {x}: {failure:?}");
        assert!(matches!(failure, Failure::Loop { index: 0, residual, .. } if residual > 0.0), "{failure:?}");
    }
}

/// A free ball of 1 kg without gravity, with its centre on a spring of rest length 0 from a point of space.
fn ball_around_a_point(stiffness: f64, apart: [f64; 3], velocity: [f64; 3]) -> System {
    let mut scene = chain(&[(Floating, Vector3::x())]);
    scene.gravity = Vector3::zeros();
    let ball = scene.model.links[1].inertial.as_mut().unwrap();
    (ball.mass, ball.com, ball.inertia) = (1.0, Vector3::zeros(), Matrix3::from_diagonal_element(1e-2));
    scene.initial[0].position = [apart.as_slice(), &[0.0; 3]].concat();
    scene.initial[0].velocity = [velocity.as_slice(), &[0.0; 3]].concat();
    let (from, to) = (anchor(None, 0.0, 0.0, 0.0), anchor(Some(0), 0.0, 0.0, 0.0));
    sprung(&compile(&scene), vec![spring(from, to, stiffness, 0.0, 0.0)])
}

#[test]
fn springs_without_a_direction_are_refused_by_name() {
    let mut system = ball_around_a_point(100.0, [0.0; 3], [1.0, 0.0, 0.0]);
    assert!(engines::build(&Spec::parse("rattle").unwrap(), &system, 1e-3).is_ok());
    system.parts.point_springs[0].rest_length = 0.3;
    let refused = engines::build(&Spec::parse("rattle").unwrap(), &system, 1e-3).err().unwrap().to_string();
    assert!(refused.contains("spring 0 between points, whose points coincide at the start"), "{refused}");
    let stretched = dumbbell(0.5 * 1e8, 0.0, 0.7, 0.9);
    let mut engine = engines::build(&Spec::parse("rattle").unwrap(), &stretched, 1e-3).unwrap();
    let stop = (0..10).find_map(|_| engine.step().err()).unwrap().to_string();
    println!("{stop}");
    assert!(stop.contains("spring 0 between points does not settle") && stop.contains("smaller step"), "{stop}");
}

/// With the rest length 0 each component follows the midpoint rule by itself, also through the point where the ends
/// coincide and from there; at any stiffness.
#[test]
fn a_spring_of_no_length_pulls_through_its_centre() {
    let h = 1e-3;
    for x in [1e-2_f64, 1.0, 2.5, 1e3, 1e6] {
        let (omega, phi) = (x / h, 2.0 * (0.5 * x).atan());
        for (apart, velocity) in [
            ([0.4, 0.0, 0.0], [0.0; 3]),
            ([0.0; 3], [0.3 * omega, 0.0, 0.0]),
            ([0.4, -0.1, 0.0], [0.0, 0.2 * omega, 0.1 * omega]),
        ] {
            let system = ball_around_a_point(omega * omega, apart, velocity);
            let (mut n, mut worst, mut reach) = (0, 0.0_f64, 0.0_f64);
            run(&system, &composition::ORDER_2, h, 2000, |state| {
                n += 1;
                let (sin, cos) = (f64::from(n) * phi).sin_cos();
                let expected = Vector3::from(apart) * cos + Vector3::from(velocity) / omega * sin;
                let ball = &state.bodies[0];
                worst = worst.max((ball.position - expected).norm());
                reach = reach.max(ball.position.norm() + h * ball.velocity.norm());
            });
            let worst = worst / reach;
            println!("x {x:e}: {worst:e}");
            // measured at most 1.6e-13
            assert!(worst <= 5e-13, "{x}: {worst:e}");
        }
    }
}

/// The work of the dampers is integrated by the trapezoidal rule, of order 2 like the map.
#[test]
fn a_damper_takes_the_energy_that_the_balance_says() {
    let mut without_length = chain_on_springs(0.4);
    without_length.parts.point_springs.iter_mut().for_each(|spring| spring.rest_length = 0.0);
    for system in [chain_on_springs(0.4), without_length] {
        balance(&system);
    }
}

fn balance(system: &System) {
    let mut points = Vec::new();
    for h in [4e-3, 2e-3, 1e-3, 5e-4] {
        let power = |state: &State| -> f64 {
            system.parts.point_springs.iter().map(|s| s.damping * s.distance(state).1.powi(2)).sum()
        };
        let (mut work, mut last, mut worst) = (0.0, power(&system.initial), 0.0_f64);
        let start = energy::energy(system, &system.initial).total();
        run(system, &composition::ORDER_2, h, (2.0 / h) as usize, |state| {
            let now = power(state);
            work += 0.5 * h * (last + now);
            last = now;
            let balance = energy::energy(system, state).total() + work - start;
            worst = worst.max(balance.abs() / system.energy_scale);
        });
        println!("h {h}: balance {worst:e}, work {:e}", work / system.energy_scale);
        assert!(work > 0.05 * system.energy_scale);
        points.push((h, worst));
    }
    let fitted = slope(&points);
    println!("order {fitted:.3}");
    assert!((fitted - 2.0).abs() <= 0.2, "{fitted}");
}

/// A ball of 2 kg that hangs from the ground by a spring from its centre, beside the pendulum that it becomes.
fn ball_on_a_spring(stiffness: f64) -> (System, System) {
    let length = 0.8;
    let make = |kind, offset: f64, moment: f64| {
        let mut scene = chain(&[(kind, Vector3::y())]);
        let link = scene.model.links[1].inertial.as_mut().unwrap();
        link.mass = 2.0;
        link.com = Vector3::new(offset, 0.0, 0.0);
        link.inertia = Matrix3::from_diagonal_element(moment);
        scene
    };
    let mut free = make(Floating, 0.0, 1e-3);
    free.initial[0].position = vec![length, 0.0, 0.0, 0.0, 0.0, 0.0];
    // At right angles to gravity: the ball goes round while it falls, and the pull of the spring is never zero.
    free.initial[0].velocity = vec![0.0, 4.0, 0.0, 0.0, 0.0, 0.0];
    let hung = spring(anchor(None, 0.0, 0.0, 0.0), anchor(Some(0), 0.0, 0.0, 0.0), stiffness, 0.0, length);
    let mut rod = make(Spherical, length, 1e-9);
    rod.initial[0].velocity = vec![0.0, 0.0, 4.0 / length];
    (sprung(&compile(&free), vec![hung]), compile(&rod))
}

#[test]
fn a_stiff_spring_tends_to_a_rod() {
    let (h, steps) = (1e-3, 1000);
    let rod = ball_on_a_spring(1.0).1;
    let mut truth = Vec::new();
    run(&rod, &composition::ORDER_2, h, steps, |state| truth.push(state.bodies[0].position));
    // measured 4.1e-2, 4.2e-4, 5.8e-6, and 1.8e-6 from 1e10 on: the two maps agree to O(h^2)
    for (k, bound) in [(1e4, 1e-1), (1e6, 1e-3), (1e8, 1.5e-5), (1e10, 5e-6), (1e12, 5e-6)] {
        let system = ball_on_a_spring(k).0;
        let (mut n, mut off) = (0, 0.0_f64);
        run(&system, &composition::ORDER_2, h, steps, |state| {
            off = off.max((state.bodies[0].position - truth[n]).norm());
            n += 1;
        });
        println!("k {k:e}: {off:e}");
        assert!(off <= bound, "{k:e}: {off:e}");
    }
    // Negative control: a soft spring is no rod.
    let mut last = 0.0;
    run(&ball_on_a_spring(1e2).0, &composition::ORDER_2, h, steps, |state| {
        last = (state.bodies[0].position - truth[steps - 1]).norm();
    });
    assert!(last > 0.1, "{last:e}");
}

#[test]
fn the_energy_stays_bounded_at_any_stiffness() {
    let h = 1e-3;
    for x in [1e-3, 1e-1, 1.0, 10.0, 1e3, 1e4, 1e6] {
        let stiffness = 2.0 * (x / h) * (x / h);
        let error = energy_error(&ball_on_a_spring(stiffness).0, &composition::ORDER_2, h, 5000);
        println!("x {x:e}: {error:e}");
        // measured 1.7e-7 at 1e-3, 5.5e-6 from 0.1 to 1e6
        assert!(error <= 1.5e-5, "{x:e}: {error:e}");
    }
}

#[test]
fn a_run_on_springs_goes_back_to_its_start() {
    let system = chain_on_springs(0.0);
    let mut rattle = Rattle::new(&system).unwrap();
    for h in [1e-3, -1e-3] {
        for _ in 0..1000 {
            rattle.step(h).unwrap();
        }
    }
    let mut state = system.initial.clone();
    rattle.write_state(&mut state);
    let back = distance(&state, &system.initial);
    println!("{back:e}");
    // measured 3.5e-15
    assert!(back <= 1e-14, "{back:e}");
}
