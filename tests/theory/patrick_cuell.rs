//! Error analysis by Patrick and Cuell (2008/09) as computations.

use std::sync::Arc;

use rattlebench::discrete::flow::Motion;
use rattlebench::discrete::lagrangian::{DiscreteLegendre, SharedLagrangian};
use rattlebench::discrete::maps::{hamiltonian_map, lagrangian_map};
use rattlebench::discrete::methods::{Equivalent, METHODS, alpha, symmetrised};
use rattlebench::discrete::order::map_order;
use rattlebench::discrete::problems::{Problem, Spring, Uniform, coupled_wells, double_pendulum};
use rattlebench::discrete::quadrature::Quadrature;
use rattlebench::discrete::system::Mechanical;
use rattlebench::discrete::tangent::{Curves, Discretisation, Osculating, Sinusoids, Straight, small_steps};
use rattlebench::discrete::two_sided::TwoSided;
use rattlebench::discrete::{Matrix, Vector};

use crate::common::discrete::{at_least, at_most, distance, start};

/// Largest errors of `F-` and `F+` at the ends of an exact motion.
fn legendre_error(ld: &(impl DiscreteLegendre + ?Sized), problem: &Problem, h: f64) -> f64 {
    let end = Motion::of(problem.system.as_ref()).flow(&problem.q, &problem.v, h, 0.1).unwrap();
    let at = ld.legendre(&problem.q, &end.q, h).unwrap();
    let p1 = problem.system.momentum(&end.q, &end.v);
    (at.p0 - start(problem).1).norm().max((at.p1 - p1).norm())
}

fn exponent(f: impl Fn(f64) -> f64, h: f64) -> f64 {
    (f(h) / f(0.25 * h)).log2() / 2.0
}

/// PC example 2.2: `L_h = h L(q-, (q+ - q-)/h) + b h (q+ - q-)`. The position map does not see b and the Hamiltonian map keeps
/// order 1, but the Legendre transforms err by `b h`: an error of `O(h)`, not the `O(h^2)` of order 1.
#[test]
fn pc_2_2_the_map_has_order_one_while_the_legendre_transforms_are_not_consistent() {
    let problem = coupled_wells();
    let euler: SharedLagrangian = Arc::new(alpha(problem.system.clone(), 0.0));
    let b = Vector::from_vec(vec![0.7, -1.1]);
    let shifted = Equivalent { lagrangian: euler.clone(), null: Arc::new(Uniform { weight: b.clone() }), power: 1 };
    let q1 = &problem.q + &problem.v * 0.1;
    let by_b = lagrangian_map(&shifted, &problem.q, &q1, 0.1).unwrap();
    let without = lagrangian_map(euler.as_ref(), &problem.q, &q1, 0.1).unwrap();
    // measured 0
    at_most((by_b - without).amax(), 4e-16, "positions");
    let motion = Motion::of(problem.system.as_ref());
    let order = map_order(&motion, &problem.q, &problem.v, |q, p, h| hamiltonian_map(&shifted, q, p, h));
    // measured 6.7e-05
    at_most((order.unwrap() - 1.0).abs(), 2e-4, "map");
    // measured 4.8e-04
    at_most((exponent(|h| legendre_error(&shifted, &problem, h), 0.01) - 1.0).abs(), 0.002, "F+ and F-");
    // A free particle shows b alone: the map is exact and the momenta err by |b| h.
    let system = Arc::new(Mechanical { mass: Matrix::identity(2, 2), potential: Uniform { weight: Vector::zeros(2) } });
    let free = Problem { name: "free particle", system, ..problem };
    let plain: SharedLagrangian = Arc::new(alpha(free.system.clone(), 0.0));
    let shifted = Equivalent { lagrangian: plain, null: Arc::new(Uniform { weight: b.clone() }), power: 1 };
    for h in [0.1, 0.01] {
        // measured 1.2e-14
        at_most((legendre_error(&shifted, &free, h) - b.norm() * h).abs(), 3e-14, "F+ and F-");
        let (q, p) = hamiltonian_map(&shifted, &free.q, &(&free.v + &b * h), h).unwrap();
        // measured 7.8e-16
        at_most(distance(&(q, p), &(&free.q + &free.v * h, &free.v + &b * h)), 2e-15, "map in its own momenta");
    }
}

