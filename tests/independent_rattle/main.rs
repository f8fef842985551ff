//! RATTLE of the rigid-body core against the same map in another formulation: every body is 12 numbers in
//! R^3 x R^(3x3), and rigidity and joints are constraints with multipliers (Marsden and West 2001, sections 3.5.3, 3.5.4).
//!
//! Nothing is shared with the core but the data of the system and the start: no tree recursion, no rotation rule, no
//! quaternions, other functions for the joints. The map depends on the manifold alone, so both must agree to roundoff.

mod dense;
mod embedding;
mod trees;

use std::cell::RefCell;
use std::collections::HashSet;
use std::sync::Arc;

use dense::Problem;
use embedding::{Rigidity, embed, gravity, mass};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use rattlebench::discrete::constrained::constrained_map;
use rattlebench::discrete::constraint::Constraint;
use rattlebench::discrete::lagrangian::DiscreteLagrangian;
use rattlebench::discrete::methods::{alpha, symmetrised};
use rattlebench::discrete::problems::Uniform;
use rattlebench::discrete::solve::central_difference;
use rattlebench::discrete::system::{Mechanical, SharedSystem};
use rattlebench::discrete::{Matrix, Vector};
use rattlebench::mechanics::System;
use rattlebench::variational::Rattle;

/// Steps that are compared in each case: the later ones start from extrapolated multipliers.
const STEPS: usize = 3;

/// Another way to take a step `(q0, v0) -> (q1, v1)` of a system.
type Other<'a> = Box<dyn Fn(&Vector, &Vector, f64) -> (Vector, Vector) + 'a>;

/// Largest differences: of coordinates (m, and entries of R), and of velocities over the largest velocity.
#[derive(Clone, Copy, Debug, Default)]
struct Difference {
    position: f64,
    velocity: f64,
}

impl Difference {
    fn larger(self, other: Difference) -> Difference {
        let larger = |a: f64, b: f64| if b.is_nan() || b > a { b } else { a };
        Difference { position: larger(self.position, other.position), velocity: larger(self.velocity, other.velocity) }
    }

    fn within(&self, bound: f64) -> bool {
        self.position <= bound && self.velocity <= bound
    }
}

/// Compares a few steps of the core with steps that the other way takes from the same states.
fn difference(system: &System, h: f64, other: &Other) -> Difference {
    let mut rattle = Rattle::new(system).unwrap();
    let mut state = system.initial.clone();
    let mut worst = Difference::default();
    rattle.write_state(&mut state);
    for _ in 0..STEPS {
        let (q0, v0) = embed(&state);
        rattle.step(h).unwrap();
        rattle.write_state(&mut state);
        let (q1, v1) = embed(&state);
        let (q, v) = other(&q0, &v0, h);
        assert!((&q1 - &q0).amax() > 1e-2 * h.abs(), "it moves");
        let now = Difference { position: (q - q1).amax(), velocity: (v - &v1).amax() / v1.amax().max(1.0) };
        worst = worst.larger(now);
    }
    worst
}

/// Runs a check on random trees, always the same ones.
fn on_random_trees(cases: u32, check: impl Fn(&System, f64)) {
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let seen = RefCell::new((HashSet::new(), HashSet::new()));
    runner
        .run(&(trees::tree(), trees::step_size()), |(system, h)| {
            let mut seen = seen.borrow_mut();
            seen.0.insert(system.bodies.len());
            seen.1.extend(system.bodies.iter().map(|b| (b.joint.kind as usize, b.joint.parent.is_some())));
            check(&system, h);
            Ok(())
        })
        .unwrap();
    let (sizes, joints) = seen.into_inner();
    assert_eq!((sizes.len(), joints.len()), (5, 10), "all sizes, and all joints on the ground and on a body");
}

/// The largest difference over the random trees.
fn largest_difference(cases: u32, other: impl Fn(&System) -> Other<'static>) -> Difference {
    let worst = RefCell::new(Difference::default());
    on_random_trees(cases, |system, h| {
        let found = difference(system, h, &other(system));
        worst.replace_with(|worst| worst.larger(found));
    });
    worst.into_inner()
}

/// The dense solve of the printed equations, with masses and forces of its own.
fn printed_with(system: &System, mass: Vector, force: Vector) -> Other<'static> {
    let problem = Problem { mass, force, constraint: Rigidity::new(system) };
    Box::new(move |q, v, h| problem.step(q, v, h))
}

