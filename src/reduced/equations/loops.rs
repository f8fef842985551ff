//! Loops and mimic couplings as constraints on the joint coordinates of the tree: `phi(q) = 0`.
//!
//! With the joint frames of a loop at `x_P` and `x_C`, axes `R_P` and `R_C`, the *locked* ones of these rows are zero:
//!
//! ```text
//! d = R_P^T (x_C - x_P) ,      Q_ab = e_a . R_P^T R_C e_b ,      ddot = R_P^T u ,   Qdot_ab = w . (Q e_b x e_a) ,
//! u = v_C - v_P - omega_P x (x_C - x_P) ,   w = R_P^T (omega_C - omega_P) ,
//! ```
//!
//! so that `J v` is exactly the rate of `phi`. What holds them, `J^T lambda`, is the least that does (Gauss's
//! principle): with the Cholesky factor `L` of the mass matrix, a change `x` of velocities, accelerations or positions
//! such that `J x = r` and `x . H x` is least is
//!
//! ```text
//! x = L^-T G^+ r ,   G = J L^-T ,                                                                         (1)
//! ```
//!
//! with the pseudo-inverse by singular values. Redundant rows are the rule: `G^+` keeps as many singular values as the
//! rows have rank where the system starts, the largest ones. Off the manifold, where the stages of an explicit method
//! are, the rows of an overconstrained linkage contradict each other, and its rank would be higher.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Vector3};

use crate::mechanics::{Coupling, RANK};
use crate::reduced::closure::Closure;
use crate::reduced::model::Model;

/// Sweeps of rotations over all pairs of columns, at most; they converge quadratically, in 3 to 10 on the shipped
/// linkages.
const SWEEPS: usize = 40;

/// A frame in world axes: where it is, how it moves, and its accelerations at constant joint velocities.
#[derive(Clone, Copy, Debug)]
struct Frame {
    r: Matrix3<f64>,
    x: Vector3<f64>,
    v: Vector3<f64>,
    omega: Vector3<f64>,
    a: Vector3<f64>,
    alpha: Vector3<f64>,
}

impl Frame {
    fn ground() -> Frame {
        let zero = Vector3::zeros();
        Frame { r: Matrix3::identity(), x: zero, v: zero, omega: zero, a: zero, alpha: zero }
    }

    /// A frame fixed in this one.
    fn fixed(&self, pose: &Isometry3<f64>) -> Frame {
        let arm = self.r * pose.translation.vector;
        let swept = self.omega.cross(&arm);
        Frame {
            r: self.r * pose.rotation.to_rotation_matrix().into_inner(),
            x: self.x + arm,
            v: self.v + swept,
            omega: self.omega,
            a: self.a + self.alpha.cross(&arm) + self.omega.cross(&swept),
            alpha: self.alpha,
        }
    }

    /// The link frame of link `i`, whose parent's is this one.
    fn link(&self, model: &Model, i: usize, q: &[f64], v: &[f64]) -> Frame {
        let pose = model.links[i].in_parent * model.transform(i, q);
        let arm = self.r * pose.translation.vector;
        let r = self.r * pose.rotation.to_rotation_matrix().into_inner();
        let (linear, angular) = model.relative_twist(i, v);
        let (linear, angular) = (r * linear, r * angular);
        let moved = self.omega.cross(&arm) + linear;
        let omega = self.omega + angular;
        Frame {
            r,
            x: self.x + arm,
            v: self.v + moved,
            omega,
            a: self.a + self.alpha.cross(&arm) + self.omega.cross(&moved) + omega.cross(&linear),
            alpha: self.alpha + self.omega.cross(&angular),
        }
    }
}

/// The constraints at one place, with room for their evaluation.
#[derive(Clone, Debug)]
pub(super) struct Loops {
    closures: Vec<Closure>,
    couplings: Vec<Coupling>,
    /// For each closure the links that move its child (1), its parent (-1), both or neither (0).
    moved_by: Vec<Vec<f64>>,
    rank: usize,
    frames: Vec<Frame>,
    /// `phi`, m or rad.
    pub open: DVector<f64>,
    /// `J`
    jacobian: DMatrix<f64>,
    /// `d(J v)/dt` at constant `v`.
    bias: DVector<f64>,
}

