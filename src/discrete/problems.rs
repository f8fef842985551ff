//! Systems that the theory is tested on. None is linear: linear oscillators superconverge and hide errors.

use std::sync::Arc;

use super::system::{Gradient, Hessian, LagrangianSystem, Mechanical, Potential, SharedSystem};
use super::{Matrix, Vector};

/// A system with a start from which it moves through its nonlinear range in about one unit of time.
#[derive(Clone)]
pub struct Problem {
    pub name: &'static str,
    pub system: SharedSystem,
    pub q: Vector,
    pub v: Vector,
}

/// Two coordinates that a mass matrix with off-diagonal terms and a potential couple.
pub fn coupled_wells() -> Problem {
    let mass = Matrix::from_row_slice(2, 2, &[1.0, 0.3, 0.3, 0.7]);
    Problem {
        name: "coupled wells",
        system: Arc::new(Mechanical { mass, potential: CoupledWells }),
        q: Vector::from_vec(vec![0.4, -0.3]),
        v: Vector::from_vec(vec![0.7, 0.9]),
    }
}

/// Double pendulum in its two angles: the mass matrix depends on the position.
pub fn double_pendulum() -> Problem {
    Problem {
        name: "double pendulum",
        system: Arc::new(DoublePendulum { masses: [1.0, 0.6], lengths: [1.0, 0.8], gravity: 1.0 }),
        q: Vector::from_vec(vec![0.6, -0.5]),
        v: Vector::from_vec(vec![0.5, 0.9]),
    }
}

/// The particle of the figures of Marsden and West: `L = 1/2 |v|^2 - |q|^2 (|q|^2 - 1)^2` in the plane. Where it starts
/// is our choice.
pub fn radial_particle() -> Problem {
    Problem {
        name: "radial particle",
        system: Arc::new(Mechanical { mass: Matrix::identity(2, 2), potential: RadialPolynomial }),
        q: Vector::from_vec(vec![0.9, 0.0]),
        v: Vector::from_vec(vec![0.2, 0.8]),
    }
}

/// A particle in a convex round well, in the plane.
pub fn bowl() -> Problem {
    Problem {
        name: "bowl",
        system: Arc::new(Mechanical { mass: Matrix::identity(2, 2), potential: Bowl }),
        q: Vector::from_vec(vec![0.9, 0.0]),
        v: Vector::from_vec(vec![0.2, 0.8]),
    }
}

/// `V = 1/2 |q|^2 + 1/4 |q|^4`
#[derive(Clone, Debug)]
pub struct Bowl;

impl Potential for Bowl {
    fn value(&self, q: &Vector) -> f64 {
        let r = q.norm_squared();
        0.5 * r + 0.25 * r * r
    }

    fn gradient(&self, q: &Vector) -> Vector {
        q * (1.0 + q.norm_squared())
    }

    fn hessian(&self, q: &Vector) -> Matrix {
        Matrix::identity(q.len(), q.len()) * (1.0 + q.norm_squared()) + q * q.transpose() * 2.0
    }
}

/// `V = 1/2 x^2 + 1/4 (x^2 + y^2)^2 + 1/2 x^2 y + sin(x y)`, bounded below.
#[derive(Clone, Debug)]
pub struct CoupledWells;

impl Potential for CoupledWells {
    fn value(&self, q: &Vector) -> f64 {
        let (x, y, r) = (q[0], q[1], q.norm_squared());
        0.5 * x * x + 0.25 * r * r + 0.5 * x * x * y + (x * y).sin()
    }

    fn gradient(&self, q: &Vector) -> Vector {
        let (x, y, r) = (q[0], q[1], q.norm_squared());
        let c = (x * y).cos();
        Vector::from_vec(vec![x + r * x + x * y + y * c, r * y + 0.5 * x * x + x * c])
    }

    fn hessian(&self, q: &Vector) -> Matrix {
        let (x, y, r) = (q[0], q[1], q.norm_squared());
        let (s, c) = (x * y).sin_cos();
        let mixed = 2.0 * x * y + x + c - x * y * s;
        Matrix::from_row_slice(
            2,
            2,
            &[1.0 + r + 2.0 * x * x + y - y * y * s, mixed, mixed, r + 2.0 * y * y - x * x * s],
        )
    }
}

/// `V = |q|^2 (|q|^2 - 1)^2`
#[derive(Clone, Debug)]
pub struct RadialPolynomial;

