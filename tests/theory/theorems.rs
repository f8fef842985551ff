//! Theorems and examples of Marsden and West (2001), part 2, as computations.

use std::sync::Arc;

use rattlebench::discrete::flow::Motion;
use rattlebench::discrete::force::Force;
use rattlebench::discrete::lagrangian::{DiscreteLagrangian, Forced, Jet, SharedLagrangian};
use rattlebench::discrete::maps::{
    euler_lagrange_residual, hamiltonian_map, hamiltonian_map_derivative, lagrangian_map,
};
use rattlebench::discrete::methods::*;
use rattlebench::discrete::order::{fitted_order, order_samples};
use rattlebench::discrete::problems::{
    Problem, RadialPolynomial, Spring, coupled_wells, double_pendulum, radial_particle,
};
use rattlebench::discrete::quadrature::{Quadrature, collocation_matrix};
use rattlebench::discrete::solve::SolveError;
use rattlebench::discrete::structure::{canonical_form, join, momentum_maps, symplectic_form, symplecticity_defect};
use rattlebench::discrete::system::Mechanical;
use rattlebench::discrete::{Matrix, Vector};

use crate::common::discrete::{at_least, at_most, distance, start};

fn problems() -> [Problem; 3] {
    [coupled_wells(), double_pendulum(), radial_particle()]
}

/// All methods on all problems that they are defined for.
fn everything() -> Vec<(&'static Method, Problem, SharedLagrangian)> {
    let pairs = problems().into_iter().flat_map(|p| METHODS.iter().map(move |m| (m, p.clone())));
    pairs.filter_map(|(m, p)| Some((m, p.clone(), (m.build)(p.system.clone())?))).collect()
}

fn table_order(ld: &dyn DiscreteLagrangian, problem: &Problem) -> (f64, f64) {
    let samples = order_samples(ld, problem).unwrap();
    (
        fitted_order(samples.iter().map(|s| (s.h, s.lagrangian, f64::EPSILON))),
        fitted_order(samples.iter().map(|s| (s.h, s.map, f64::EPSILON / s.h))),
    )
}

const H: f64 = 0.1;

#[test]
fn derivatives_of_every_discrete_lagrangian_agree_with_differences() {
    for (method, problem, ld) in everything() {
        let (q0, q1) = (problem.q.clone(), &problem.q + &problem.v * H);
        let jet = ld.jet(&q0, &q1, H).unwrap();
        let n = q0.len();
        let ends = join(&q0, &q1);
        let by = rattlebench::discrete::solve::central_difference(&ends, 1e-3, |x| {
            let (a, b) = (x.rows(0, n).into_owned(), x.rows(n, n).into_owned());
            let at = ld.jet(&a, &b, H)?;
            Ok(join(&Vector::from_element(1, at.value), &join(&at.d1, &at.d2)))
        })
        .unwrap();
        let first = join(&jet.d1, &jet.d2).transpose() - by.rows(0, 1);
        // measured 1.9e-13
        at_most(first.amax(), 5e-13, format!("{}: first derivatives", method.name));
        let mut second = Matrix::zeros(2 * n, 2 * n);
        second.view_mut((0, 0), (n, n)).copy_from(&jet.d11);
        second.view_mut((0, n), (n, n)).copy_from(&jet.d12);
        second.view_mut((n, 0), (n, n)).copy_from(&jet.d12.transpose());
        second.view_mut((n, n), (n, n)).copy_from(&jet.d22);
        let off = (second - by.rows(1, 2 * n)).amax();
        // measured 1.1e-11
        at_most(off, 3e-11, format!("{} on {}: second derivatives", method.name, problem.name));
    }
}

/// MW 1.5.2: the position form and the momentum form are one map.
#[test]
fn mw_1_5_2_position_form_and_momentum_form_agree() {
    for (method, problem, ld) in everything() {
        let (q0, p0) = start(&problem);
        let (q1, p1) = hamiltonian_map(ld.as_ref(), &q0, &p0, H).unwrap();
        let (q2, _) = hamiltonian_map(ld.as_ref(), &q1, &p1, H).unwrap();
        let by_position = lagrangian_map(ld.as_ref(), &q0, &q1, H).unwrap();
        // measured 6.7e-16
        at_most((&q2 - by_position).amax(), 2e-15, method.name);
        let residual = euler_lagrange_residual(ld.as_ref(), &q0, &q1, &q2, H).unwrap().amax();
        // measured 7.3e-15
        at_most(residual, 2e-14, method.name);
    }
}

