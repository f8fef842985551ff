//! RATTLE of the rigid-body core, its relatives and the constrained Lobatto methods against the same maps in another
//! formulation: every body is 12 numbers in R^3 x R^(3x3), and rigidity and joints are constraints with multipliers (Marsden
//! and West 2001, sections 3.5.3, 3.5.4 and 3.5.6).
//!
//! Nothing is shared with the core but the data of the system and the start: no tree recursion, no rotation rule, no
//! quaternions, other functions for the joints. The map depends on the manifold alone, so both must agree to roundoff.

mod dense;
mod embedding;
mod lobatto;
mod relatives;
mod trees;

use std::cell::{Cell, RefCell};
use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;

use dense::Problem;
use embedding::{Rigidity, embed, gravity, mass};
use nalgebra::{Isometry3, Vector3};
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
use rattlebench::mechanics::coordinates::{JointCoordinates, forward_kinematics};
use rattlebench::mechanics::{Body, Joint, JointKind, Mobility, Parts, State, System};
use rattlebench::variational::{Failure, Rattle};

/// Steps that are compared in each case: the later ones start from extrapolated multipliers.
const STEPS: usize = 3;

/// Another way to take a step `(q0, v0) -> (q1, v1)` of a system.
type Other<'a> = Box<dyn Fn(&Vector, &Vector, f64) -> (Vector, Vector) + 'a>;

/// Largest differences: of the coordinates (m, and entries of R), and of the momenta over the momenta, both in the norm
/// of the kinetic energy, `|p|^2 = p^T M^-1 p = v^T M v`.
#[derive(Clone, Copy, Debug, Default)]
struct Difference {
    position: f64,
    momentum: f64,
}

impl Difference {
    fn larger(self, other: Difference) -> Difference {
        let larger = |a: f64, b: f64| if b.is_nan() || b > a { b } else { a };
        Difference { position: larger(self.position, other.position), momentum: larger(self.momentum, other.momentum) }
    }

    fn within(&self, bound: f64) -> bool {
        self.position <= bound && self.momentum <= bound
    }
}

/// A map of the core, with its state.
trait Core {
    fn step(&mut self, h: f64) -> Result<(), Failure>;
    fn write_state(&self, out: &mut State);
}

impl Core for Rattle {
    fn step(&mut self, h: f64) -> Result<(), Failure> {
        self.step(h)
    }

    fn write_state(&self, out: &mut State) {
        self.write_state(out);
    }
}

fn rattle(system: &System) -> Rattle {
    Rattle::new(system).unwrap()
}

/// Compares a few steps of RATTLE with steps that the other way takes from the same states.
fn difference(system: &System, h: f64, other: &Other) -> Difference {
    difference_from(rattle(system), system, h, other)
}

/// Compares a few steps of the core with steps that the other way takes from the same states.
fn difference_from(mut core: impl Core, system: &System, h: f64, other: &Other) -> Difference {
    let m = mass(system);
    let norm = |v: &Vector| v.dot(&m.component_mul(v)).sqrt();
    let mut state = system.initial.clone();
    let mut worst = Difference::default();
    core.write_state(&mut state);
    assert!(embed(&state).1.amax() > 0.1, "it moves");
    for _ in 0..STEPS {
        let (q0, v0) = embed(&state);
        core.step(h).unwrap();
        core.write_state(&mut state);
        let (q1, v1) = embed(&state);
        let (q, v) = other(&q0, &v0, h);
        let now = Difference { position: (q - q1).amax(), momentum: norm(&(v - &v1)) / norm(&v1) };
        worst = worst.larger(now);
    }
    worst
}

/// The parts of the force's impulse at the two ends of a step of RATTLE.
const HALVES: (f64, f64) = (0.5, 0.5);

/// Steps of 1 to 10 ms.
const USUAL: Range<f64> = -3.0..-2.0;

/// Runs a check on random systems, always the same ones, with steps of `10^exponent` s.
fn on_random(systems: &impl Strategy<Value = System>, cases: u32, exponents: Range<f64>, check: impl Fn(&System, f64)) {
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 0, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    runner
        .run(&(systems, trees::step_size(exponents)), |(system, h)| {
            check(&system, h);
            Ok(())
        })
        .unwrap();
}

/// Runs a check on random trees.
fn on_random_trees(cases: u32, exponents: Range<f64>, check: impl Fn(&System, f64)) {
    let seen = RefCell::new((HashSet::new(), HashSet::new()));
    on_random(&trees::tree(), cases, exponents, |system, h| {
        let mut seen = seen.borrow_mut();
        seen.0.insert(system.bodies.len());
        seen.1.extend(system.bodies.iter().map(|b| (b.joint.kind as usize, b.joint.parent.is_some())));
        check(system, h);
    });
    let (sizes, joints) = seen.into_inner();
    assert_eq!((sizes.len(), joints.len()), (5, 10), "all sizes, and all joints on the ground and on a body");
}

/// The largest difference of RATTLE over the random trees.
fn largest_difference(cases: u32, exponents: Range<f64>, other: impl Fn(&System) -> Other<'static>) -> Difference {
    largest_difference_from(rattle, cases, exponents, other)
}

