//! Constraints, and constraints with forces: Marsden and West (2001), sections 3.4, 3.5 and 3.7.

use std::sync::Arc;

use rattlebench::discrete::constrained::{composed, constrained_map, shake, tangent_momentum};
use rattlebench::discrete::constraint::{Constraint, Sphere, TwoRods};
use rattlebench::discrete::flow::Motion;
use rattlebench::discrete::force::{Force, LinearDrag};
use rattlebench::discrete::lagrangian::{DiscreteLagrangian, DiscreteLegendre, SharedLagrangian, WithForce};
use rattlebench::discrete::methods::*;
use rattlebench::discrete::order::map_order;
use rattlebench::discrete::problems::{RadialPolynomial, Uniform};
use rattlebench::discrete::quadrature::Quadrature;
use rattlebench::discrete::solve::newton;
use rattlebench::discrete::stencil::StencilLagrangian;
use rattlebench::discrete::structure::symplecticity_defect;
use rattlebench::discrete::system::{Mechanical, SharedSystem};
use rattlebench::discrete::{Matrix, Vector};

use crate::common::discrete::{at_least, at_most, distance};

const H: f64 = 0.1;

/// A double pendulum as two particles in the plane with rods.
struct Rods {
    system: SharedSystem,
    constraint: Arc<TwoRods>,
    q: Vector,
    v: Vector,
}

fn double_pendulum() -> Rods {
    let masses = [1.0, 1.0, 0.6, 0.6];
    let weight = Vector::from_vec(vec![0.0, 1.0, 0.0, 0.6]);
    let (a, b): (f64, f64) = (0.6, -0.5);
    let (u, w) = (0.5, 0.9);
    let first = [a.sin(), -a.cos()];
    Rods {
        system: Arc::new(Mechanical {
            mass: Matrix::from_diagonal(&Vector::from_row_slice(&masses)),
            potential: Uniform { weight },
        }),
        constraint: Arc::new(TwoRods { lengths: [1.0, 0.8] }),
        q: Vector::from_vec(vec![first[0], first[1], first[0] + 0.8 * b.sin(), first[1] - 0.8 * b.cos()]),
        v: Vector::from_vec(vec![
            u * a.cos(),
            u * a.sin(),
            u * a.cos() + 0.8 * w * b.cos(),
            u * a.sin() + 0.8 * w * b.sin(),
        ]),
    }
}

impl Rods {
    fn motion<'a>(&'a self, force: Option<&'a dyn Force>) -> Motion<'a> {
        Motion { force, constraint: Some(self.constraint.as_ref()), ..Motion::of(self.system.as_ref()) }
    }

    fn step(&self, ld: &(impl DiscreteLegendre + ?Sized), q: &Vector, p: &Vector, h: f64) -> (Vector, Vector) {
        let step = constrained_map(ld, self.system.as_ref(), self.constraint.as_ref(), q, p, h).unwrap();
        (step.q, step.p)
    }

    /// Galerkin with Lobatto points, the inner ones on the constraint (MW 3.5.6).
    fn galerkin(&self, degree: usize) -> StencilLagrangian {
        let mut ld = polynomial(self.system.clone(), degree, &Quadrature::lobatto(degree + 1));
        ld.constraint = Some((self.constraint.clone(), (1..degree).collect()));
        ld
    }

    fn start(&self) -> (Vector, Vector) {
        (self.q.clone(), self.system.momentum(&self.q, &self.v))
    }
}

/// The double pendulum in its angles: coordinates of N.
fn embed(angles: &Vector) -> Vector {
    let (a, b) = (angles[0], angles[1]);
    Vector::from_vec(vec![a.sin(), -a.cos(), a.sin() + 0.8 * b.sin(), -a.cos() - 0.8 * b.cos()])
}

/// Derivative of [`embed`], 4 x 2.
fn tangent(angles: &Vector) -> Matrix {
    let (a, b) = (angles[0], angles[1]);
    Matrix::from_row_slice(4, 2, &[a.cos(), 0.0, a.sin(), 0.0, a.cos(), 0.8 * b.cos(), a.sin(), 0.8 * b.sin()])
}

fn angles(q: &Vector) -> Vector {
    Vector::from_vec(vec![q[0].atan2(-q[1]), (q[2] - q[0]).atan2(q[1] - q[3])])
}