/// MW 1.3.2: the maps preserve the discrete and the canonical symplectic form, seen from outside by differences of the
/// map as it runs. Explicit Euler does not.
#[test]
fn mw_1_3_2_every_map_is_symplectic() {
    for (method, problem, ld) in everything() {
        let (q, p) = start(&problem);
        let defect = symplecticity_defect(&q, &p, 5e-3, |q, p| hamiltonian_map(ld.as_ref(), q, p, H)).unwrap();
        // measured 2.0e-12
        at_most(defect, 5e-12, format!("{} on {}", method.name, problem.name));
        let derivative = hamiltonian_map_derivative(ld.as_ref(), &q, &p, H).unwrap();
        let form = canonical_form(q.len());
        let defect = (derivative.transpose() * &form * derivative - &form).amax();
        // measured 3.8e-13
        at_most(defect, 9e-13, method.name);
    }
    let problem = double_pendulum();
    let (q, p) = start(&problem);
    let euler = symplecticity_defect(&q, &p, 5e-3, |q, p| {
        let v = problem.system.velocity(q, p)?;
        Ok((q + &v * H, p + problem.system.gradient(q, &v).q * H))
    });
    // measured 1.9e-02
    at_least(euler.unwrap(), 0.007, "explicit Euler");
}

/// MW 1.3.2 in position form: the pull-back of `Omega_Ld` by `(q0, q1) -> (q1, q2)` is `Omega_Ld`.
#[test]
fn mw_1_3_2_the_discrete_symplectic_form_is_preserved() {
    for (method, problem, ld) in everything() {
        let n = problem.q.len();
        let (q0, q1) = (problem.q.clone(), &problem.q + &problem.v * H);
        let map = rattlebench::discrete::solve::central_difference(&join(&q0, &q1), 5e-3, |x| {
            let (a, b) = (x.rows(0, n).into_owned(), x.rows(n, n).into_owned());
            let c = lagrangian_map(ld.as_ref(), &a, &b, H)?;
            Ok(join(&b, &c))
        })
        .unwrap();
        let q2 = lagrangian_map(ld.as_ref(), &q0, &q1, H).unwrap();
        let before = symplectic_form(ld.as_ref(), &q0, &q1, H).unwrap();
        let after = symplectic_form(ld.as_ref(), &q1, &q2, H).unwrap();
        let defect = (map.transpose() * after * map - &before).amax() / before.amax();
        // measured 1.9e-12
        at_most(defect, 5e-12, format!("{} on {}", method.name, problem.name));
    }
}

/// MW 1.3.3 (discrete Noether theorem): rotations of the plane.
#[test]
fn mw_1_3_3_angular_momentum_is_conserved_to_roundoff() {
    let problem = radial_particle();
    let turn = |q: &Vector| Vector::from_vec(vec![-q[1], q[0]]);
    for method in METHODS {
        let ld = (method.build)(problem.system.clone()).unwrap();
        let (mut q, mut p) = start(&problem);
        let j0 = p.dot(&turn(&q));
        for _ in 0..50 {
            let (q1, p1) = hamiltonian_map(ld.as_ref(), &q, &p, H).unwrap();
            let (minus, plus) = momentum_maps(ld.as_ref(), turn, &q, &q1, H).unwrap();
            // measured 9.5e-15
            at_most((minus - plus).abs(), 3e-14, method.name);
            (q, p) = (q1, p1);
        }
        // measured 3.3e-14
        at_most((p.dot(&turn(&q)) - j0).abs(), 8e-14, method.name);
    }
}