impl Loops {
    /// `None` where there are no loops and no couplings.
    pub(super) fn new(model: &Model) -> Option<Loops> {
        let rows = model.closures.iter().map(Closure::rows).sum::<usize>() + model.couplings.len();
        let moved_by = model.closures.iter().map(|closure| {
            let mut moved = vec![0.0; model.links.len()];
            for (end, sign) in [(closure.child, 1.0), (closure.parent, -1.0)] {
                let mut at = end;
                while let Some(i) = at {
                    moved[i] += sign;
                    at = model.links[i].parent;
                }
            }
            moved
        });
        (rows > 0).then(|| Loops {
            moved_by: moved_by.collect(),
            closures: model.closures.clone(),
            couplings: model.couplings.clone(),
            rank: model.rank,
            frames: vec![Frame::ground(); model.links.len()],
            open: DVector::zeros(rows),
            jacobian: DMatrix::zeros(rows, model.velocities),
            bias: DVector::zeros(rows),
        })
    }

    pub(super) fn evaluate(&mut self, model: &Model, q: &[f64], v: &[f64]) {
        for (i, link) in model.links.iter().enumerate() {
            let parent = link.parent.map_or_else(Frame::ground, |p| self.frames[p]);
            self.frames[i] = parent.link(model, i, q, v);
        }
        self.jacobian.fill(0.0);
        let mut row = 0;
        for k in 0..self.closures.len() {
            self.close(model, k, row);
            row += self.closures[k].rows();
        }
        for coupling in &self.couplings {
            let (follower, source) = (&model.links[coupling.follower], &model.links[coupling.source]);
            self.open[row] = q[follower.position] - coupling.multiplier * q[source.position] - coupling.offset;
            self.jacobian[(row, follower.velocity)] += 1.0;
            self.jacobian[(row, source.velocity)] -= coupling.multiplier;
            row += 1;
        }
    }

    /// The rows of one closure, from `first` on.
    fn close(&mut self, model: &Model, k: usize, first: usize) {
        let closure = &self.closures[k];
        let frame = |link: Option<usize>| link.map_or_else(Frame::ground, |i| self.frames[i]);
        let (p, c) = (frame(closure.parent).fixed(&closure.in_parent), frame(closure.child).fixed(&closure.in_child));
        let (span, turning) = (c.x - p.x, c.omega - p.omega);
        let u = c.v - p.v - p.omega.cross(&span);
        let carried = p.alpha.cross(&span) + p.omega.cross(&(p.omega.cross(&span) + 2.0 * u));
        let (d, d_bias) = (p.r.tr_mul(&span), p.r.tr_mul(&(c.a - p.a - carried)));
        let (q, w) = (p.r.tr_mul(&c.r), p.r.tr_mul(&turning));
        let w_bias = p.r.tr_mul(&(c.alpha - p.alpha - p.omega.cross(&turning)));
        // Q e_b x e_a, about which a turn changes Q_ab
        let about = |(a, b): (usize, usize)| q.column(b).cross(&Vector3::ith(a, 1.0));
        let (lengths, turns) = closure.locked();
        for (n, &axis) in lengths.iter().enumerate() {
            (self.open[first + n], self.bias[first + n]) = (d[axis], d_bias[axis]);
        }
        let after = first + lengths.len();
        for (n, &(a, b)) in turns.iter().enumerate() {
            let swung = w.cross(&q.column(b)).cross(&Vector3::ith(a, 1.0));
            (self.open[after + n], self.bias[after + n]) = (q[(a, b)], w_bias.dot(&about((a, b))) + w.dot(&swung));
        }
        for ((link, at), sign) in model.links.iter().zip(&self.frames).zip(&self.moved_by[k]) {
            if *sign == 0.0 {
                continue;
            }
            let free = link.kind.free();
            for (slot, direction) in (0..6).filter(|&slot| free[slot]).enumerate() {
                let (axis, column) = (at.r.column(direction % 3).into_owned() * *sign, link.velocity + slot);
                let linear = if direction < 3 { axis } else { axis.cross(&(c.x - at.x)) };
                let (linear, angular) = (p.r.tr_mul(&linear), p.r.tr_mul(&axis));
                for (n, &along) in lengths.iter().enumerate() {
                    self.jacobian[(first + n, column)] = linear[along];
                }
                for (n, &pair) in turns.iter().enumerate().filter(|_| direction >= 3) {
                    self.jacobian[(after + n, column)] = about(pair).dot(&angular);
                }
            }
        }
    }