/// PC example 2.3: `F-` of one discrete Lagrangian with `F+` of another, both of order r, makes a map of order r - 1 only.
#[test]
fn pc_2_3_two_lagrangians_on_the_two_sides_lose_one_order() {
    for problem in [coupled_wells(), double_pendulum()] {
        let motion = Motion::of(problem.system.as_ref());
        let s = || problem.system.clone();
        let order = |ld: &dyn DiscreteLegendre| {
            map_order(&motion, &problem.q, &problem.v, |q, p, h| hamiltonian_map(ld, q, p, h)).unwrap()
        };
        let mixed = TwoSided { minus: alpha(s(), 0.5), plus: symmetrised(s(), 0.0) };
        // measured 4.7e-03
        at_most((order(&mixed) - 1.0).abs(), 0.02, "midpoint and Verlet");
        let same = TwoSided { minus: symmetrised(s(), 0.0), plus: symmetrised(s(), 0.0) };
        // measured 5.1e-03
        at_most((order(&same) - 2.0).abs(), 0.02, "Verlet on both sides");
        let first = TwoSided { minus: alpha(s(), 0.0), plus: alpha(s(), 1.0) };
        // measured 5.4e-03
        at_most(order(&first).abs(), 0.02, "the two Euler methods");
    }
}

/// PC 2.4, the blown-up principle: in `(q, v)` the error of a step falls as `h^2` down to roundoff and stays there to
/// h = 1e-12, while the second difference of the position form loses `1/h^2`.
#[test]
fn pc_2_4_the_blown_up_step_does_not_degrade_as_the_step_goes_to_zero() {
    let steps: Vec<f64> = (1..=12).map(|k| 10f64.powi(-k)).collect();
    for problem in [coupled_wells(), double_pendulum()] {
        let rows = small_steps(&problem, &steps).unwrap();
        for row in &rows {
            // measured 6.0e-01
            at_most(row.blown_up / (row.h * row.h + 1e-14), 2e0, format!("h = {:e}", row.h));
        }
        let smallest = &rows[11];
        // measured 2.3e-16
        at_most(smallest.blown_up, 6e-16, problem.name);
        // measured 6.3e-01
        at_least(smallest.position_form, 0.2, problem.name);
    }
}

/// At h = 0 the blown-up equation is the Euler-Lagrange equation; at finite h its step is the discrete Lagrangian map.
#[test]
fn pc_2_4_the_blown_up_equation_joins_the_euler_lagrange_equation_and_the_discrete_map() {
    for problem in [coupled_wells(), double_pendulum()] {
        let (system, q, v) = (problem.system.as_ref(), &problem.q, &problem.v);
        for a in [0.0, 0.5, 1.0] {
            let straight = Discretisation::straight(system, a);
            let (w, rate) = straight.step(q, v, 0.0).unwrap();
            // measured 0
            at_most((w - v).amax(), 4e-16, "W");
            // measured 6.7e-16
            at_most((rate - system.acceleration(q, v).unwrap()).amax(), 2e-15, "A");
            let h = 0.1;
            let (w, rate) = straight.step(q, v, h).unwrap();
            let (q0, q1) = straight.ends(q, v, h).unwrap();
            let (meets, q2) = straight.ends(&(q + &w * h), &(v + &rate * h), h).unwrap();
            // measured 1.1e-16
            at_most((&q1 - meets).amax(), 4e-16, "the curves meet");
            let own = lagrangian_map(&alpha(problem.system.clone(), a), &q0, &q1, h).unwrap();
            // measured 1.1e-16
            at_most((own - q2).amax(), 4e-16, "the discrete Lagrangian map");
        }
    }
}

/// Discretisations of the double pendulum's tangent bundle: straight and curved, about their middle and not.
fn discretisations(problem: &Problem) -> Vec<(String, Arc<dyn Curves>, f64, Quadrature, f64)> {
    let parabolas: Arc<dyn Curves> = Arc::new(Osculating(problem.system.clone()));
    let sinusoids: Arc<dyn Curves> = Arc::new(Sinusoids { frequency: 1.5 });
    let straight: Arc<dyn Curves> = Arc::new(Straight);
    let mut all = Vec::new();
    for minus in [-0.2, -0.5] {
        let mut add = |name: &str, curves: &Arc<dyn Curves>, rule: Quadrature, order: f64| {
            all.push((format!("{name}, alpha- = {minus}"), curves.clone(), minus, rule, order));
        };
        add("straight, Gauss 1", &straight, Quadrature::gauss(1), 2.0);
        add("sinusoids, Gauss 2", &sinusoids, Quadrature::gauss(2), 2.0);
        add(
            "parabolas, one node at q-",
            &parabolas,
            Quadrature { nodes: vec![0.0], weights: vec![1.0], order: 1 },
            1.0,
        );
        add("parabolas, Gauss 2", &parabolas, Quadrature::gauss(2), 4.0);
    }
    all
}

