//! Forces: Marsden and West (2001), sections 3.2 and 3.6.

use std::sync::Arc;

use rattlebench::discrete::Vector;
use rattlebench::discrete::flow::Motion;
use rattlebench::discrete::force::{Force, LinearDrag, RadialDrag};
use rattlebench::discrete::lagrangian::{DiscreteLagrangian, DiscreteLegendre, SharedLagrangian, WithForce};
use rattlebench::discrete::maps::{euler_lagrange_residual, hamiltonian_map};
use rattlebench::discrete::methods::*;
use rattlebench::discrete::order::map_order;
use rattlebench::discrete::problems::{Problem, coupled_wells, double_pendulum, radial_particle};
use rattlebench::discrete::quadrature::Quadrature;
use rattlebench::discrete::solve::central_difference;
use rattlebench::discrete::structure::join;

use crate::common::discrete::{at_least, at_most, distance, start};

const H: f64 = 0.1;

/// Drag strong enough to matter within a step, with coupling between the coordinates.
fn drag() -> LinearDrag {
    LinearDrag { coefficient: rattlebench::discrete::Matrix::from_row_slice(2, 2, &[0.8, 0.3, -0.1, 0.6]) }
}

fn forced_motion<'a>(problem: &'a Problem, force: &'a dyn Force) -> Motion<'a> {
    Motion { force: Some(force), ..Motion::of(problem.system.as_ref()) }
}

#[test]
fn derivatives_of_the_forced_legendre_transforms_agree_with_differences() {
    for problem in [radial_particle(), double_pendulum()] {
        for method in METHODS {
            let Some(ld) = (method.build)(problem.system.clone()) else { continue };
            for force in [&drag() as &dyn Force, &RadialDrag { coefficient: 0.7 }] {
                let (q0, q1) = (problem.q.clone(), &problem.q + &problem.v * H);
                let n = q0.len();
                let both = WithForce { lagrangian: ld.as_ref(), force };
                let at = both.legendre(&q0, &q1, H).unwrap();
                let by = central_difference(&join(&q0, &q1), 1e-3, |x| {
                    let at = both.legendre(&x.rows(0, n).into_owned(), &x.rows(n, n).into_owned(), H)?;
                    Ok(join(&at.p0, &at.p1))
                })
                .unwrap();
                for (i, j, block) in [(0, 0, &at.p0_q0), (0, n, &at.p0_q1), (n, 0, &at.p1_q0), (n, n, &at.p1_q1)] {
                    // measured 1.2e-11
                    at_most((block - by.view((i, j), (n, n))).amax(), 3e-11, method.name);
                }
            }
        }
    }
}

/// The sum of discrete Lagrangian and discrete forces is what enters: `p1 = D2 L_d + f_d+`, `p0 = -D1 L_d - f_d-` where there
/// are no internal points (MW 3.2.2), and the discrete Lagrange-d'Alembert equations hold along the motion (3.2.2).
#[test]
fn mw_3_2_2_the_forced_maps_solve_the_discrete_lagrange_dalembert_equations() {
    let problem = double_pendulum();
    for method in METHODS {
        let Some(ld) = (method.build)(problem.system.clone()) else { continue };
        let force = drag();
        let both = WithForce { lagrangian: ld.as_ref(), force: &force };
        let (q0, p0) = start(&problem);
        let (q1, p1) = hamiltonian_map(&both, &q0, &p0, H).unwrap();
        let (q2, _) = hamiltonian_map(&both, &q1, &p1, H).unwrap();
        // measured 7.3e-15
        at_most(euler_lagrange_residual(&both, &q0, &q1, &q2, H).unwrap().amax(), 2e-14, method.name);
    }
    for a in [0.0, 0.3, 0.5] {
        let ld = alpha(problem.system.clone(), a);
        let q1 = &problem.q + &problem.v * H;
        let (jet, forced) = (ld.jet(&problem.q, &q1, H).unwrap(), ld.forced(&drag(), &problem.q, &q1, H).unwrap());
        // measured 0
        at_most((jet.d2 + forced.plus - forced.legendre.p1).amax(), 4e-16, "F+");
        // measured 0
        at_most((-jet.d1 - forced.minus - forced.legendre.p0).amax(), 4e-16, "F-");
    }
}