/// MW theorem 3.4.1: multipliers on Q x Q and the restriction of `L_d` to N x N give the same motion. Here the discrete
/// Euler-Lagrange equations of `L_d(x(a0), x(a1))` in the angles, solved by themselves.
#[test]
fn mw_3_4_1_multipliers_and_restriction_to_n_agree() {
    let rods = double_pendulum();
    for ld in [alpha(rods.system.clone(), 0.5), symmetrised(rods.system.clone(), 0.0), alpha(rods.system.clone(), 0.0)]
    {
        let (q0, p0) = rods.start();
        let (q1, p1) = rods.step(&ld, &q0, &p0, H);
        let by_multipliers = shake(&ld, rods.constraint.as_ref(), &q0, &q1, H).unwrap();
        // D2 L_d^N(a0, a1) + D1 L_d^N(a1, a2) = 0 with D L_d^N = D L_d . x'(a)
        let (a1, before) = (angles(&q1), ld.jet(&q0, &q1, H).unwrap().d2);
        let guess = angles(&by_multipliers) + Vector::from_vec(vec![1e-3, -2e-3]);
        let a2 = newton("restricted equations", guess, |a2| {
            let jet = ld.jet(&q1, &embed(a2), H)?;
            let residual = tangent(&a1).transpose() * (&before + jet.d1);
            Ok((residual, tangent(&a1).transpose() * jet.d12 * tangent(a2)))
        })
        .unwrap();
        // measured 2.2e-16
        at_most((embed(&a2) - &by_multipliers).amax(), 5e-16, "restriction");
        // measured 1.1e-16
        at_most((rods.step(&ld, &q1, &p1, H).0 - by_multipliers).amax(), 4e-16, "momentum form");
    }
}

/// MW 3.5.2: the map stays on T*N, and with Stoermer-Verlet it is RATTLE as published: half kick, drift, position
/// constraint, half kick, velocity constraint (3.5.4).
#[test]
fn mw_3_5_2_rattle_is_the_constrained_map_of_stoermer_verlet() {
    let rods = double_pendulum();
    let parts = rods.system.separable().unwrap();
    let inverse = parts.mass().clone().try_inverse().unwrap();
    let ld = symmetrised(rods.system.clone(), 0.0);
    let (mut q, mut p) = rods.start();
    for _ in 0..100 {
        let step = constrained_map(&ld, rods.system.as_ref(), rods.constraint.as_ref(), &q, &p, H).unwrap();
        let push = |q: &Vector, impulse: &Vector| rods.constraint.jacobian(q).transpose() * impulse;
        let half = &p - parts.potential_gradient(&q) * (0.5 * H) + push(&q, &step.impulses.0);
        let q1 = &q + &inverse * &half * H;
        let p1 = half - parts.potential_gradient(&q1) * (0.5 * H) + push(&q1, &step.impulses.1);
        // measured 6.7e-16
        at_most(distance(&(q1, p1), &(step.q.clone(), step.p.clone())), 2e-15, "RATTLE");
        // measured 1.7e-16
        at_most(rods.constraint.residual(&step.q).amax(), 4e-16, "phi");
        let hidden = rods.constraint.jacobian(&step.q) * rods.system.velocity(&step.q, &step.p).unwrap();
        // measured 2.2e-16
        at_most(hidden.amax(), 5e-16, "G v");
        (q, p) = (step.q, step.p);
    }
}

/// The constrained map is symplectic on T*N: in the angles and their momenta `p . x'(a)`.
#[test]
fn mw_3_4_constrained_maps_are_symplectic_on_the_manifold() {
    let rods = double_pendulum();
    let in_angles = |ld: &dyn DiscreteLagrangian| {
        let (q, p) = rods.start();
        let a = angles(&q);
        let momentum = tangent(&a).transpose() * p;
        symplecticity_defect(&a, &momentum, 5e-3, |a, momentum| {
            // The momentum on T*N belongs to the covector p = M x' w with x'^T M x' w = momentum.
            let (x, slope) = (embed(a), tangent(a));
            let mass = rods.system.separable().unwrap().mass();
            let inner = slope.transpose() * mass * &slope;
            let p = mass * &slope * rattlebench::discrete::solve::solve_linear("chart", &inner, momentum)?;
            let step = constrained_map(ld, rods.system.as_ref(), rods.constraint.as_ref(), &x, &p, H)?;
            let end = angles(&step.q);
            Ok((end.clone(), tangent(&end).transpose() * step.p))
        })
        .unwrap()
    };
    // measured 9.3e-14
    at_most(in_angles(&symmetrised(rods.system.clone(), 0.0)), 3e-13, "RATTLE");
    // measured 9.3e-14
    at_most(in_angles(&alpha(rods.system.clone(), 0.5)), 3e-13, "midpoint");
    // measured 8.0e-14
    at_most(in_angles(&constrained_lobatto(rods.system.clone(), rods.constraint.clone(), 3)), 2e-13, "Lobatto 3");
}