/// MW 1.6.3 and 1.6.4: the exact discrete Lagrangian generates the flow and has the exact Legendre transforms.
#[test]
fn mw_1_6_3_the_exact_discrete_lagrangian_generates_the_flow() {
    for problem in [coupled_wells(), double_pendulum()] {
        let exact = Exact { system: problem.system.clone() };
        let (q0, p0) = start(&problem);
        let end = Motion::of(problem.system.as_ref()).flow(&problem.q, &problem.v, 0.4, 0.05).unwrap();
        let p1 = problem.system.momentum(&end.q, &end.v);
        let step = hamiltonian_map(&exact, &q0, &p0, 0.4).unwrap();
        // measured 1.2e-14
        at_most(distance(&step, &(end.q.clone(), p1)), 3e-14, problem.name);
        let value = exact.value(&q0, &end.q, 0.4).unwrap();
        // measured 1.4e-15
        at_most((value - end.action).abs(), 4e-15, "action");
        let jet = exact.jet(&q0, &end.q, 0.4).unwrap();
        let symmetric = (&jet.d11 - jet.d11.transpose()).amax();
        // measured 6.3e-12
        at_most(symmetric, 2e-11, "D11 is symmetric");
    }
}

/// A discrete Lagrangian with a number added that depends on the step alone.
struct PlusNumber(SharedLagrangian);