/// The largest difference of a map of the core over the random trees.
fn largest_difference_from<C: Core>(
    core: impl Fn(&System) -> C,
    cases: u32,
    exponents: Range<f64>,
    other: impl Fn(&System) -> Other<'static>,
) -> Difference {
    let worst = RefCell::new(Difference::default());
    on_random_trees(cases, exponents, |system, h| {
        let found = difference_from(core(system), system, h, &other(system));
        worst.replace_with(|worst| worst.larger(found));
    });
    worst.into_inner()
}

/// The dense solve of the printed equations, with parts of the force's impulse, masses and forces of its own.
fn printed_with(parts: (f64, f64), mass: Vector, force: Vector, constraint: Rigidity) -> Other<'static> {
    let problem = Problem { mass, force, constraint };
    Box::new(move |q, v, h| problem.step(parts, q, v, h))
}

/// That of RATTLE.
fn printed(system: &System) -> Other<'static> {
    printed_with(HALVES, mass(system), gravity(system), Rigidity::new(system))
}

/// The constrained discrete Hamiltonian map of `discrete` on R^(12 n) for a discrete Lagrangian of the embedded system.
fn discrete<L>(system: &System, constraint: Rigidity, make: fn(SharedSystem) -> L) -> Other<'static>
where
    L: DiscreteLagrangian + 'static,
{
    let (m, potential) = (mass(system), Uniform { weight: -gravity(system) });
    let embedded: SharedSystem = Arc::new(Mechanical { mass: Matrix::from_diagonal(&m), potential });
    let ld = make(embedded.clone());
    Box::new(move |q, v, h| {
        let step = constrained_map(&ld, embedded.as_ref(), &constraint, q, &m.component_mul(v), h).unwrap();
        (step.q, step.p.component_div(&m))
    })
}

