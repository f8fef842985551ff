//! The maps of one drift besides RATTLE: the midpoint rule, the two symplectic Euler maps and SHAKE (Marsden and West 2001,
//! sections 3.5.2 and 3.5.3).

use std::cell::{Cell, RefCell};

use rattlebench::discrete::methods::alpha;
use rattlebench::engines::{self, Spec};
use rattlebench::mechanics::System;
use rattlebench::variational::{Method, Rattle};

use super::embedding::{Rigidity, embed, gravity, mass};
use super::{Difference, Other, USUAL, difference, difference_from, discrete, largest_difference};
use super::{largest_difference_from, on_random, on_random_trees, printed, printed_with, rattle, trees, with_loops};

fn core(method: Method) -> impl Fn(&System) -> Rattle {
    move |system| rattle(system).with_method(method)
}

/// The parts of the force's impulse at the start and the end of a step.
const EULER: [(Method, (f64, f64)); 2] = [(Method::EulerA, (1.0, 0.0)), (Method::EulerB, (0.0, 1.0))];

fn euler(parts: (f64, f64)) -> impl Fn(&System) -> Other<'static> {
    move |system| printed_with(parts, mass(system), gravity(system), Rigidity::new(system))
}

#[test]
fn one_step_solves_the_equations_of_the_symplectic_euler_maps_as_printed() {
    for (method, parts) in EULER {
        let worst = largest_difference_from(core(method), 128, USUAL, euler(parts));
        println!("{method:?}: {worst:?}");
        // measured 5.4e-15 and 1.1e-13
        assert!(worst.within(3e-13), "{method:?}: {worst:?}");
    }
}

#[test]
fn one_step_is_the_constrained_discrete_hamiltonian_map_of_symplectic_euler() {
    let worst = EULER.map(|(method, (start, _))| {
        let make = if start == 1.0 { |s| alpha(s, 0.0) } else { |s| alpha(s, 1.0) };
        largest_difference_from(core(method), 64, USUAL, |system| discrete(system, Rigidity::new(system), make))
    });
    println!("{worst:?}");
    // measured 3.0e-15 and 9.4e-14
    assert!(worst.iter().all(|worst| worst.within(2.5e-13)), "{worst:?}");
}

/// Negative control: the adjoint is another map.
#[test]
fn the_other_symplectic_euler_map_does_not_agree() {
    let least = Cell::new(f64::INFINITY);
    on_random_trees(64, USUAL, |system, h| {
        for ((method, _), (_, parts)) in EULER.into_iter().zip(EULER.into_iter().rev()) {
            let found = difference_from(core(method)(system), system, h, &euler(parts)(system));
            least.set(least.get().min(found.position.max(found.momentum)));
        }
    });
    println!("{:e}", least.get());
    // measured 4.9e-6
    assert!(least.get() >= 1.5e-6, "{:e}", least.get());
}

/// The constrained midpoint rule is the map of RATTLE: on trees, and on those with loops that leave a motion.
#[test]
fn one_step_is_the_constrained_discrete_hamiltonian_map_of_the_midpoint_rule() {
    let middle = |s| alpha(s, 0.5);
    let worst = largest_difference(64, USUAL, |system| discrete(system, Rigidity::new(system), middle));
    println!("trees {worst:?}");
    // measured 2.3e-15 and 8.2e-14
    assert!(worst.within(2e-13), "{worst:?}");

    let (worst, compared) = (RefCell::new(Difference::default()), Cell::new(0));
    on_random(&trees::linkage(), 100, USUAL, |system, h| {
        let (rattle, mut state) = (rattle(system), system.initial.clone());
        rattle.write_state(&mut state);
        let freedoms: usize = system.bodies.iter().map(|b| b.joint.kind.degrees_of_freedom()).sum();
        if rattle.rank() == freedoms || embed(&state).1.amax() < 0.2 {
            return;
        }
        let found = difference(system, h, &with_loops(system, |held| discrete(system, held, middle)));
        worst.replace_with(|worst| worst.larger(found));
        compared.set(compared.get() + 1);
    });
    let worst = worst.into_inner();
    println!("linkages {worst:?} {}", compared.get());
    // measured 2.6e-13 and 3.0e-13
    assert!(worst.within(8e-13), "{worst:?}");
    assert!(compared.get() >= 75);
}

/// The states that SHAKE hands out are those of RATTLE.
#[test]
fn one_step_of_shake_solves_the_equations_of_rattle() {
    let worst = largest_difference_from(core(Method::Shake), 128, USUAL, printed);
    println!("{worst:?}");
    // measured 5.5e-15 and 1.4e-13
    assert!(worst.within(4e-13), "{worst:?}");
}

/// What is compared on trees only is refused on loops.
#[test]
fn maps_that_are_compared_on_trees_only_refuse_loops() {
    on_random(&trees::linkage(), 1, USUAL, |system, h| {
        for method in ["lobatto", "euler_a", "euler_b", "shake"] {
            let spec = Spec::parse(&format!("rattle:method={method}")).unwrap();
            let refused = engines::build(&spec, system, h).err().expect("refused").to_string();
            assert!(refused.contains(&format!("loops with method={method}")), "{refused}");
        }
        for method in ["rattle", "midpoint"] {
            let spec = Spec::parse(&format!("rattle:method={method}")).unwrap();
            assert!(engines::build(&spec, system, h).is_ok(), "{method}");
        }
    });
}
