//! Rigid bodies as points of a linear space: `q = (x, R)` of every body in R^3 x R^(3x3), held together by constraints
//! alone (Marsden and West 2001, sections 2.1 and 3.5).

use nalgebra::{Isometry3, Matrix3, Matrix3xX, SMatrix, Vector3};
use rattlebench::discrete::constraint::Constraint;
use rattlebench::discrete::{Matrix, Vector};
use rattlebench::mechanics::{Closure, JointKind, State, System};
use rattlebench::model::scene::LoopKind;

/// Coordinates of a body: `x`, then the columns of `R`.
const WIDTH: usize = 12;

/// A vector in space that is an affine function of `q`: `rows q + constant`.
#[derive(Clone)]
struct Affine {
    rows: Matrix3xX<f64>,
    constant: Vector3<f64>,
}

impl Affine {
    fn fixed(width: usize, constant: Vector3<f64>) -> Affine {
        Affine { rows: Matrix3xX::zeros(width), constant }
    }

    fn at(&self, q: &Vector) -> Vector3<f64> {
        &self.rows * q + self.constant
    }

    fn minus(&self, other: &Affine) -> Affine {
        Affine { rows: &self.rows - &other.rows, constant: self.constant - other.constant }
    }
}

/// The constraint `a(q) . b(q) = value`. All of a rigid body and its joints has this form.
#[derive(Clone)]
struct Product {
    a: Affine,
    b: Affine,
    value: f64,
}

/// What a joint holds: whether the joint points coincide, which of `gap . u_k` are zero, and which of `u_j . w_k`.
type Locks = (bool, &'static [usize], &'static [(usize, usize)]);

/// `R^T R = 1` of every body (6 rows each), the joints (6 rows less the degrees of freedom), and the loops, whose rows may
/// repeat what others say.
#[derive(Clone)]
pub struct Rigidity {
    width: usize,
    products: Vec<Product>,
}

impl Rigidity {
    pub fn new(system: &System) -> Rigidity {
        let mut all = Rigidity { width: WIDTH * system.bodies.len(), products: Vec::new() };
        for (i, body) in system.bodies.iter().enumerate() {
            for j in 0..3 {
                for k in j..3 {
                    let [a, b] = [j, k].map(|c| all.direction(Some(i), &Vector3::ith(c, 1.0)));
                    all.add(a, b, if j == k { 1.0 } else { 0.0 });
                }
            }
            let joint = &body.joint;
            all.add_joint([joint.parent, Some(i)], [&joint.in_parent, &joint.in_child], of_joint(joint.kind));
        }
        for Closure { kind, parent, child, in_parent, in_child, .. } in &system.parts.loops {
            all.add_joint([*parent, *child], [in_parent, in_child], of_loop(*kind));
        }
        all
    }

    /// The constraints without those that others imply at `q`: what is left of a row's velocities in the metric of the
    /// masses, once those of all rows before it are taken away, is below `1e-9` of the largest.
    pub fn independent_at(&self, q: &Vector, mass: &Vector) -> Rigidity {
        let mut rows = self.jacobian(q).transpose();
        for mut column in rows.column_iter_mut() {
            column.component_div_assign(&mass.map(f64::sqrt));
            column.normalize_mut();
        }
        let factors = rows.col_piv_qr();
        let r = factors.r();
        let mut order = Matrix::from_fn(1, self.count(), |_, k| k as f64);
        factors.p().permute_columns(&mut order);
        let rank = (0..r.nrows().min(r.ncols())).take_while(|&k| r[(k, k)].abs() > 1e-9).count();
        let products = order.iter().take(rank).map(|&k| self.products[k as usize].clone()).collect();
        Rigidity { width: self.width, products }
    }

    /// `R r` of a body, or `r` where the body is the ground.
    fn direction(&self, body: Option<usize>, r: &Vector3<f64>) -> Affine {
        let Some(body) = body else { return Affine::fixed(self.width, *r) };
        let mut out = Affine::fixed(self.width, Vector3::zeros());
        for column in 0..3 {
            for row in 0..3 {
                out.rows[(row, WIDTH * body + 3 + 3 * column + row)] = r[column];
            }
        }
        out
    }

    /// `x + R r` of a body.
    fn point(&self, body: Option<usize>, r: &Vector3<f64>) -> Affine {
        let mut out = self.direction(body, r);
        if let Some(body) = body {
            for row in 0..3 {
                out.rows[(row, WIDTH * body + row)] = 1.0;
            }
        }
        out
    }

    fn add(&mut self, a: Affine, b: Affine, value: f64) {
        self.products.push(Product { a, b, value });
    }