/// A step of a system with loops by one with those constraints that are independent where the step starts. The others must
/// follow from them.
fn with_loops<'a>(system: &'a System, of: impl Fn(Rigidity) -> Other<'static> + 'a) -> Other<'a> {
    let (all, mass) = (Rigidity::new(system), mass(system));
    Box::new(move |q, v, h| {
        let (q, v) = of(all.independent_at(q, &mass))(q, v, h);
        let open = [all.residual(&q).amax(), (all.jacobian(&q) * &v).amax() / v.amax()];
        // measured 2.7e-13
        assert!(open.iter().all(|open| *open <= 7e-13), "{open:?}");
        (q, v)
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
    let worst = largest_difference(256, USUAL, printed);
    println!("{worst:?}");
    // measured 2.9e-14 and 7.5e-14; on 4000 trees 1.2e-13 and 1.2e-12, see the projection below
    assert!(worst.within(2e-13), "{worst:?}");
}

/// Trees with one or two loops of all kinds, in which most leave redundant rows or lock some of the joints.
#[test]
fn one_step_of_a_linkage_solves_them_as_well() {
    let worst = RefCell::new(Difference::default());
    let (compared, redundant, seen) = (Cell::new(0), Cell::new(0), RefCell::new([0; 4]));
    let least_without_loops = Cell::new(f64::INFINITY);
    on_random(&trees::linkage(), 200, USUAL, |system, h| {
        let (rattle, mut state) = (Rattle::new(system).unwrap(), system.initial.clone());
        rattle.write_state(&mut state);
        let freedoms: usize = system.bodies.iter().map(|b| b.joint.kind.degrees_of_freedom()).sum();
        if rattle.rank() == freedoms || embed(&state).1.amax() < 0.2 {
            return;
        }
        let other = with_loops(system, |held| printed_with(HALVES, mass(system), gravity(system), held));
        let found = difference(system, h, &other);
        worst.replace_with(|worst| worst.larger(found));
        // Negative control: the same tree without its loops, where they hold anything.
        if rattle.rank() > 0 {
            let other = difference(system, h, &printed(&System { parts: Parts::default(), ..system.clone() }));
            least_without_loops.set(least_without_loops.get().min(other.position.max(other.momentum)));
        }
        compared.set(compared.get() + 1);
        let loops = &system.parts.loops;
        let rows: usize = loops.iter().map(|l| l.locked().iter().filter(|locked| **locked).count()).sum();
        redundant.set(redundant.get() + usize::from(rows > rattle.rank()));
        loops.iter().for_each(|l| seen.borrow_mut()[l.kind as usize] += 1);
    });
    let (worst, counts) = (worst.into_inner(), (compared.get(), redundant.get(), seen.into_inner()));
    println!("{worst:?} {counts:?} without loops {:e}", least_without_loops.get());
    // measured 5.7e-14 and 1.9e-13
    assert!(worst.within(5e-13), "{worst:?}");
    assert!(least_without_loops.get() > 1e-8);
    assert!(counts.0 >= 150 && counts.1 >= 50 && counts.2.iter().all(|n| *n >= 30), "{counts:?}");
}

/// Velocities do not lose the digits that positions of 1 m and steps of 1 um have no room for.
#[test]
fn steps_of_a_microsecond_solve_them_as_well() {
    let worst = largest_difference(256, -6.0..-5.0, printed);
    println!("{worst:?}");
    // measured 4.4e-16 and 1.3e-13
    assert!(worst.within(3e-13), "{worst:?}");
}

#[test]
fn one_step_is_the_constrained_discrete_hamiltonian_map_of_verlet() {
    let worst =
        largest_difference(64, USUAL, |system| discrete(system, Rigidity::new(system), |s| symmetrised(s, 0.0)));
    println!("{worst:?}");
    // measured 3.9e-15 and 6.8e-14
    assert!(worst.within(2e-13), "{worst:?}");
}

/// Negative controls: another system, another embedding and another discrete Lagrangian are seen.
#[test]
fn another_inertia_embedding_or_discrete_lagrangian_does_not_agree() {
    let seen = RefCell::new([(0, f64::INFINITY); 3]);
    on_random_trees(64, USUAL, |system, h| {
        let mut heavier = system.clone();
        heavier.bodies.iter_mut().for_each(|b| b.inertia.x *= 1.01);
        // J in the place of Jd.
        let mut wrong = mass(system);
        for (i, body) in system.bodies.iter().enumerate() {
            for k in 0..3 {
                wrong.fixed_rows_mut::<3>(12 * i + 3 + 3 * k).fill(body.inertia[k]);
            }
        }
        let others = [
            printed_with(HALVES, mass(&heavier), gravity(system), Rigidity::new(system)),
            printed_with(HALVES, wrong, gravity(system), Rigidity::new(system)),
            discrete(system, Rigidity::new(system), |s| alpha(s, 0.0)),
        ];
        for (seen, other) in seen.borrow_mut().iter_mut().zip(&others) {
            let found = difference(system, h, other);
            if !found.within(1e-11) {
                *seen = (seen.0 + 1, seen.1.min(found.position.max(found.momentum)));
            }
        }
    });
    let seen = seen.into_inner();
    println!("{seen:?}");
    // measured 54, 55 and 64 of 64, and 2.1e-9, 2.0e-5 and 2.5e-6; what only slides or spins freely does not see an inertia
    assert!(seen.iter().all(|(count, smallest)| *count >= 50 && *smallest >= 1e-10), "{seen:?}");
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

/// The projection of the momenta leaves a state on the manifold as it is. The recursion does it once, without refinement,
/// and a light body that carries a heavy one on a planar joint loses three digits that the dense solve
/// keeps.
#[test]
fn the_projection_of_the_momenta_keeps_a_state_on_the_manifold() {
    let worst = RefCell::new([0.0_f64; 2]);
    on_random_trees(4000, USUAL, |system, _| {
        let mut state = system.initial.clone();
        Rattle::new(system).unwrap().write_state(&mut state);
        let (q, v) = embed(&system.initial);
        let problem = Problem { mass: mass(system), force: gravity(system), constraint: Rigidity::new(system) };
        let dense = problem.project(&q, &problem.mass.component_mul(&v));
        let mut worst = worst.borrow_mut();
        for (worst, found) in worst.iter_mut().zip([embed(&state).1, dense]) {
            *worst = worst.max((found - &v).amax() / v.amax());
        }
    });
    let [recursion, dense] = worst.into_inner();
    println!("recursion {recursion:e}, dense {dense:e}");
    // measured 9.7e-12 and 1.6e-14
    assert!(recursion <= 2.5e-11, "{recursion:e}");
    assert!(dense <= 4e-14, "{dense:e}");
}

/// All that there is to be resolved is what the joint misses by roundoff at the start.
#[test]
fn a_weightless_pendulum_at_rest_stays_at_rest() {
    let in_parent = Isometry3::rotation(Vector3::new(-1.9, -0.6, -0.9));
    let in_child = Isometry3::new(Vector3::new(0.31, -0.03, -0.2), Vector3::new(0.0, 0.0, -1.1));
    let joint =
        Joint { name: "hinge".into(), kind: JointKind::Revolute, parent: None, in_parent, in_child, damping: 0.0 };
    let bodies = vec![Body { name: "rod".into(), mass: 1.0, inertia: Vector3::repeat(8e-4), joint }];
    let initial_coordinates = vec![JointCoordinates::default()];
    let system = System {
        name: "at rest".into(),
        initial: forward_kinematics(&bodies, &initial_coordinates),
        bodies,
        gravity: Vector3::zeros(),
        initial_coordinates,
        energy_scale: 1.0,
        floating_base: None,
        parts: Parts::default(),
        mobility: Mobility::default(),
    };
    let mut rattle = Rattle::new(&system).unwrap();
    for _ in 0..100 {
        rattle.step(0.01).unwrap();
    }
    let mut state = system.initial.clone();
    rattle.write_state(&mut state);
    let (q, v) = embed(&state);
    println!("{:e} {:e}", (&q - embed(&system.initial).0).amax(), v.amax());
    // measured 0 and 8.4e-33
    assert!((q - embed(&system.initial).0).amax() <= 1e-16 && v.amax() <= 1e-16);
}
