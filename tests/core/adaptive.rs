//! The time-reversible variable step: reversal, order, long times, and what it saves.

use nalgebra::Vector3;
use rattlebench::engines::{self, Spec};
use rattlebench::mechanics::{State, System};
use rattlebench::model::JointKind::{Prismatic, Revolute};
use rattlebench::model::scene::Spring;
use rattlebench::variational::{Adaptive, Rattle};

use crate::common::*;

fn adaptive(system: &System, tolerance: f64) -> Adaptive {
    Adaptive::new(system, Rattle::new(system).unwrap(), tolerance)
}

/// The largest energy error over the nodes up to a time, and the number of steps.
fn run(system: &System, tolerance: f64, duration: f64) -> (f64, u64) {
    let mut adaptive = adaptive(system, tolerance);
    let (mut state, mut worst) = (system.initial.clone(), 0.0_f64);
    while adaptive.grid_time() < duration {
        adaptive.step_on_grid().unwrap();
        adaptive.write_grid_point(&mut state);
        worst = worst.max(energy_error(system, &state).abs());
    }
    (worst, adaptive.steps())
}

#[test]
fn a_thousand_adaptive_steps_and_back_return_to_the_start() {
    for system in [compile(&alternating(3)), five_links()] {
        let mut adaptive = adaptive(&system, 1e-4);
        let mut state = system.initial.clone();
        let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
        for _ in 0..1000 {
            adaptive.step_on_grid().unwrap();
            (shortest, longest) = (shortest.min(adaptive.step_size()), longest.max(adaptive.step_size()));
        }
        adaptive.write_grid_point(&mut state);
        let travelled = distance(&state, &system.initial);
        assert!(travelled > 0.1 && longest > 2.0 * shortest, "{travelled} {shortest:e} {longest:e}");
        adaptive.turn_back();
        for _ in 0..1000 {
            adaptive.step_on_grid().unwrap();
        }
        adaptive.write_grid_point(&mut state);
        let (missed, late) = (distance(&state, &system.initial), adaptive.grid_time());
        println!("steps {shortest:.1e} to {longest:.1e}, missed by {missed:.1e}, {late:.1e} s");
        // measured at most 5.4e-11 and 5.2e-12
        assert!(missed <= 1.5e-10 && late.abs() <= 1.5e-11);
    }
}

#[test]
fn the_energy_error_is_of_first_order_in_the_tolerance() {
    for system in [compile(&alternating(2)), five_links()] {
        let points: Vec<(f64, f64)> =
            [1e-4, 3e-5, 1e-5, 3e-6].into_iter().map(|tol| (tol, run(&system, tol, 2.0).0)).collect();
        let order = slope(&points);
        println!("order {order:.2}, {points:?}");
        assert!((order - 1.0).abs() <= 0.1, "{order}");
        assert!(points.iter().all(|(tol, error)| *error > 0.0 && error <= tol));
    }
}

/// Means of the signed energy error over the first and the last tenth of a run of steps.
fn drift(system: &System, steps: usize, mut step: impl FnMut(&mut State)) -> (f64, f64) {
    let mut state = system.initial.clone();
    let (mut first, mut last) = (0.0, 0.0);
    for k in 0..steps {
        step(&mut state);
        let part = energy_error(system, &state) / (steps / 10) as f64;
        if k < steps / 10 {
            first += part;
        } else if k >= steps - steps / 10 {
            last += part;
        }
    }
    (first, last)
}

/// Two rods swing: the energy of the reversible steps does not drift over 100 000 of them, that of steps chosen
/// by the same monitor from the present state alone does.
#[test]
fn energy_does_not_drift_where_steps_chosen_from_the_present_state_drift() {
    let mut scene = alternating(2);
    scene.initial[0].position = vec![1.2];
    scene.initial[1].position = vec![0.4];
    let system = compile(&scene);
    let (steps, tolerance) = (100_000, 1e-2);
    let mut adaptive = adaptive(&system, tolerance);
    let (first, last) = drift(&system, steps, |state| {
        adaptive.step_on_grid().unwrap();
        adaptive.write_grid_point(state);
    });
    let (mut naive, monitor) = (Rattle::new(&system).unwrap(), adaptive.monitor());
    let (naive_first, naive_last) = drift(&system, steps, |state| {
        naive.step(monitor.step(&naive)).unwrap();
        naive.write_state(state);
    });
    println!("reversible {first:.2e} to {last:.2e}, naive {naive_first:.2e} to {naive_last:.2e}");
    // measured below 1e-6, and 3.0e-2
    assert!((last - first).abs() <= 2e-6);
    assert!((naive_last - naive_first).abs() > 1e-2);
}