    /// Holds a frame of the second body to one of the first (`None` is the ground). With `gap` from the first frame's
    /// origin to the second's, `u_k` the axes of the first frame and `w_k` those of the second: `gap_k`, `gap . u_k` and
    /// `u_j . w_k` are zero as the locks say.
    fn add_joint(&mut self, bodies: [Option<usize>; 2], frames: [&Isometry3<f64>; 2], (held, across, turned): Locks) {
        let axes = |all: &Rigidity, k: usize| {
            [0, 1, 2].map(|axis| all.direction(bodies[k], &(frames[k].rotation * Vector3::ith(axis, 1.0))))
        };
        let (u, w) = (axes(self, 0), axes(self, 1));
        let [from, to] = [0, 1].map(|k| self.point(bodies[k], &frames[k].translation.vector));
        let gap = to.minus(&from);
        for k in (0..3).filter(|_| held) {
            self.add(gap.clone(), Affine::fixed(self.width, Vector3::ith(k, 1.0)), 0.0);
        }
        for &k in across {
            self.add(gap.clone(), u[k].clone(), 0.0);
        }
        for &(j, k) in turned {
            self.add(u[j].clone(), w[k].clone(), 0.0);
        }
    }
}

fn of_joint(kind: JointKind) -> Locks {
    match kind {
        JointKind::Revolute => of_loop(LoopKind::Revolute),
        JointKind::Spherical => of_loop(LoopKind::Spherical),
        JointKind::Prismatic => of_loop(LoopKind::Prismatic),
        JointKind::Planar => (false, &[2], &[(0, 2), (1, 2)]),
        JointKind::Floating => (false, &[], &[]),
    }
}

fn of_loop(kind: LoopKind) -> Locks {
    match kind {
        LoopKind::Revolute => (true, &[], &[(0, 2), (1, 2)]),
        LoopKind::Spherical => (true, &[], &[]),
        LoopKind::Prismatic => (false, &[0, 1], &[(0, 1), (0, 2), (1, 2)]),
        LoopKind::Fixed => (true, &[], &[(0, 1), (0, 2), (1, 2)]),
    }
}

impl Constraint for Rigidity {
    fn count(&self) -> usize {
        self.products.len()
    }

    fn residual(&self, q: &Vector) -> Vector {
        Vector::from_iterator(self.count(), self.products.iter().map(|c| c.a.at(q).dot(&c.b.at(q)) - c.value))
    }

    fn jacobian(&self, q: &Vector) -> Matrix {
        let mut all = Matrix::zeros(self.count(), self.width);
        for (k, c) in self.products.iter().enumerate() {
            let row = c.b.rows.tr_mul(&c.a.at(q)) + c.a.rows.tr_mul(&c.b.at(q));
            all.row_mut(k).tr_copy_from(&row);
        }
        all
    }

    fn hessian(&self, _q: &Vector, lambda: &Vector) -> Matrix {
        let mut all = Matrix::zeros(self.width, self.width);
        for (c, &lambda) in self.products.iter().zip(lambda.iter()) {
            let half = c.a.rows.tr_mul(&c.b.rows) * lambda;
            all += half.transpose() + half;
        }
        all
    }
}

/// Diagonal of the mass matrix of `1/2 m |xdot|^2 + 1/2 tr(Rdot Jd Rdot^T)` with `Jd = 1/2 tr(J) 1 - J`.
pub fn mass(system: &System) -> Vector {
    let of_body = |body: &rattlebench::mechanics::Body| {
        let jd = body.inertia.map(|j| 0.5 * body.inertia.sum() - j);
        [[body.mass; 3], [jd.x; 3], [jd.y; 3], [jd.z; 3]].concat()
    };
    Vector::from_vec(system.bodies.iter().flat_map(of_body).collect())
}

/// `-dV/dq` of gravity.
pub fn gravity(system: &System) -> Vector {
    let mut force = Vector::zeros(WIDTH * system.bodies.len());
    for (i, body) in system.bodies.iter().enumerate() {
        force.fixed_rows_mut::<3>(WIDTH * i).copy_from(&(body.mass * system.gravity));
    }
    force
}

/// `(q, v)` of a state: `Rdot = [omega] R` with the angular velocity in world axes.
pub fn embed(state: &State) -> (Vector, Vector) {
    let n = WIDTH * state.bodies.len();
    let (mut q, mut v) = (Vector::zeros(n), Vector::zeros(n));
    for (i, body) in state.bodies.iter().enumerate() {
        let r = body.attitude.to_rotation_matrix().into_inner();
        let columns = |m: &Matrix3<f64>| SMatrix::<f64, 9, 1>::from_column_slice(m.as_slice());
        q.fixed_rows_mut::<3>(WIDTH * i).copy_from(&body.position);
        q.fixed_rows_mut::<9>(WIDTH * i + 3).copy_from(&columns(&r));
        v.fixed_rows_mut::<3>(WIDTH * i).copy_from(&body.velocity);
        v.fixed_rows_mut::<9>(WIDTH * i + 3).copy_from(&columns(&(body.angular_velocity.cross_matrix() * r)));
    }
    (q, v)
}