/// Along curves that err by `O(t^k)` in velocity the action errs by `O(h^(2k + 1))`, and no more than its quadrature: order 2 for
/// any straight or other first-order curve, 4 for osculating parabolas, wherever on the curve `(q, v)` stands.
#[test]
fn pc_2_discretisations_of_the_tangent_bundle_have_the_order_of_their_curves_and_quadrature() {
    for problem in [coupled_wells(), double_pendulum()] {
        let system = problem.system.as_ref();
        let motion = Motion::of(system);
        for (name, curves, minus, quadrature, theory) in discretisations(&problem) {
            let discretisation = Discretisation { system, curves: curves.as_ref(), minus, quadrature };
            let order = map_order(&motion, &problem.q, &problem.v, |q, p, h| discretisation.hamiltonian_map(q, p, h));
            // measured 5.4e-02
            at_most((order.unwrap() - theory).abs(), 0.12, format!("{name} on {}", problem.name));
        }
    }
}

/// PC let `alpha-` depend on `h`: the midpoint rule keeps its order where `alpha-` tends to -1/2 like `h`.
#[test]
fn pc_2_an_alpha_that_depends_on_the_step_keeps_the_order() {
    let problem = coupled_wells();
    let system = problem.system.as_ref();
    let order = |alpha: &dyn Fn(f64) -> f64| {
        let map = |q: &Vector, p: &Vector, h: f64| Discretisation::straight(system, alpha(h)).hamiltonian_map(q, p, h);
        map_order(&Motion::of(system), &problem.q, &problem.v, map).unwrap()
    };
    let (half, other) = (order(&|h| 0.5 + 0.8 * h), order(&|h| 0.1 + 0.3 * h));
    // measured 5.3e-03
    at_most((half - 2.0).abs(), 0.015, "tends to 1/2");
    // measured 1.4e-02
    at_most((other - 1.0).abs(), 0.04, "tends to another number");
}

/// Sinusoids of an oscillator's frequency are its motion: the map is the flow, up to quadrature.
#[test]
fn pc_2_curves_that_are_motions_make_the_exact_map() {
    let w: f64 = 1.7;
    let oscillator = Mechanical { mass: Matrix::identity(2, 2), potential: Spring { stiffness: w * w } };
    let (q, p, h) = (Vector::from_vec(vec![0.3, -0.8]), Vector::from_vec(vec![1.0, 0.4]), 0.6);
    let exact = (&q * (w * h).cos() + &p * ((w * h).sin() / w), &p * (w * h).cos() - &q * (w * (w * h).sin()));
    for minus in [0.0, -0.3, -0.5] {
        let map = |curves: &dyn Curves| {
            let discretisation =
                Discretisation { system: &oscillator, curves, minus, quadrature: Quadrature::gauss(8) };
            distance(&discretisation.hamiltonian_map(&q, &p, h).unwrap(), &exact)
        };
        let (own, chord) = (map(&Sinusoids { frequency: w }), map(&Straight));
        // measured 2.9e-16
        at_most(own, 7e-16, "sinusoids");
        // measured 6.6e-02
        at_least(chord, 0.03, "chords");
    }
}