    /// What `J a` has to be, less what it is: `-d(J v)/dt - J a`.
    pub(super) fn acceleration_gap(&self, a: &DVector<f64>) -> DVector<f64> {
        -&self.bias - &self.jacobian * a
    }

    /// `-J v`
    pub(super) fn velocity_gap(&self, v: &[f64]) -> DVector<f64> {
        -(&self.jacobian * DVector::from_row_slice(v))
    }

    /// (1) with the lower triangle `l` of the mass matrix's factor. `None` where the rows lose rank or are not numbers.
    pub(super) fn least(&self, l: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
        let mut transposed = self.jacobian.transpose();
        l.solve_lower_triangular_mut(&mut transposed).then_some(())?;
        if !transposed.iter().chain(right).all(|x| x.is_finite()) {
            return None;
        }
        let mut x = pseudo_inverse(transposed.transpose(), self.rank, right)?;
        l.tr_solve_lower_triangular_mut(&mut x).then_some(x)
    }

    /// The closure or coupling that is farthest open, by name, and by how much, m or rad.
    pub(super) fn widest(&self) -> (String, f64) {
        let named = self
            .closures
            .iter()
            .flat_map(|closure| std::iter::repeat_n(format!("loop '{}'", closure.name), closure.rows()));
        let all = named.chain(self.couplings.iter().map(|_| "a mimic joint".to_string())).zip(&self.open);
        all.fold(
            (String::new(), 0.0),
            |widest, (name, open)| {
                if open.abs() <= widest.1 { widest } else { (name, open.abs()) }
            },
        )
    }
}

/// `a^+ b` with the `rank` largest singular values of `a`, by one-sided Jacobi rotations (Hestenes 1958):
/// `a V = U Sigma` with orthogonal columns. It finds the directions to roundoff however deficient the rank is, where
/// methods by bidiagonal forms leave noise that an error estimate near roundoff would take for the motion.
fn pseudo_inverse(mut a: DMatrix<f64>, rank: usize, b: &DVector<f64>) -> Option<DVector<f64>> {
    let n = a.ncols();
    let mut v = DMatrix::identity(n, n);
    let zero = f64::EPSILON * a.norm();
    for _ in 0..SWEEPS {
        let mut turned = false;
        for i in 0..n {
            for j in i + 1..n {
                let (alpha, beta, gamma) =
                    (a.column(i).norm_squared(), a.column(j).norm_squared(), a.column(i).dot(&a.column(j)));
                if gamma.abs() <= f64::EPSILON * (alpha * beta).sqrt() || alpha.min(beta).sqrt() <= zero {
                    continue;
                }
                turned = true;
                let zeta = (beta - alpha) / (2.0 * gamma);
                let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
                let cosine = 1.0 / tangent.hypot(1.0);
                for matrix in [&mut a, &mut v] {
                    for row in 0..matrix.nrows() {
                        let (x, y) = (matrix[(row, i)], matrix[(row, j)]);
                        matrix[(row, i)] = cosine * (x - tangent * y);
                        matrix[(row, j)] = cosine * (tangent * x + y);
                    }
                }
            }
        }
        if !turned {
            break;
        }
    }
    let sigma: Vec<f64> = a.column_iter().map(|column| column.norm()).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| sigma[j].total_cmp(&sigma[i]));
    let mut x = DVector::zeros(n);
    for &k in order.iter().take(rank) {
        // Below it the linkage is where its path may fork.
        (sigma[k] > RANK * sigma[order[0]]).then_some(())?;
        x.axpy(a.column(k).dot(b) / (sigma[k] * sigma[k]), &v.column(k), 1.0);
    }
    Some(x)
}
