//! One step of a linkage is a symplectic map: in independent joint angles `u` and the momenta conjugate to them through
//! the restricted kinetic energy, `A^T Omega A = Omega` for its derivative `A`. With one degree of freedom that is
//! `det A = 1`, the preservation of area.
//!
//! The other joints follow from the loops: `theta(u)` by Newton's method on the residuals of the closures, their rates by
//! `B = d theta / d u`, and `p = B^T M(theta) thetadot`.

mod common;

use common::*;
use nalgebra::{DMatrix, DVector};
use rattlebench::measure::structure::PhaseChart;
use rattlebench::mechanics::{State, System, energy};
use rattlebench::model::Scene;
use rattlebench::variational::Rattle;
use rattlebench::variational::composition::{self, Composition};

/// s
const STEP: f64 = 5e-3;

/// The manifold of a linkage near one state, by its independent joint angles.
struct Linkage<'a> {
    system: &'a System,
    chart: PhaseChart<'a>,
    /// All joint coordinates in the middle.
    centre: DVector<f64>,
    /// Which of them are independent.
    free: Vec<usize>,
    bound: Vec<usize>,
}

impl<'a> Linkage<'a> {
    fn about(system: &'a System, state: &State) -> Linkage<'a> {
        let chart = PhaseChart::about(system, state);
        let centre = chart.coordinates(state);
        let mut linkage = Linkage { system, chart, free: Vec::new(), bound: Vec::new(), centre };
        // The joints whose rates say most: those that elimination with complete pivoting leaves over.
        let mut rest = linkage.rows(&linkage.centre);
        let rank = system.mobility.rank;
        for _ in 0..rank {
            let (row, column) = rest.map(f64::abs).iamax_full();
            linkage.bound.push(column);
            let pivot = rest.row(row) / rest[(row, column)];
            let factors = rest.column(column).into_owned();
            rest -= factors * pivot;
        }
        linkage.free = (0..linkage.centre.len()).filter(|i| !linkage.bound.contains(i)).collect();
        linkage
    }

    fn zero(&self) -> DVector<f64> {
        DVector::zeros(self.centre.len())
    }

    /// What the loops do not allow, m and rad.
    fn residual(&self, theta: &DVector<f64>) -> DVector<f64> {
        let state = self.chart.state(theta, &self.zero());
        DVector::from_vec(self.system.parts.loops.iter().flat_map(|l| l.residual(&state).0).collect())
    }

    /// The derivative of the residuals by the rates of the joints.
    fn rows(&self, theta: &DVector<f64>) -> DMatrix<f64> {
        let columns: Vec<_> = (0..theta.len())
            .map(|i| {
                let mut rate = self.zero();
                rate[i] = 1.0;
                let state = self.chart.state(theta, &rate);
                DVector::from_vec(self.system.parts.loops.iter().flat_map(|l| l.residual(&state).1).collect())
            })
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// All joints at given independent ones.
    fn close(&self, u: &DVector<f64>) -> DVector<f64> {
        let mut theta = self.centre.clone();
        self.free.iter().zip(u.iter()).for_each(|(&i, u)| theta[i] = *u);
        for _ in 0..8 {
            let rows = self.rows(&theta).select_columns(&self.bound);
            let change = rows.svd(true, true).solve(&self.residual(&theta), 1e-9).unwrap();
            self.bound.iter().zip(change.iter()).for_each(|(&i, change)| theta[i] -= change);
        }
        assert!(self.residual(&theta).amax() <= 1e-14, "{:e}", self.residual(&theta).amax());
        theta
    }

    /// `B`: rates of all joints by those of the independent ones.
    fn rates(&self, theta: &DVector<f64>) -> DMatrix<f64> {
        let rows = self.rows(theta);
        let right = rows.select_columns(&self.free);
        let bound = rows.select_columns(&self.bound).svd(true, true).solve(&right, 1e-9).unwrap();
        let mut all = DMatrix::zeros(theta.len(), self.free.len());
        self.bound.iter().enumerate().for_each(|(k, &i)| all.row_mut(i).copy_from(&-bound.row(k)));
        self.free.iter().enumerate().for_each(|(k, &i)| all[(i, k)] = 1.0);
        all
    }

    /// `(u, p)` of a state.
    fn point(&self, state: &State) -> DVector<f64> {
        let theta = self.chart.coordinates(state);
        let p = self.rates(&theta).tr_mul(&self.chart.momenta(&theta, state));
        DVector::from_iterator(2 * p.len(), self.free.iter().map(|&i| theta[i]).chain(p.iter().copied()))
    }

    /// The system at `(u, p)`.
    fn system(&self, y: &DVector<f64>) -> System {
        let d = self.free.len();
        let theta = self.close(&y.rows(0, d).into_owned());
        let b = self.rates(&theta);
        let mass = b.tr_mul(&(self.chart.mass_matrix(&theta) * &b));
        let rate = b * mass.cholesky().unwrap().solve(&y.rows(d, d).into_owned());
        self.chart.system_at(&theta, &rate)
    }
}

/// Largest entry of `A^T Omega A - Omega`, each momentum in units of the momentum of 1 rad/s.
fn defect(system: &System, state: &State, reach: f64, map: &dyn Fn(&System) -> State) -> f64 {
    let here = Linkage::about(system, state);
    let there = Linkage::about(system, &map(&System { initial: state.clone(), ..system.clone() }));
    let d = here.free.len();
    let start = here.point(state);
    let theta = here.chart.coordinates(state);
    let b = here.rates(&theta);
    let mass = b.tr_mul(&(here.chart.mass_matrix(&theta) * &b)).diagonal();
    const WEIGHTS: [(f64, f64); 3] = [(1.0, 3.0 / 4.0), (2.0, -3.0 / 20.0), (3.0, 1.0 / 60.0)];
    let mut a = DMatrix::zeros(2 * d, 2 * d);
    for j in 0..2 * d {
        let unit = if j < d { 1.0 } else { mass[j - d] };
        for (multiple, weight) in WEIGHTS {
            let at = |sign: f64| {
                let mut y = start.clone();
                y[j] += sign * multiple * reach * unit;
                there.point(&map(&here.system(&y)))
            };
            a.column_mut(j).axpy(weight / (reach * unit), &(at(1.0) - at(-1.0)), 1.0);
        }
    }
    let mut omega = DMatrix::zeros(2 * d, 2 * d);
    for i in 0..d {
        (omega[(i, d + i)], omega[(d + i, i)]) = (1.0, -1.0);
    }
    let unit = |i: usize| if i < d { mass[i].sqrt() } else { 1.0 / mass[i - d].sqrt() };
    (a.tr_mul(&(&omega * &a)) - omega).map_with_location(|i, j, x| x / (unit(i) * unit(j))).amax()
}

fn shipped(name: &str) -> System {
    compile(&Scene::load(format!("{}/models/{name}/scene.json", env!("CARGO_MANIFEST_DIR"))).unwrap())
}

fn steps(system: &System, composition: &Composition, h: f64, count: usize) -> State {
    let mut rattle = Rattle::new(system).unwrap();
    for _ in 0..count {
        composition.weights().for_each(|weight| rattle.step(weight * h).unwrap());
    }
    let mut out = system.initial.clone();
    rattle.write_state(&mut out);
    out
}

/// One step that is not symplectic: RATTLE's with all velocities, which stay on the manifold, slowed by `1e-4`.
fn slowed(system: &System) -> State {
    let mut state = steps(system, &composition::ORDER_2, STEP, 1);
    for body in &mut state.bodies {
        body.velocity *= 1.0 - 1e-4;
        body.angular_velocity *= 1.0 - 1e-4;
    }
    state
}

#[test]
fn one_step_of_a_linkage_is_symplectic() {
    // measured at most 6.2e-12 with one degree of freedom, 2.9e-10 with ten
    let cases = [
        ("four_bar", 1, 2e-3, 2e-11),
        ("slider_crank", 1, 2e-3, 2e-11),
        ("bricard", 1, 2e-3, 2e-11),
        ("ladder", 10, 5e-4, 8e-10),
    ];
    for (name, freedoms, reach, bound) in cases {
        let system = shipped(name);
        assert_eq!(system.degrees_of_freedom(), freedoms);
        let state = steps(&system, &composition::ORDER_8, STEP, 60);
        assert!(energy::energy(&system, &state).kinetic > 1e-3 * system.energy_scale, "{name} moves");
        let few = if freedoms > 1 { 1 } else { composition::ALL.len() };
        for composition in &composition::ALL[..few] {
            let found = defect(&system, &state, reach, &|from| steps(from, composition, STEP, 1));
            println!("{name} order {}: {found:e}", composition.order);
            assert!(found <= bound, "{name}: {found:e}");
        }
        // Negative control, measured 1.0e-4 on all.
        let control = defect(&system, &state, reach, &slowed);
        assert!((5e-5..2e-4).contains(&control), "{name}: {control:e}");
    }
}