/// MW theorem 3.2.2 (forced discrete Noether theorem): a force without torque leaves the angular momentum alone, though it
/// takes energy. Drag with a torque does not.
#[test]
fn mw_3_2_2_a_force_without_torque_conserves_angular_momentum() {
    let problem = radial_particle();
    let moment = |q: &Vector, p: &Vector| q[0] * p[1] - q[1] * p[0];
    for method in METHODS {
        let ld = (method.build)(problem.system.clone()).unwrap();
        let run = |force: &dyn Force| {
            let both = WithForce { lagrangian: ld.as_ref(), force };
            let (mut q, mut p) = start(&problem);
            for _ in 0..30 {
                (q, p) = hamiltonian_map(&both, &q, &p, H).unwrap();
            }
            (moment(&q, &p), problem.system.hamiltonian(&q, &p).unwrap())
        };
        let (q0, p0) = start(&problem);
        let (moment0, energy0) = (moment(&q0, &p0), problem.system.hamiltonian(&q0, &p0).unwrap());
        let (j, energy) = run(&RadialDrag { coefficient: 0.5 });
        // measured 2.7e-14
        at_most((j - moment0).abs(), 6e-14, method.name);
        // measured 9.7e-02
        at_least(energy0 - energy, 0.03, "energy is taken");
        // measured 5.8e-01
        at_least((run(&drag()).0 - moment0).abs(), 0.2, "drag with a torque");
    }
}