impl DiscreteLagrangian for PlusNumber {
    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn jet(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Jet, SolveError> {
        let jet = self.0.jet(q0, q1, h)?;
        Ok(Jet { value: jet.value + h * h, ..jet })
    }

    fn forced(&self, force: &dyn Force, q0: &Vector, q1: &Vector, h: f64) -> Result<Forced, SolveError> {
        self.0.forced(force, q0, q1, h)
    }
}

/// MW 2.1.2: discrete Lagrangians that differ by a number have one discrete Hamiltonian map (strong equivalence).
#[test]
fn mw_2_1_2_strongly_equivalent_discrete_lagrangians_have_the_same_map() {
    let problem = coupled_wells();
    let plain: SharedLagrangian = Arc::new(alpha(problem.system.clone(), 0.5));
    let (q0, p0) = start(&problem);
    let own = hamiltonian_map(plain.as_ref(), &q0, &p0, H).unwrap();
    let lifted = PlusNumber(plain.clone());
    assert!(distance(&hamiltonian_map(&lifted, &q0, &p0, H).unwrap(), &own) == 0.0);
    let values = [plain.as_ref(), &lifted as &dyn DiscreteLagrangian].map(|ld| ld.value(&q0, &own.0, H).unwrap());
    // measured 1.0e-02
    at_least(values[1] - values[0], 5e-3, "the values differ");
    // Gauss-Legendre 1 comes from other unknowns and is the midpoint rule.
    let gauss1 = hamiltonian_map(&gauss(problem.system.clone(), 1), &q0, &p0, H).unwrap();
    // measured 2.2e-16
    at_most(distance(&gauss1, &own), 5e-16, "Gauss-Legendre 1");
}

/// MW 2.1.2: a null Lagrangian changes no position (weak equivalence) but shifts momenta.
#[test]
fn mw_2_1_2_equivalent_discrete_lagrangians_have_the_same_motion() {
    let problem = coupled_wells();
    let plain: SharedLagrangian = Arc::new(alpha(problem.system.clone(), 0.5));
    let null = Arc::new(RadialPolynomial);
    let shifted = Equivalent { lagrangian: plain.clone(), null, power: 1 };
    let (q0, p0) = start(&problem);
    let (q1, p1) = hamiltonian_map(plain.as_ref(), &q0, &p0, H).unwrap();
    let weak =
        (lagrangian_map(plain.as_ref(), &q0, &q1, H).unwrap() - lagrangian_map(&shifted, &q0, &q1, H).unwrap()).amax();
    // measured 0
    at_most(weak, 4e-16, "positions");
    let not_strong = distance(&hamiltonian_map(&shifted, &q0, &p0, H).unwrap(), &(q1.clone(), p1.clone()));
    // measured 4.8e-03
    at_least(not_strong, 0.001, "momenta");
    // Conjugate by the shift of the momenta.
    let gradient = |q: &Vector| rattlebench::discrete::system::Potential::gradient(&RadialPolynomial, q) * H;
    let (a, b) = hamiltonian_map(&shifted, &q0, &(&p0 + gradient(&q0)), H).unwrap();
    // measured 0
    at_most(distance(&(a, b), &(q1.clone(), p1 + gradient(&q1))), 4e-16, "conjugate by the shift");
}

/// MW example 2.3.2: `L_d^alpha = h L + h^2/2 (2 alpha L_q . v + L_v . a) + O(h^3)`, so it has order 1, and 2 for alpha = 1/2.
#[test]
fn mw_2_3_2_leading_error_of_the_alpha_family() {
    for problem in [coupled_wells(), double_pendulum()] {
        let slope = problem.system.gradient(&problem.q, &problem.v).q.dot(&problem.v);
        for a in [0.0, 0.25, 0.5, 1.0] {
            let ld = alpha(problem.system.clone(), a);
            let at = |h: f64| {
                let end = Motion::of(problem.system.as_ref()).flow(&problem.q, &problem.v, h, 0.05).unwrap();
                (ld.value(&problem.q, &end.q, h).unwrap() - end.action) / (h * h)
            };
            // Richardson: the next term is of order h.
            let coefficient = 2.0 * at(1e-3) - at(2e-3);
            // measured 1.3e-07
            at_most((coefficient - (a - 0.5) * slope).abs(), 3e-7, format!("alpha = {a}"));
        }
    }
}

/// MW example 2.3.3: symmetrising gives order 2 for every alpha.
#[test]
fn mw_2_3_3_the_symmetrised_family_has_order_two_for_every_alpha() {
    for problem in [coupled_wells(), double_pendulum()] {
        for a in [0.0, 0.1, 0.3, 0.7] {
            let (ld, map) = table_order(&symmetrised(problem.system.clone(), a), &problem);
            // measured 5.9e-04
            at_most((ld - 2.0).abs(), 0.002, format!("alpha = {a}"));
            // measured 2.9e-03
            at_most((map - 2.0).abs(), 0.007, format!("alpha = {a}"));
        }
    }
}

/// MW theorem 2.4.1: the map of the adjoint is the inverse of the map with -h; a self-adjoint `L_d` has a self-adjoint map.
#[test]
fn mw_2_4_1_the_adjoint_generates_the_adjoint_map() {
    for (method, problem, ld) in everything() {
        let (q0, p0) = start(&problem);
        let adjoint = Adjoint(ld.clone());
        let there = hamiltonian_map(&adjoint, &q0, &p0, H).unwrap();
        let back = hamiltonian_map(ld.as_ref(), &there.0, &there.1, -H).unwrap();
        // measured 1.1e-14
        at_most(distance(&back, &(q0.clone(), p0.clone())), 3e-14, method.name);
        let own = distance(&hamiltonian_map(ld.as_ref(), &q0, &p0, H).unwrap(), &there);
        if method.self_adjoint {
            // measured 1.2e-14
            at_most(own, 3e-14, method.name);
        } else {
            // measured 1.8e-05
            at_least(own, 7e-6, format!("{} is self-adjoint on {}", method.name, problem.name));
        }
    }
}

/// MW theorem 2.4.2: an adjoint has the order of its original, self-adjoint methods have even order, and the exact discrete
/// Lagrangian is self-adjoint.
#[test]
fn mw_2_4_2_orders_of_adjoints() {
    assert!(METHODS.iter().all(|m| !m.self_adjoint || m.order % 2 == 0));
    let problem = coupled_wells();
    let ruth3: SharedLagrangian = Arc::new(ruth(problem.system.clone()).unwrap());
    let (ld, map) = table_order(&Adjoint(ruth3), &problem);
    // measured 5.7e-05
    at_most((ld - 3.0).abs(), 2e-4, "order of L_d");
    // measured 4.8e-04
    at_most((map - 3.0).abs(), 0.002, "order of the map");
    let exact: SharedLagrangian = Arc::new(Exact { system: problem.system.clone() });
    let q1 = &problem.q + &problem.v * 0.3;
    let own = exact.value(&problem.q, &q1, 0.3).unwrap();
    let adjoint = Adjoint(exact).value(&problem.q, &q1, 0.3).unwrap();
    // measured 1.1e-15
    at_most((own - adjoint).abs(), 3e-15, "the exact one is self-adjoint");
}

/// MW example 2.4.3: the adjoint of `L_d^alpha` is `L_d^(1-alpha)`; the symmetrised family is self-adjoint.
#[test]
fn mw_2_4_3_adjoints_of_the_alpha_family() {
    for problem in [coupled_wells(), double_pendulum()] {
        let (q0, q1) = (problem.q.clone(), &problem.q + &problem.v * H);
        for a in [0.0, 0.2, 0.5, 0.9] {
            let system = &problem.system;
            let mirror = alpha(system.clone(), 1.0 - a).jet(&q0, &q1, H).unwrap();
            let adjoint = Adjoint(Arc::new(alpha(system.clone(), a))).jet(&q0, &q1, H).unwrap();
            // measured 0
            at_most((mirror.value - adjoint.value).abs(), 4e-16, "value");
            // measured 0
            at_most((mirror.d2 - adjoint.d2).amax(), 4e-16, "D2");
            let own = symmetrised(system.clone(), a);
            let twin = Adjoint(Arc::new(symmetrised(system.clone(), a)));
            // measured 0
            at_most((own.value(&q0, &q1, H).unwrap() - twin.value(&q0, &q1, H).unwrap()).abs(), 4e-16, "symmetrised");
        }
    }
}

/// MW theorem 2.5.1: the discrete Lagrangian of a composition generates the composition of the maps.
#[test]
fn mw_2_5_1_composition_of_lagrangians_composes_the_maps() {
    for problem in [coupled_wells(), double_pendulum()] {
        let s = || problem.system.clone();
        let parts: Vec<(f64, SharedLagrangian)> = vec![
            (0.3, Arc::new(alpha(s(), 0.0))),
            (0.9, Arc::new(gauss(s(), 2))),
            (-0.2, Arc::new(symmetrised(s(), 0.25))),
        ];
        let (q0, p0) = start(&problem);
        let (mut q, mut p) = (q0.clone(), p0.clone());
        for (weight, part) in &parts {
            (q, p) = hamiltonian_map(part.as_ref(), &q, &p, weight * 0.2).unwrap();
        }
        let whole = hamiltonian_map(&Composition { parts }, &q0, &p0, 0.2).unwrap();
        // measured 2.2e-16
        at_most(distance(&whole, &(q, p)), 5e-16, problem.name);
    }
}

/// The composition of an Euler half step and its adjoint is Stoermer-Verlet (MW 2.5).
#[test]
fn mw_2_5_euler_and_its_adjoint_make_verlet() {
    let problem = coupled_wells();
    let euler: SharedLagrangian = Arc::new(alpha(problem.system.clone(), 0.0));
    let (q0, p0) = start(&problem);
    let both = Composition { parts: vec![(0.5, euler.clone()), (0.5, Arc::new(Adjoint(euler)))] };
    let verlet = symmetrised(problem.system.clone(), 0.0);
    let gap = distance(&hamiltonian_map(&both, &q0, &p0, H).unwrap(), &hamiltonian_map(&verlet, &q0, &p0, H).unwrap());
    // measured 6.7e-16
    at_most(gap, 2e-15, "Verlet");
}

/// MW 2.6.1: the momentum form of Stoermer-Verlet is velocity Verlet.
#[test]
fn mw_2_6_stoermer_verlet_is_velocity_verlet() {
    let problem = coupled_wells();
    let parts = problem.system.separable().unwrap();
    let (q0, p0) = start(&problem);
    let half = &p0 - parts.potential_gradient(&q0) * (0.5 * H);
    let q1 = &q0 + problem.system.velocity(&q0, &half).unwrap() * H;
    let p1 = half - parts.potential_gradient(&q1) * (0.5 * H);
    let own = hamiltonian_map(&symmetrised(problem.system.clone(), 0.0), &q0, &p0, H).unwrap();
    // measured 2.2e-16
    at_most(distance(&own, &(q1, p1)), 5e-16, "velocity Verlet");
}

/// MW 2.6.2: Newmark's own formulas, `p = (dx/dq)^T M v`.
#[test]
fn mw_2_6_newmark_is_the_map_of_its_discrete_lagrangian() {
    let problem = coupled_wells();
    let parts = problem.system.separable().unwrap();
    let inverse = parts.mass().clone().try_inverse().unwrap();
    for beta in [0.0, 1.0 / 6.0, 0.25, 0.4] {
        let momentum = |q: &Vector, v: &Vector| {
            let slope = Matrix::identity(2, 2) + &inverse * parts.potential_hessian(q) * (beta * H * H);
            slope.transpose() * parts.mass() * v
        };
        let acceleration = |q: &Vector| -(&inverse * parts.potential_gradient(q));
        let ld = Newmark::new(problem.system.clone(), beta).unwrap();
        let (q1, p1) = hamiltonian_map(&ld, &problem.q, &momentum(&problem.q, &problem.v), H).unwrap();
        let (a0, a1) = (acceleration(&problem.q), acceleration(&q1));
        let by_formula = &problem.q + &problem.v * H + (&a0 * (0.5 - beta) + &a1 * beta) * (H * H);
        let v1 = &problem.v + (a0 + a1) * (0.5 * H);
        // measured 5.6e-17
        at_most((&q1 - by_formula).amax(), 4e-16, format!("beta = {beta}"));
        // measured 2.2e-16
        at_most((p1 - momentum(&q1, &v1)).amax(), 5e-16, format!("beta = {beta}"));
    }
}

/// MW 2.6.3: kicks and drifts in turn.
#[test]
fn mw_2_6_explicit_partitioned_rk_is_a_sequence_of_kicks_and_drifts() {
    let problem = coupled_wells();
    let parts = problem.system.separable().unwrap();
    let (mut q, mut p) = start(&problem);
    let own = hamiltonian_map(&ruth(problem.system.clone()).unwrap(), &q, &p, H).unwrap();
    for (kick, drift) in [(7.0 / 24.0, 2.0 / 3.0), (3.0 / 4.0, -2.0 / 3.0), (-1.0 / 24.0, 1.0)] {
        p -= parts.potential_gradient(&q) * (kick * H);
        q += problem.system.velocity(&q, &p).unwrap() * (drift * H);
    }
    // measured 3.3e-16
    at_most(distance(&own, &(q, p)), 8e-16, "Ruth");
}

/// MW theorem 2.6.1: the map of (2.6.8) is the partitioned Runge-Kutta method with `b_i at_ij + b_j a_ji = b_i b_j`,
/// here solved by fixed-point iteration of its own equations.
#[test]
fn mw_2_6_1_the_discrete_lagrangian_of_a_symplectic_prk_generates_it() {
    for problem in [coupled_wells(), double_pendulum()] {
        for (s, lobatto_pair) in [(1, false), (2, false), (3, false), (2, true), (3, true), (4, true)] {
            let rule = if lobatto_pair { Quadrature::lobatto(s) } else { Quadrature::gauss(s) };
            let (a, b) = (collocation_matrix(&rule.nodes), &rule.weights);
            let conjugate = Matrix::from_fn(s, s, |i, j| b[j] - b[j] * a[(j, i)] / b[i]);
            let (q0, p0) = start(&problem);
            let mut rates = vec![(problem.v.clone(), Vector::zeros(2)); s];
            for _ in 0..200 {
                rates = (0..s)
                    .map(|i| {
                        let (mut q, mut p) = (q0.clone(), p0.clone());
                        for j in 0..s {
                            q.axpy(H * a[(i, j)], &rates[j].0, 1.0);
                            p.axpy(H * conjugate[(i, j)], &rates[j].1, 1.0);
                        }
                        let v = problem.system.velocity(&q, &p).unwrap();
                        let force = problem.system.gradient(&q, &v).q;
                        (v, force)
                    })
                    .collect();
            }
            let (mut q1, mut p1) = (q0.clone(), p0.clone());
            for j in 0..s {
                q1.axpy(H * b[j], &rates[j].0, 1.0);
                p1.axpy(H * b[j], &rates[j].1, 1.0);
            }
            let ld = partitioned_rk(problem.system.clone(), &a, b);
            let gap = distance(&hamiltonian_map(&ld, &q0, &p0, H).unwrap(), &(q1, p1));
            // measured 1.7e-15
            at_most(gap, 4e-15, format!("{s} stages on {}", problem.name));
        }
    }
}

/// MW theorem 2.6.2: Galerkin polynomials of degree s with s quadrature points are the symplectic Runge-Kutta method of
/// collocation there. With Lobatto points in excess the two agree where the mass is constant, and only there.
#[test]
fn mw_2_6_2_galerkin_methods_are_symplectic_partitioned_rk() {
    let gap = |problem: &Problem, a: &dyn DiscreteLagrangian, b: &dyn DiscreteLagrangian| {
        let (q, p) = start(problem);
        distance(&hamiltonian_map(a, &q, &p, H).unwrap(), &hamiltonian_map(b, &q, &p, H).unwrap())
    };
    for problem in [coupled_wells(), double_pendulum()] {
        for s in 1..=4 {
            let galerkin = polynomial(problem.system.clone(), s, &Quadrature::gauss(s));
            let off = gap(&problem, &galerkin, &gauss(problem.system.clone(), s));
            // measured 1.2e-14
            at_most(off, 3e-14, format!("{s} on {}", problem.name));
        }
    }
    for s in 2..=4 {
        let both =
            |p: &Problem| (polynomial(p.system.clone(), s - 1, &Quadrature::lobatto(s)), lobatto(p.system.clone(), s));
        let (constant, varying) = (coupled_wells(), double_pendulum());
        let ((a, b), (c, d)) = (both(&constant), both(&varying));
        // measured 2.2e-15
        at_most(gap(&constant, &a, &b), 5e-15, format!("{s}"));
        // measured 3.1e-10
        at_least(gap(&varying, &c, &d), 1e-10, format!("{s}"));
    }
}

/// MW 2.6.10: any quadrature serves, and the order is that of the worse of trajectories and quadrature. The three-eighths rule
/// has order 4, and so has the method on cubics, whose own order is 6.
#[test]
fn mw_2_6_10_galerkin_takes_any_quadrature() {
    let equidistant =
        Quadrature { nodes: vec![0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0], weights: vec![0.125, 0.375, 0.375, 0.125], order: 4 };
    for problem in [coupled_wells(), double_pendulum()] {
        let (ld, map) = table_order(&polynomial(problem.system.clone(), 3, &equidistant), &problem);
        // measured 3.3e-04
        at_most((ld - 4.0).abs(), 1e-3, "order of L_d");
        // measured 1.8e-03
        at_most((map - 4.0).abs(), 5e-3, "order of the map");
    }
}

/// MW 5.3.8: sinusoidal trajectories of the right frequency carry an oscillator exactly.
#[test]
fn mw_5_3_8_sinusoidal_trajectories_are_exact_for_their_oscillator() {
    let omega: f64 = 3.0;
    let oscillator = Mechanical { mass: Matrix::identity(2, 2), potential: Spring { stiffness: omega * omega } };
    let system = Arc::new(oscillator);
    let (q0, p0) = (Vector::from_vec(vec![0.3, -0.8]), Vector::from_vec(vec![1.0, 0.4]));
    let (h, w) = (0.4, omega);
    let exact = (&q0 * (w * h).cos() + &p0 * ((w * h).sin() / w), &p0 * (w * h).cos() - &q0 * (w * (w * h).sin()));
    let error = |quadrature: Quadrature| {
        let ld = Trigonometric { system: system.clone(), frequency: omega, quadrature };
        distance(&hamiltonian_map(&ld, &q0, &p0, h).unwrap(), &exact)
    };
    // measured 1.3e-15
    at_most(error(Quadrature::gauss(8)), 3e-15, "sinusoids");
    let parabola = polynomial(system.clone(), 2, &Quadrature::gauss(8));
    // measured 3.0e-03
    at_least(distance(&hamiltonian_map(&parabola, &q0, &p0, h).unwrap(), &exact), 0.001, "parabolas");
}
