//! Constrained Lobatto IIIA-IIIB methods (Jay 1996; Marsden and West 2001, section 3.5.6) with the stages in position and
//! momentum and all multipliers, solved by dense Newton.
//!
//! The paper's space is `q = (x, R)` in R^3 x R^(3x3) of every body, and `R^T R = 1` is a constraint like those of the joints:
//! all hold at every stage, and no chart of the rotation group is used. On trees, because the engine refuses loops with
//! these methods.

use std::cell::RefCell;
use std::ops::Range;

use rattlebench::discrete::constraint::Constraint;
use rattlebench::discrete::{Matrix, Vector};
use rattlebench::variational::{Failure, Lobatto};

use super::dense::Problem;
use super::embedding::{Rigidity, gravity, mass};
use super::{Core, Other, State, System, USUAL};
use super::{difference_from, largest_difference_from, on_random_trees, printed};

/// The coefficients `a` of IIIA and `ahat` of IIIB with the weights `b` that they share.
struct Pair {
    b: Vector,
    a: Matrix,
    ahat: Matrix,
}

/// The ends, and the zeros of the derivative of the Legendre polynomial of degree `s - 1`.
fn nodes(s: usize) -> Vec<f64> {
    let inner: &[f64] = match s {
        2 => &[],
        3 => &[0.0],
        4 => &[-(0.2_f64.sqrt()), 0.2_f64.sqrt()],
        _ => &[-((3.0_f64 / 7.0).sqrt()), 0.0, (3.0_f64 / 7.0).sqrt()],
    };
    let all = [&[-1.0], inner, &[1.0]].concat();
    all.iter().map(|x| 0.5 + 0.5 * x).collect()
}

impl Pair {
    /// The solution of the simplifying conditions, `k = 1 ... s`, as linear equations:
    ///
    /// ```text
    /// sum_j b_j c_j^(k-1) = 1/k ,     sum_j a_ij c_j^(k-1) = c_i^k / k ,     sum_i b_i c_i^(k-1) ahat_ij = b_j (1 - c_j^k) / k
    /// ```
    fn lobatto(s: usize) -> Pair {
        let c = nodes(s);
        let degree = |k: usize| (k as i32, (k + 1) as f64);
        let powers = Matrix::from_fn(s, s, |k, j| c[j].powi(degree(k).0)).lu();
        let solve = |right: Matrix| powers.solve(&right).expect("distinct nodes");
        let b = solve(Matrix::from_fn(s, 1, |k, _| 1.0 / degree(k).1)).column(0).into_owned();
        let a = solve(Matrix::from_fn(s, s, |k, i| c[i].powi(degree(k).0 + 1) / degree(k).1)).transpose();
        let of_column = |k: usize, j: usize| b[j] * (1.0 - c[j].powi(degree(k).0 + 1)) / degree(k).1;
        let mut ahat = solve(Matrix::from_fn(s, s, of_column));
        ahat.row_iter_mut().zip(b.iter()).for_each(|(mut row, b)| row /= *b);
        Pair { b, a, ahat }
    }
}

/// A multiplier that is left out, for negative controls.
#[derive(Clone, Copy, PartialEq)]
enum Without {
    Nothing,
    /// The constraint at the stages between the first and the last, with their multipliers.
    Inner,
    /// The hidden constraint at the end, with the last multiplier.
    Last,
}