/// A slider of 1 kg on a light arm that turns slowly, drawn by a spring past the pivot: near there it turns a hundred times
/// faster.
fn slider_past_its_pivot() -> System {
    let mut scene = chain(&[(Revolute, Vector3::z()), (Prismatic, Vector3::x())]);
    let arm = scene.model.links[1].inertial.as_mut().unwrap();
    (arm.mass, arm.inertia) = (0.01, arm.inertia * 0.01);
    scene.springs.push(Spring::Joint { joint: 1, stiffness: 20.0, damping: 0.0, rest: -0.45 });
    scene.initial[0].velocity = vec![0.3];
    scene.initial[1].position = vec![1.0];
    compile(&scene)
}

/// At equal numbers of solves the energy error of variable steps is smaller where the motion is uneven.
#[test]
fn variable_steps_pay_where_the_motion_is_uneven() {
    let fixed = |system: &System, steps: u64| {
        let (mut rattle, mut state, mut worst) = (Rattle::new(system).unwrap(), system.initial.clone(), 0.0_f64);
        for _ in 0..steps {
            rattle.step(5.0 / steps as f64).unwrap();
            rattle.write_state(&mut state);
            worst = worst.max(energy_error(system, &state).abs());
        }
        worst
    };
    // measured at least 6.2 (slider) and 3.0 (whip): 2.5 and 1.7 times the solves for the same error
    for (name, system, least) in [("slider", slider_past_its_pivot(), 3.0), ("whip", compile(&alternating(10)), 1.5)] {
        for tolerance in [1e-3, 1e-4, 1e-5] {
            let (varied, steps) = run(&system, tolerance, 5.0);
            let ratio = fixed(&system, steps) / varied;
            println!("{name}: tol {tolerance:e}: {steps} steps, error {varied:.2e}, ratio {ratio:.2}");
            assert!(ratio > least, "{name}: {ratio}");
        }
    }
}

/// The sequence of nodes does not depend on when output is asked for, and the output joins them.
#[test]
fn output_does_not_disturb_the_steps() {
    for name in ["five links", "slider_crank", "four_bar"] {
        let system = match name {
            "five links" => five_links(),
            _ => shipped(name),
        };
        let (mut often, mut seldom) = (adaptive(&system, 1e-4), adaptive(&system, 1e-4));
        (1..=1000).for_each(|k| often.advance_to(1e-3 * f64::from(k)).unwrap());
        seldom.advance_to(1.0).unwrap();
        let (mut a, mut b) = (system.initial.clone(), system.initial.clone());
        often.write_grid_point(&mut a);
        seldom.write_grid_point(&mut b);
        assert_eq!(a, b, "{name}");
        often.write_state(&mut a);
        seldom.write_state(&mut b);
        assert_eq!(a, b, "{name}");
        let error = energy_error(&system, &a).abs();
        println!("{name}: {} steps, error {error:.1e}", seldom.steps());
        // measured at most 5.9e-5
        assert!(error <= 1e-4, "{name}: {error:e}");
    }
}

#[test]
fn settings_that_do_not_go_with_adaptive_steps_are_refused_with_a_reason() {
    let mut damped = alternating(2);
    damped.model.joints[1].damping = 0.1;
    let cases = [
        (alternating(2), "rattle:step=adaptive,order=4", "order 2"),
        (alternating(2), "rattle:step=adaptive,method=shake", "order 2"),
        (alternating(2), "rattle:step=adaptive,on_failure=substep", "sequence of steps"),
        (alternating(2), "rattle:tol=1e-3", "only step=adaptive"),
        (damped, "rattle:step=adaptive", "reversible"),
    ];
    for (scene, text, reason) in cases {
        let system = compile(&scene);
        let refused = engines::build(&Spec::parse(text).unwrap(), &system, 1e-2).err().unwrap().to_string();
        assert!(refused.contains(reason), "{refused}");
    }
}