/// MW example 3.2.3: the midpoint rule with drag follows the decay of the energy; RK4 at the same step adds its own loss.
#[test]
fn mw_3_2_3_the_forced_midpoint_rule_follows_the_benchmark_energy() {
    let figure = rattlebench::discrete::figures::dissipative_particle().unwrap();
    let truth = &figure.series[0].energy;
    let worst = |name: &str| {
        let series = figure.series.iter().find(|s| s.name == name).unwrap();
        series.energy.iter().zip(truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / truth[0]
    };
    // measured 5.1e-02
    at_most(worst("midpoint"), 0.2, "midpoint");
    // measured 2.7e-01
    at_least(worst("RK4"), 0.1, "RK4");
}

/// MW theorem 3.2.4: the forced map has the order of the discrete Lagrangian where the discrete forces have it too. The
/// explicit methods use a force of order 2.
#[test]
fn mw_3_2_4_forced_maps_have_the_order_of_their_discrete_lagrangian() {
    for problem in [coupled_wells(), double_pendulum()] {
        for method in METHODS {
            let Some(ld) = (method.build)(problem.system.clone()) else { continue };
            let force = drag();
            let both = WithForce { lagrangian: ld.as_ref(), force: &force };
            let motion = forced_motion(&problem, &force);
            let order = map_order(&motion, &problem.q, &problem.v, |q, p, h| hamiltonian_map(&both, q, p, h)).unwrap();
            // measured 9.2e-02
            at_most((order - method.forced_order as f64).abs(), 0.15, format!("{} on {}", method.name, problem.name));
        }
    }
}

/// MW example 3.2.5: the discrete forces of `L_d^alpha` are `f_d+ = alpha h f`, `f_d- = (1 - alpha) h f` at its one point.
/// Like the Legendre transforms each of them is one order short of the method against the exact discrete forces.
#[test]
fn mw_3_2_5_discrete_forces_of_the_alpha_family() {
    let problem = double_pendulum();
    let force = RadialDrag { coefficient: 0.7 };
    let exact = Exact { system: problem.system.clone() };
    for a in [0.0, 0.25, 0.5, 1.0] {
        let ld = alpha(problem.system.clone(), a);
        let q1 = &problem.q + &problem.v * H;
        let at = ld.forced(&force, &problem.q, &q1, H).unwrap();
        let f = force.value(&(&problem.q * (1.0 - a) + &q1 * a), &problem.v) * H;
        // measured 7.8e-18
        at_most((at.plus - &f * a).amax(), 4e-16, "f+");
        // measured 6.9e-18
        at_most((at.minus - &f * (1.0 - a)).amax(), 4e-16, "f-");
        let errors = |h: f64| {
            let end = forced_motion(&problem, &force).flow(&problem.q, &problem.v, h, 0.05).unwrap();
            let own = ld.forced(&force, &problem.q, &end.q, h).unwrap();
            let truth = exact.forced(&force, &problem.q, &end.q, h).unwrap();
            let whole = (&own.plus + &own.minus - &truth.plus - &truth.minus).norm();
            (whole, (own.plus - truth.plus).norm(), (own.minus - truth.minus).norm())
        };
        let (coarse, fine) = (errors(0.02), errors(0.01));
        let order = |coarse: f64, fine: f64| (coarse / fine).log2() - 1.0;
        let theory = if a == 0.5 { 2.0 } else { 1.0 };
        // measured 3.7e-02
        at_most((order(coarse.0, fine.0) - theory).abs(), 0.09, format!("alpha = {a}, impulse of the whole step"));
        // measured 1.2e-01
        at_most((order(coarse.1, fine.1) - (theory - 1.0)).abs(), 0.3, format!("alpha = {a}, f+"));
        // measured 1.0e-01
        at_most((order(coarse.2, fine.2) - (theory - 1.0)).abs(), 0.3, format!("alpha = {a}, f-"));
    }
}

/// The exact discrete forces make the flow of the forced system (MW 3.2.3), by Legendre transforms that split into
/// `D2 L_d^E + f_d^E+`.
#[test]
fn mw_3_2_3_exact_discrete_forces_generate_the_forced_flow() {
    let problem = double_pendulum();
    let force = drag();
    let exact = Exact { system: problem.system.clone() };
    let end = forced_motion(&problem, &force).flow(&problem.q, &problem.v, 0.3, 0.05).unwrap();
    let (q0, p0) = start(&problem);
    let both = WithForce { lagrangian: &exact, force: &force };
    let step = hamiltonian_map(&both, &q0, &p0, 0.3).unwrap();
    // measured 4.9e-15
    at_most(distance(&step, &(end.q.clone(), problem.system.momentum(&end.q, &end.v))), 2e-14, "flow");
    // The discrete forces as they are defined: the force along the motion against how the motion follows its ends.
    let rule = Quadrature::gauss(8);
    let samples = |ends: &Vector| {
        let (q0, q1) = (ends.rows(0, 2).into_owned(), ends.rows(2, 2).into_owned());
        let p0 = exact.forced(&force, &q0, &q1, 0.3)?.legendre.p0;
        let v0 = problem.system.velocity(&q0, &p0)?;
        let motion = forced_motion(&problem, &force);
        rule.nodes.iter().map(|c| motion.flow(&q0, &v0, 0.3 * c, 0.1)).collect::<Result<Vec<_>, _>>()
    };
    let ends = join(&q0, &end.q);
    let follows = central_difference(&ends, 1e-2, |ends| {
        Ok(Vector::from_iterator(16, samples(ends)?.iter().flat_map(|point| point.q.iter().copied())))
    })
    .unwrap();
    let mut work = Vector::zeros(4);
    for (i, point) in samples(&ends).unwrap().iter().enumerate() {
        work += follows.rows(2 * i, 2).transpose() * force.value(&point.q, &point.v) * (0.3 * rule.weights[i]);
    }
    let forced = exact.forced(&force, &q0, &end.q, 0.3).unwrap();
    // measured 6.4e-12
    at_most((join(&forced.minus, &forced.plus) - work).amax(), 2e-11, "f- and f+");
}

/// The adjoint of a forced method inverts it with -h, and compositions compose (MW 3.2 with 2.4 and 2.5).
#[test]
fn forced_adjoints_invert_and_forced_compositions_compose() {
    let problem = double_pendulum();
    let force = drag();
    let (q0, p0) = start(&problem);
    let part: SharedLagrangian = Arc::new(alpha(problem.system.clone(), 0.25));
    let forced = |ld: &dyn DiscreteLagrangian, q: &Vector, p: &Vector, h: f64| {
        hamiltonian_map(&WithForce { lagrangian: ld, force: &force }, q, p, h).unwrap()
    };
    let there = forced(&Adjoint(part.clone()), &q0, &p0, H);
    // measured 7.8e-16
    at_most(distance(&forced(part.as_ref(), &there.0, &there.1, -H), &(q0.clone(), p0.clone())), 2e-15, "adjoint");
    let half = forced(part.as_ref(), &q0, &p0, 0.4 * H);
    let both = forced(part.as_ref(), &half.0, &half.1, 0.6 * H);
    let whole = forced(&Composition::of(part, &[0.4, 0.6]), &q0, &p0, H);
    // measured 3.3e-15
    at_most(distance(&whole, &both), 8e-15, "composition");
}