/// One step from `phi(q0) = 0`, `G(q0) v0 = 0`; returns `q1` and `v1 = M^-1 p1`.
///
/// ```text
/// Q_i = q0 + h sum_j a_ij M^-1 P_j ,                                     phi(Q_i) = 0 ,     i = 1 ... s
/// P_i = p0 + h sum_j ahat_ij (f(Q_j) + G(Q_j)^T lambda_j)
/// q1  = q0 + h sum_j b_j M^-1 P_j
/// p1  = p0 + h sum_j b_j (f(Q_j) + G(Q_j)^T lambda_j) ,                  G(q1) M^-1 p1 = 0
/// ```
///
/// The first row of `a` is zero, so that `Q_1 = q0` holds the constraint; the last is `b`, so that `Q_s = q1`; the last
/// column of `ahat` is zero, so that `lambda_s` is in `p1` alone, where it is that of the hidden constraint. The unknowns are
/// `V_i = M^-1 P_i`, `i = 1 ... s`, and `h lambda_j`, `j = 1 ... s-1`. As in [`Problem::step`],
/// `phi(Q_i) / h = 1/2 (G(q0) + G(Q_i)) (Q_i - q0) / h`.
fn step<C: Constraint>(
    problem: &Problem<C>,
    Pair { b, a, ahat }: &Pair,
    without: Without,
    (q0, v0): (&Vector, &Vector),
    h: f64,
) -> (Vector, Vector) {
    let (n, m, s) = (q0.len(), problem.constraint.count(), b.len());
    let (of_v, of_lambda) = (|i: usize| n * i, |j: usize| n * s + m * j);
    let all = n * s + m * (s - 1);
    let mut unknown = Vector::zeros(all);
    (0..s).for_each(|i| unknown.rows_mut(of_v(i), n).copy_from(v0));
    let g0 = problem.constraint.jacobian(q0);
    let open = |i: usize| without == Without::Inner && i < s - 1;
    // (Q_i - q0) / h
    let advance = |unknown: &Vector, i: usize| (0..s).map(|l| unknown.rows(of_v(l), n) * a[(i, l)]).sum::<Vector>();
    let mut factors = None;
    let mut last = f64::INFINITY;
    for iteration in 0.. {
        let w: Vec<_> = (0..s).map(|i| advance(&unknown, i)).collect();
        let q: Vec<_> = w.iter().map(|w| q0 + w * h).collect();
        let g: Vec<_> = q.iter().map(|q| problem.constraint.jacobian(q)).collect();
        let lambda: Vec<_> = (0..s - 1).map(|j| unknown.rows(of_lambda(j), m).into_owned()).collect();
        let mut residual = Vector::zeros(all);
        for i in 0..s {
            let mut row = problem.mass.component_mul(&(unknown.rows(of_v(i), n) - v0));
            for j in 0..s {
                row -= &problem.force * (h * ahat[(i, j)]);
            }
            for j in 0..s - 1 {
                row -= g[j].tr_mul(&lambda[j]) * ahat[(i, j)];
            }
            residual.rows_mut(of_v(i), n).copy_from(&row);
        }
        for i in 1..s {
            let row = if open(i) { lambda[i].clone() } else { (&g0 + &g[i]) * &w[i] * 0.5 };
            residual.rows_mut(of_lambda(i - 1), m).copy_from(&row);
        }
        let derivative = || {
            let mut matrix = Matrix::zeros(all, all);
            let bend: Vec<_> = (0..s - 1).map(|j| problem.constraint.hessian(&q[j], &lambda[j]) * h).collect();
            for i in 0..s {
                for l in 0..s {
                    let mut block = if i == l { Matrix::from_diagonal(&problem.mass) } else { Matrix::zeros(n, n) };
                    for j in 0..s - 1 {
                        block -= &bend[j] * (ahat[(i, j)] * a[(j, l)]);
                    }
                    matrix.view_mut((of_v(i), of_v(l)), (n, n)).copy_from(&block);
                }
                for j in 0..s - 1 {
                    matrix.view_mut((of_v(i), of_lambda(j)), (n, m)).copy_from(&(g[j].transpose() * -ahat[(i, j)]));
                }
            }
            for i in 1..s {
                let at = of_lambda(i - 1);
                if open(i) {
                    matrix.view_mut((at, of_lambda(i)), (m, m)).fill_with_identity();
                    continue;
                }
                for l in 0..s {
                    matrix.view_mut((at, of_v(l)), (m, n)).copy_from(&(&g[i] * a[(i, l)]));
                }
            }
            matrix.lu()
        };
        let update = factors.get_or_insert_with(derivative).solve(&residual).expect("independent constraints");
        unknown -= &update;
        let size = update.rows(0, n * s).amax();
        if size <= 1e-12 * unknown.rows(0, n * s).amax() && size >= 0.5 * last || size == 0.0 {
            break;
        }
        assert!(iteration < 30, "Newton's method stops at {size:e}");
        // The factors serve as long as they gain two digits a round.
        if size > 0.01 * last {
            factors = None;
        }
        last = size;
    }
    let q1 = q0 + advance(&unknown, s - 1) * h;
    let mut p1 = problem.mass.component_mul(v0) + &problem.force * (h * b.sum());
    for j in 0..s - 1 {
        let g = problem.constraint.jacobian(&(q0 + advance(&unknown, j) * h));
        p1 += g.tr_mul(&unknown.rows(of_lambda(j), m)) * b[j];
    }
    let v1 = if without == Without::Last { p1.component_div(&problem.mass) } else { problem.project(&q1, &p1) };
    (q1, v1)
}