/// MW theorem 3.5.1: on N the map has the order of the discrete Lagrangian restricted to N x N.
#[test]
fn mw_3_5_1_constrained_maps_have_the_order_of_their_discrete_lagrangian() {
    let rods = double_pendulum();
    let constrained = |ld: SharedLagrangian| {
        map_order(&rods.motion(None), &rods.q, &rods.v, |q, p, h| {
            let step = constrained_map(ld.as_ref(), rods.system.as_ref(), rods.constraint.as_ref(), q, p, h)?;
            Ok((step.q, step.p))
        })
        .unwrap()
    };
    let s = || rods.system.clone();
    let on_stages = |s: usize| constrained_lobatto(rods.system.clone(), rods.constraint.clone(), s);
    for (name, ld, theory) in [
        ("symplectic Euler", Arc::new(alpha(s(), 0.0)) as SharedLagrangian, 1.0),
        ("RATTLE", Arc::new(symmetrised(s(), 0.0)), 2.0),
        ("midpoint", Arc::new(alpha(s(), 0.5)), 2.0),
        ("Newmark 1/4", Arc::new(Newmark::new(s(), 0.25).unwrap()), 2.0),
        ("Lobatto 2", Arc::new(on_stages(2)), 2.0),
        ("Lobatto 3", Arc::new(on_stages(3)), 4.0),
        ("Lobatto 4", Arc::new(on_stages(4)), 6.0),
        ("Lobatto 5", Arc::new(on_stages(5)), 8.0),
        ("Galerkin 2", Arc::new(rods.galerkin(2)), 4.0),
        ("Galerkin 3", Arc::new(rods.galerkin(3)), 6.0),
    ] {
        // measured 1.2e-01
        at_most((constrained(ld) - theory).abs(), 0.15, name);
    }
}

/// RATTLE composed by Suzuki's weights has order 4 on T*N, by Yoshida's order 6 (MW 2.5 on N).
#[test]
fn mw_3_5_3_composed_rattle_gains_order() {
    let rods = double_pendulum();
    let ld: SharedLagrangian = Arc::new(symmetrised(rods.system.clone(), 0.0));
    for (parts, theory) in
        [(Composition::suzuki4(ld.clone()).parts, 4.0), (Composition::yoshida6(ld.clone()).parts, 6.0)]
    {
        let weights: Vec<f64> = parts.iter().map(|(weight, _)| *weight).collect();
        let order = map_order(&rods.motion(None), &rods.q, &rods.v, |q, p, h| {
            composed(ld.as_ref(), rods.system.as_ref(), rods.constraint.as_ref(), (q, p), h, &weights)
        });
        // measured 6.6e-03
        at_most((order.unwrap() - theory).abs(), 0.02, theory);
    }
}

/// The energy error of RATTLE stays bounded over 2000 steps; explicit Euler, projected onto N, exceeds it within 60.
#[test]
fn mw_3_5_rattle_keeps_the_energy_and_projected_euler_does_not() {
    let rods = double_pendulum();
    let (q0, p0) = rods.start();
    let energy0 = rods.system.hamiltonian(&q0, &p0).unwrap();
    let worst = |steps: usize, map: &dyn Fn(&Vector, &Vector) -> (Vector, Vector)| {
        let (mut q, mut p) = (q0.clone(), p0.clone());
        (0..steps).fold(0.0f64, |worst, _| {
            (q, p) = map(&q, &p);
            worst.max((rods.system.hamiltonian(&q, &p).unwrap() - energy0).abs())
        })
    };
    let ld = symmetrised(rods.system.clone(), 0.0);
    // measured 1.1e-02
    at_most(worst(2000, &|q, p| rods.step(&ld, q, p, H)), 0.03, "RATTLE");
    let euler = |q: &Vector, p: &Vector| {
        let v = rods.system.velocity(q, p).unwrap();
        let a = rods.motion(None).acceleration(q, &v).unwrap();
        let x = embed(&angles(&(q + &v * H)));
        let free = rods.system.momentum(&x, &(&v + a * H));
        let p = tangent_momentum(rods.system.as_ref(), rods.constraint.as_ref(), &x, &free, v).unwrap().0;
        (x, p)
    };
    // measured 1.3e+00
    at_least(worst(60, &euler), 0.5, "Euler");
}

/// Drag on both particles of the double pendulum, with a coupling.
fn drag() -> LinearDrag {
    let mut coefficient = Matrix::identity(4, 4) * 0.4;
    coefficient[(0, 2)] = 0.2;
    LinearDrag { coefficient }
}