fn printed(system: &System) -> Other<'static> {
    printed_with(system, mass(system), gravity(system))
}

/// The constrained discrete Hamiltonian map of `discrete` on R^(12 n) for a discrete Lagrangian of the embedded system.
fn discrete<L: DiscreteLagrangian + 'static>(system: &System, make: fn(SharedSystem) -> L) -> Other<'static> {
    let (m, potential) = (mass(system), Uniform { weight: -gravity(system) });
    let embedded: SharedSystem = Arc::new(Mechanical { mass: Matrix::from_diagonal(&m), potential });
    let (ld, constraint) = (make(embedded.clone()), Rigidity::new(system));
    Box::new(move |q, v, h| {
        let step = constrained_map(&ld, embedded.as_ref(), &constraint, q, &m.component_mul(v), h).unwrap();
        (step.q, step.p.component_div(&m))
    })
}

/// A tree with every joint kind.
fn example() -> System {
    let mut found = None;
    let mut runner = TestRunner::deterministic();
    while found.is_none() {
        let tree = trees::tree().new_tree(&mut runner).unwrap().current();
        let kinds: HashSet<_> = tree.bodies.iter().map(|b| b.joint.kind as usize).collect();
        found = (kinds.len() == trees::KINDS.len()).then_some(tree);
    }
    found.unwrap()
}

#[test]
fn one_step_solves_the_equations_of_rattle_as_printed() {
    let worst = largest_difference(256, printed);
    println!("{worst:?}");
    assert!(worst.within(1e-12), "{worst:?}");
}

#[test]
fn one_step_is_the_constrained_discrete_hamiltonian_map_of_verlet() {
    let worst = largest_difference(64, |system| discrete(system, |s| symmetrised(s, 0.0)));
    println!("{worst:?}");
    assert!(worst.within(1e-11), "{worst:?}");
}

/// Negative controls: what is slightly another map, or another system, is seen on every kind of tree.
#[test]
fn another_inertia_embedding_or_discrete_lagrangian_does_not_agree() {
    let smallest = RefCell::new([f64::INFINITY; 3]);
    on_random_trees(64, |system, h| {
        let mut heavier = system.clone();
        let last = heavier.bodies.len() - 1;
        heavier.bodies[last].inertia *= 1.01;
        let mut wrong = mass(system);
        for (i, body) in system.bodies.iter().enumerate() {
            for k in 0..3 {
                wrong.fixed_rows_mut::<3>(12 * i + 3 + 3 * k).fill(body.inertia[k]);
            }
        }
        let others = [
            printed_with(system, mass(&heavier), gravity(system)),
            printed_with(system, wrong, gravity(system)),
            discrete(system, |s| alpha(s, 0.0)),
        ];
        let mut smallest = smallest.borrow_mut();
        for (smallest, other) in smallest.iter_mut().zip(&others) {
            let found = difference(system, h, other);
            *smallest = smallest.min(found.velocity);
        }
    });
    let smallest = smallest.into_inner();
    println!("{smallest:?}");
    assert!(smallest.iter().all(|s| *s > 1e-11), "{smallest:?}");
}

/// The two sides of `phi` are right: zero on the manifold, and its derivatives those of its values.
#[test]
fn the_constraints_hold_where_the_joints_do_and_have_their_derivatives() {
    let system = example();
    let constraint = Rigidity::new(&system);
    let freedoms: usize = system.bodies.iter().map(|b| b.joint.kind.degrees_of_freedom()).sum();
    assert_eq!(constraint.count(), 12 * system.bodies.len() - freedoms);
    let (q, v) = embed(&system.initial);
    let jacobian = constraint.jacobian(&q);
    assert!(v.amax() > 1.0);
    println!("phi {:e}, G v {:e}", constraint.residual(&q).amax(), (&jacobian * &v).amax());
    assert!(constraint.residual(&q).amax() <= 1e-14 && (&jacobian * &v).amax() <= 1e-13);
    let differences = central_difference(&q, 1e-2, |q| Ok(constraint.residual(q))).unwrap();
    let lambda = Vector::from_fn(constraint.count(), |k, _| (k as f64).sin());
    let curvature = central_difference(&q, 1e-2, |q| Ok(constraint.jacobian(q).tr_mul(&lambda))).unwrap();
    let errors = [(jacobian - differences).amax(), (constraint.hessian(&q, &lambda) - curvature).amax()];
    println!("{errors:?}");
    assert!(errors.iter().all(|e| *e <= 1e-12), "{errors:?}");
}