/// The dense solve with a pair.
fn dense(system: &System, pair: Pair, without: Without) -> Other<'static> {
    let problem = Problem { mass: mass(system), force: gravity(system), constraint: Rigidity::new(system) };
    Box::new(move |q, v, h| step(&problem, &pair, without, (q, v), h))
}

impl Core for Lobatto {
    fn step(&mut self, h: f64) -> Result<(), Failure> {
        self.step(h)
    }

    fn write_state(&self, out: &mut State) {
        self.write_state(out);
    }
}

fn core(stages: usize) -> impl Fn(&System) -> Lobatto {
    move |system| Lobatto::new(system, stages).unwrap()
}

/// Compares steps on random trees, as many as the dense solve, which grows with the cube of the stages, has time for.
fn solves_the_printed_equations(stages: usize, cases: u32, exponents: Range<f64>, bound: f64) {
    let other = |system: &System| dense(system, Pair::lobatto(stages), Without::Nothing);
    let worst = largest_difference_from(core(stages), cases, exponents, other);
    println!("{stages} stages: {worst:?}");
    assert!(worst.within(bound), "{stages} stages: {worst:?}");
}

#[test]
fn one_step_of_two_stages_solves_the_printed_equations() {
    // measured 5.4e-15 and 1.1e-13, by the projection of the momenta that RATTLE has, too
    solves_the_printed_equations(2, 128, USUAL, 3e-13);
}

#[test]
fn one_step_of_three_stages_solves_them() {
    // measured 2.5e-15 and 2.4e-14
    solves_the_printed_equations(3, 64, USUAL, 6e-14);
}

#[test]
fn one_step_of_four_stages_solves_them() {
    // measured 1.4e-15 and 3.8e-15
    solves_the_printed_equations(4, 32, USUAL, 1e-14);
}

#[test]
fn one_step_of_five_stages_solves_them() {
    // measured 1.4e-15 and 4.2e-15
    solves_the_printed_equations(5, 24, USUAL, 1e-14);
}

#[test]
fn steps_of_a_microsecond_solve_them_as_well() {
    for stages in [3, 4] {
        // measured 1.2e-15 and 6.0e-15
        solves_the_printed_equations(stages, 32, -6.0..-5.0, 1.5e-14);
    }
}

#[test]
fn one_step_of_two_stages_solves_the_equations_of_rattle() {
    let worst = largest_difference_from(core(2), 128, USUAL, printed);
    println!("{worst:?}");
    // measured 5.4e-15 and 1.1e-13
    assert!(worst.within(3e-13), "{worst:?}");
}