/// MW theorem 3.7.1: forces and constraints together, by multipliers and by restriction to N.
#[test]
fn mw_3_7_1_forced_multipliers_and_forced_restriction_agree() {
    let rods = double_pendulum();
    let force = drag();
    for ld in [alpha(rods.system.clone(), 0.5), symmetrised(rods.system.clone(), 0.0)] {
        let both = WithForce { lagrangian: &ld, force: &force };
        let (q0, p0) = rods.start();
        let (q1, _) = rods.step(&both, &q0, &p0, H);
        let by_multipliers = shake(&both, rods.constraint.as_ref(), &q0, &q1, H).unwrap();
        let (a1, before) = (angles(&q1), both.legendre(&q0, &q1, H).unwrap().p1);
        let guess = angles(&by_multipliers) + Vector::from_vec(vec![1e-3, -2e-3]);
        let a2 = newton("restricted equations", guess, |a2| {
            let at = both.legendre(&q1, &embed(a2), H)?;
            let residual = tangent(&a1).transpose() * (&before - at.p0);
            Ok((residual, -tangent(&a1).transpose() * at.p0_q1 * tangent(a2)))
        });
        // measured 0
        at_most((embed(&a2.unwrap()) - by_multipliers).amax(), 4e-16, "restriction");
    }
}

/// MW theorem 3.7.2: order of forced constrained maps.
#[test]
fn mw_3_7_2_forced_constrained_maps_have_the_order_of_the_method() {
    let rods = double_pendulum();
    let force = drag();
    let on_stages = |s: usize| constrained_lobatto(rods.system.clone(), rods.constraint.clone(), s);
    for (name, ld, theory) in [
        ("symplectic Euler", Arc::new(alpha(rods.system.clone(), 0.0)) as SharedLagrangian, 1.0),
        ("RATTLE", Arc::new(symmetrised(rods.system.clone(), 0.0)), 2.0),
        ("midpoint", Arc::new(alpha(rods.system.clone(), 0.5)), 2.0),
        ("Lobatto 3", Arc::new(on_stages(3)), 4.0),
        ("Lobatto 4", Arc::new(on_stages(4)), 6.0),
        ("Galerkin 2", Arc::new(rods.galerkin(2)), 4.0),
        ("Galerkin 3", Arc::new(rods.galerkin(3)), 6.0),
    ] {
        let both = WithForce { lagrangian: ld.as_ref(), force: &force };
        let order = map_order(&rods.motion(Some(&force)), &rods.q, &rods.v, |q, p, h| {
            let step = constrained_map(&both, rods.system.as_ref(), rods.constraint.as_ref(), q, p, h)?;
            Ok((step.q, step.p))
        });
        // measured 3.2e-02
        at_most((order.unwrap() - theory).abs(), 0.08, name);
    }
}

/// Composition gains order with forces and constraints too: forced RATTLE is its own adjoint.
#[test]
fn mw_3_7_2_composed_forced_rattle_gains_order() {
    let rods = double_pendulum();
    let (ld, force) = (Arc::new(symmetrised(rods.system.clone(), 0.0)), drag());
    let weights: Vec<f64> = Composition::suzuki4(ld.clone()).parts.iter().map(|(weight, _)| *weight).collect();
    let both = WithForce { lagrangian: ld.as_ref(), force: &force };
    let order = map_order(&rods.motion(Some(&force)), &rods.q, &rods.v, |q, p, h| {
        composed(&both, rods.system.as_ref(), rods.constraint.as_ref(), (q, p), h, &weights)
    });
    // measured 2.2e-03
    at_most((order.unwrap() - 4.0).abs(), 0.006, "Suzuki 4");
}

/// MW theorem 3.7.3 (forced Noether on N): the angular momentum of a particle on a sphere changes by the discrete forces'
/// moment in each step, and by nothing else.
#[test]
fn mw_3_7_3_angular_momentum_on_the_sphere_changes_by_the_moment_of_the_forces() {
    let system: SharedSystem = Arc::new(Mechanical { mass: Matrix::identity(3, 3), potential: RadialPolynomial });
    let sphere = Sphere { radius: 1.3 };
    let force = LinearDrag { coefficient: Matrix::from_diagonal(&Vector::from_vec(vec![0.5, 0.5, 0.1])) };
    let turn = |q: &Vector| Vector::from_vec(vec![-q[1], q[0], 0.0]);
    for ld in [alpha(system.clone(), 0.5), gauss(system.clone(), 2)] {
        let both = WithForce { lagrangian: &ld, force: &force };
        let mut q = Vector::from_vec(vec![1.3, 0.0, 0.0]);
        let mut p = Vector::from_vec(vec![0.0, 0.8, 0.5]);
        let (start, mut moments) = (p.dot(&turn(&q)), 0.0);
        for _ in 0..50 {
            let step = constrained_map(&both, system.as_ref(), &sphere, &q, &p, H).unwrap();
            let forces = ld.forced(&force, &q, &step.q, H).unwrap();
            moments += forces.minus.dot(&turn(&q)) + forces.plus.dot(&turn(&step.q));
            (q, p) = (step.q, step.p);
        }
        at_most((p.dot(&turn(&q)) - start - moments).abs(), 1e-14, "balance");
        // measured 9.5e-01
        at_least(moments.abs(), 0.3, "the force has a moment");
    }
}