impl RadialPolynomial {
    /// `W(r)`, `W'` and `W''` for `V = W(|q|^2)`.
    fn of_square(r: f64) -> (f64, f64, f64) {
        (r * (r - 1.0).powi(2), (r - 1.0) * (3.0 * r - 1.0), 6.0 * r - 4.0)
    }
}

impl Potential for RadialPolynomial {
    fn value(&self, q: &Vector) -> f64 {
        Self::of_square(q.norm_squared()).0
    }

    fn gradient(&self, q: &Vector) -> Vector {
        q * (2.0 * Self::of_square(q.norm_squared()).1)
    }

    fn hessian(&self, q: &Vector) -> Matrix {
        let (_, first, second) = Self::of_square(q.norm_squared());
        Matrix::identity(q.len(), q.len()) * (2.0 * first) + q * q.transpose() * (4.0 * second)
    }
}

/// `V = 1/2 k |q|^2`
#[derive(Clone, Debug)]
pub struct Spring {
    pub stiffness: f64,
}

impl Potential for Spring {
    fn value(&self, q: &Vector) -> f64 {
        0.5 * self.stiffness * q.norm_squared()
    }

    fn gradient(&self, q: &Vector) -> Vector {
        q * self.stiffness
    }

    fn hessian(&self, q: &Vector) -> Matrix {
        Matrix::identity(q.len(), q.len()) * self.stiffness
    }
}

/// `V = w . q`: a uniform field.
#[derive(Clone, Debug)]
pub struct Uniform {
    pub weight: Vector,
}

impl Potential for Uniform {
    fn value(&self, q: &Vector) -> f64 {
        self.weight.dot(q)
    }

    fn gradient(&self, _q: &Vector) -> Vector {
        self.weight.clone()
    }

    fn hessian(&self, q: &Vector) -> Matrix {
        Matrix::zeros(q.len(), q.len())
    }
}

/// Plane double pendulum of point masses, angles from the downward vertical:
///
/// ```text
/// L = 1/2 (m1 + m2) l1^2 u^2 + 1/2 m2 l2^2 w^2 + m2 l1 l2 u w cos(a - b) + (m1 + m2) g l1 cos a + m2 g l2 cos b
/// ```
#[derive(Clone, Debug)]
pub struct DoublePendulum {
    /// kg
    pub masses: [f64; 2],
    /// m
    pub lengths: [f64; 2],
    /// m/s^2
    pub gravity: f64,
}

impl DoublePendulum {
    /// `((m1 + m2) l1^2, m2 l2^2, m2 l1 l2, (m1 + m2) g l1, m2 g l2)`
    fn coefficients(&self) -> [f64; 5] {
        let ([m1, m2], [l1, l2], g) = (self.masses, self.lengths, self.gravity);
        [(m1 + m2) * l1 * l1, m2 * l2 * l2, m2 * l1 * l2, (m1 + m2) * g * l1, m2 * g * l2]
    }
}

impl LagrangianSystem for DoublePendulum {
    fn dim(&self) -> usize {
        2
    }

    fn lagrangian(&self, q: &Vector, v: &Vector) -> f64 {
        let [i1, i2, k, w1, w2] = self.coefficients();
        let (u, w) = (v[0], v[1]);
        0.5 * i1 * u * u + 0.5 * i2 * w * w + k * u * w * (q[0] - q[1]).cos() + w1 * q[0].cos() + w2 * q[1].cos()
    }

    fn gradient(&self, q: &Vector, v: &Vector) -> Gradient {
        let [i1, i2, k, w1, w2] = self.coefficients();
        let (u, w) = (v[0], v[1]);
        let (s, c) = (q[0] - q[1]).sin_cos();
        Gradient {
            q: Vector::from_vec(vec![-k * u * w * s - w1 * q[0].sin(), k * u * w * s - w2 * q[1].sin()]),
            v: Vector::from_vec(vec![i1 * u + k * w * c, i2 * w + k * u * c]),
        }
    }

    fn hessian(&self, q: &Vector, v: &Vector) -> Hessian {
        let [i1, i2, k, w1, w2] = self.coefficients();
        let (u, w) = (v[0], v[1]);
        let (s, c) = (q[0] - q[1]).sin_cos();
        let bend = k * u * w * c;
        Hessian {
            qq: Matrix::from_row_slice(2, 2, &[-bend - w1 * q[0].cos(), bend, bend, -bend - w2 * q[1].cos()]),
            qv: Matrix::from_row_slice(2, 2, &[-k * w * s, -k * u * s, k * w * s, k * u * s]),
            vv: Matrix::from_row_slice(2, 2, &[i1, k * c, k * c, i2]),
        }
    }
}