/// Negative controls: one of the coefficients off by 1e-4, no constraint at the stages between the first and the last, no
/// hidden constraint at the end.
#[test]
fn another_coefficient_or_a_multiplier_less_does_not_agree() {
    for stages in 2..=4 {
        let seen = RefCell::new([(0, f64::INFINITY); 3]);
        on_random_trees(24, USUAL, |system, h| {
            let mut changed = Pair::lobatto(stages);
            changed.ahat[(1, 0)] += 1e-4;
            let others = [
                dense(system, changed, Without::Nothing),
                dense(system, Pair::lobatto(stages), Without::Inner),
                dense(system, Pair::lobatto(stages), Without::Last),
            ];
            for (seen, other) in seen.borrow_mut().iter_mut().zip(&others) {
                let found = difference_from(core(stages)(system), system, h, other);
                if !found.within(1e-11) {
                    *seen = (seen.0 + 1, seen.1.min(found.position.max(found.momentum)));
                }
            }
        });
        let [coefficient, inner, last] = seen.into_inner();
        println!("{stages} stages: {coefficient:?} {inner:?} {last:?}");
        // measured 24 of 24, and 2.0e-10 and more
        assert!(coefficient.0 == 24 && coefficient.1 >= 7e-11, "{stages} stages: {coefficient:?}");
        // measured 23 of 24, and 2.2e-9 and more; two stages have none between
        let expected = if stages == 2 { 0..1 } else { 22..25 };
        assert!(expected.contains(&inner.0) && inner.1 >= 7e-10, "{stages} stages: {inner:?}");
        // measured 24 of 24, and 8.0e-5 and more
        assert!(last.0 == 24 && last.1 >= 2e-5, "{stages} stages: {last:?}");
    }
}

/// `sum b c^(k-1) = 1/k` to order `2 s - 2` and not beyond, the structure on which the step relies, symplecticity, and the
/// tables of three and four stages as they are printed (Hairer, Lubich and Wanner 2006, section II.1.4).
#[test]
fn the_coefficients_are_those_of_the_tables() {
    let mut worst = 0.0_f64;
    let mut compare = |found: f64, expected: f64| worst = worst.max((found - expected).abs());
    for s in 2..=5 {
        let (c, Pair { b, a, ahat }) = (nodes(s), Pair::lobatto(s));
        let moment = |k: usize| (0..s).map(|i| b[i] * c[i].powi(k as i32 - 1)).sum::<f64>();
        (1..=2 * s - 2).for_each(|k| compare(moment(k), 1.0 / k as f64));
        let next = 2 * s - 1;
        // 2.8e-5 with five stages, where it is least
        assert!((moment(next) - 1.0 / next as f64).abs() > 1e-5, "{s}");
        for i in 0..s {
            compare(a[(0, i)], 0.0);
            compare(a[(s - 1, i)], b[i]);
            compare(ahat[(i, s - 1)], 0.0);
            compare(ahat[(i, 0)], b[0]);
            (0..s).for_each(|j| compare(b[i] * ahat[(i, j)] + b[j] * a[(j, i)], b[i] * b[j]));
        }
    }
    let r = 5.0_f64.sqrt();
    let tables = [
        Matrix::from_row_slice(3, 3, &[0.0, 0.0, 0.0, 5.0, 8.0, -1.0, 4.0, 16.0, 4.0]) / 24.0,
        Matrix::from_row_slice(3, 3, &[1.0, -1.0, 0.0, 1.0, 2.0, 0.0, 1.0, 5.0, 0.0]) / 6.0,
        Matrix::from_row_slice(
            4,
            4,
            &[
                [0.0, 0.0, 0.0, 0.0],
                [11.0 + r, 25.0 - r, 25.0 - 13.0 * r, -1.0 + r],
                [11.0 - r, 25.0 + 13.0 * r, 25.0 + r, -1.0 - r],
                [10.0, 50.0, 50.0, 10.0],
            ]
            .concat(),
        ) / 120.0,
        Matrix::from_row_slice(
            4,
            4,
            &[
                [10.0, -5.0 - 5.0 * r, -5.0 + 5.0 * r, 0.0],
                [10.0, 25.0 + r, 25.0 - 13.0 * r, 0.0],
                [10.0, 25.0 + 13.0 * r, 25.0 - r, 0.0],
                [10.0, 55.0 - 5.0 * r, 55.0 + 5.0 * r, 0.0],
            ]
            .concat(),
        ) / 120.0,
    ];
    let (three, four) = (Pair::lobatto(3), Pair::lobatto(4));
    for (found, table) in [three.a, three.ahat, four.a, four.ahat].iter().zip(&tables) {
        compare((found - table).amax(), 0.0);
    }
    println!("{worst:e}");
    // measured 3.5e-15
    assert!(worst <= 1e-14, "{worst:e}");
}