/// The blown-up step on any curves: the curves meet with one momentum, at h = 0 its rates are the Euler-Lagrange vector field,
/// and down to h = 1e-12 they differ from it by `O(h)` and roundoff alone, where the second difference of the ends, three
/// positions, has lost all digits.
#[test]
fn pc_2_4_the_blown_up_step_is_regular_on_any_curves() {
    for problem in [coupled_wells(), double_pendulum()] {
        let (system, q, v) = (problem.system.as_ref(), &problem.q, &problem.v);
        let exact = system.acceleration(q, v).unwrap();
        for (name, curves, minus, quadrature, _) in discretisations(&problem) {
            let of = Discretisation { system, curves: curves.as_ref(), minus, quadrature };
            let next = |h: f64| {
                let (w, a) = of.step(q, v, h).unwrap();
                (q + w * h, v + a * h)
            };
            let (q1, v1) = next(0.2);
            let gap = (of.ends(q, v, 0.2).unwrap().1 - of.ends(&q1, &v1, 0.2).unwrap().0).amax();
            let jump = (of.momenta(q, v, 0.2).unwrap().1 - of.momenta(&q1, &v1, 0.2).unwrap().0).amax();
            let (w, a) = of.step(q, v, 0.0).unwrap();
            let field = (w - v).amax().max((a - &exact).amax());
            let off = |h: f64| (of.step(q, v, h).unwrap().1 - &exact).norm();
            let slope = off(1e-4) / 1e-4;
            let worst = (5..=12).map(|k| 10f64.powi(-k)).map(|h| off(h) - 1.1 * slope * h).fold(f64::MIN, f64::max);
            let h = 1e-12;
            let ((q0, q1), (q, v)) = (of.ends(q, v, h).unwrap(), next(h));
            let q2 = of.ends(&q, &v, h).unwrap().1;
            let lost = ((&q2 - &q1 - (&q1 - &q0)) / (h * h) - &exact).norm();
            // measured 1.1e-16
            at_most(gap, 3e-16, format!("{name}: the curves meet"));
            // measured 2.0e-15
            at_most(jump, 5e-15, format!("{name}: one momentum"));
            // measured 2.2e-16
            at_most(field, 5e-16, format!("{name}: h = 0"));
            // measured -5.2e-14: with 1.1 times the slope nothing is left
            at_most(worst, 4e-16, format!("{name}: small steps"));
            // measured 6.3e-01
            at_least(lost, 0.3, format!("{name}: positions"));
        }
    }
}

/// PC theorem 4.7: a discrete Lagrangian of order r has Legendre transforms of order r - 1 at least, for the singular 1/h
/// in them. Verlet shows that this is what happens: its `F+` errs by `h^2 M q'''/6` though its order is 2.
#[test]
fn pc_4_7_legendre_transforms_can_be_one_order_worse() {
    for problem in [coupled_wells(), double_pendulum()] {
        for method in METHODS.iter().filter(|m| m.order <= 4) {
            let Some(ld) = (method.build)(problem.system.clone()) else { continue };
            let measured = exponent(|h| legendre_error(ld.as_ref(), &problem, h), 0.08);
            assert!(measured >= method.order as f64 - 0.15, "{}: error of order h^{measured}", method.name);
        }
    }
    let problem = coupled_wells();
    let verlet = symmetrised(problem.system.clone(), 0.0);
    let motion = Motion::of(problem.system.as_ref());
    let third = {
        let a = |t: f64| {
            let at = motion.flow(&problem.q, &problem.v, t, 0.1).unwrap();
            motion.acceleration(&at.q, &at.v).unwrap()
        };
        problem.system.momentum(&problem.q, &((a(1e-3) - a(-1e-3)) / 2e-3))
    };
    let leading = |h: f64| {
        let end = motion.flow(&problem.q, &problem.v, h, 0.1).unwrap();
        let at = verlet.legendre(&problem.q, &end.q, h).unwrap();
        (at.p1 - problem.system.momentum(&end.q, &end.v)) / (h * h)
    };
    let extrapolated = leading(1e-3) * 2.0 - leading(2e-3);
    // measured 2.8e-07
    at_most((extrapolated.norm() - third.norm() / 6.0).abs() / third.norm(), 7e-7, "h^2 M q'''/6");
    // measured 2.3e+00
    at_least(third.norm(), 0.9, "there is something to measure");
}

/// PC theorem 4.8: the map has the full order r all the same, as `F-` and `F+` err alike where they meet. The errors of `F+`
/// at the end of one step and `F-` at the start of the next differ by `O(h^(r+1))`.
#[test]
fn pc_4_8_the_errors_of_both_legendre_transforms_cancel_in_the_map() {
    for problem in [coupled_wells(), double_pendulum()] {
        let motion = Motion::of(problem.system.as_ref());
        for method in METHODS.iter().filter(|m| m.order <= 4) {
            let Some(ld) = (method.build)(problem.system.clone()) else { continue };
            let jump = |h: f64| {
                let before = motion.flow(&problem.q, &problem.v, -h, 0.1).unwrap();
                let after = motion.flow(&problem.q, &problem.v, h, 0.1).unwrap();
                let plus = ld.legendre(&before.q, &problem.q, h).unwrap().p1;
                (plus - ld.legendre(&problem.q, &after.q, h).unwrap().p0).norm()
            };
            let measured = exponent(jump, 0.08);
            assert!(measured >= method.order as f64 + 0.85, "{}: jump of order h^{measured}", method.name);
        }
    }
}
