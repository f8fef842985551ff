//! Time-dependent mechanics, with time as one more coordinate (MW part 4).
//!
//! A Lagrangian `L(t, q, v)` becomes one on R^(n+1) of the points `x = (t, q)` along a curve with any parameter,
//!
//! ```text
//! L~(x, x') = t' L(t, q, q'/t')                                                               (MW 4.2)
//! ```
//!
//! and a discrete Lagrangian for `L~` with parameter step 1 is an extended discrete Lagrangian `L_d(t0, q0, t1, q1)`.
//! The momentum of `t` is minus the energy, so the discrete Legendre transforms hold the discrete energies
//!
//! ```text
//! E0 = D_t0 L_d(t0, q0, t1, q1),     E1 = -D_t1 L_d(t0, q0, t1, q1)                             (MW 4.5)
//! ```
//!
//! and the discrete Euler-Lagrange equations in all n+1 coordinates solve for the step as well (MW 4.9.1). Where `L`
//! does not depend on time such a method conserves its discrete energy, the momentum maps of its symmetries and the
//! symplectic form: a symplectic-energy-momentum integrator.
//!
//! `L~` is homogeneous of degree one in `x'`: only methods without internal points apply.

use super::lagrangian::DiscreteLegendre;
use super::maps::hamiltonian_map_from;
use super::solve::{SolveError, newton};
use super::structure::join;
use super::system::{Gradient, Hessian, LagrangianSystem, SharedSystem};
use super::{Matrix, Vector};

/// Derivatives of a Lagrangian by time.
#[derive(Clone, Debug)]
pub struct TimeDerivatives {
    pub t: f64,
    pub tt: f64,
    /// `d2L / dt dq`
    pub tq: Vector,
    /// `d2L / dt dv`
    pub tv: Vector,
}

/// A Lagrangian `L(t, q, v)`.
pub trait TimeDependent: Send + Sync {
    /// n
    fn dim(&self) -> usize;
    fn lagrangian(&self, t: f64, q: &Vector, v: &Vector) -> f64;
    fn gradient(&self, t: f64, q: &Vector, v: &Vector) -> Gradient;
    fn hessian(&self, t: f64, q: &Vector, v: &Vector) -> Hessian;
    fn by_time(&self, t: f64, q: &Vector, v: &Vector) -> TimeDerivatives;

    /// `E = dL/dv . v - L`
    fn energy(&self, t: f64, q: &Vector, v: &Vector) -> f64 {
        self.gradient(t, q, v).v.dot(v) - self.lagrangian(t, q, v)
    }
}

/// A Lagrangian that does not depend on time.
pub struct Autonomous(pub SharedSystem);

impl TimeDependent for Autonomous {
    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn lagrangian(&self, _t: f64, q: &Vector, v: &Vector) -> f64 {
        self.0.lagrangian(q, v)
    }

    fn gradient(&self, _t: f64, q: &Vector, v: &Vector) -> Gradient {
        self.0.gradient(q, v)
    }

    fn hessian(&self, _t: f64, q: &Vector, v: &Vector) -> Hessian {
        self.0.hessian(q, v)
    }

    fn by_time(&self, _t: f64, q: &Vector, _v: &Vector) -> TimeDerivatives {
        TimeDerivatives { t: 0.0, tt: 0.0, tq: Vector::zeros(q.len()), tv: Vector::zeros(q.len()) }
    }
}

/// A system under a field that oscillates: `L(q, v) + cos(w t) k . q`.
pub struct Driven {
    pub system: SharedSystem,
    /// w, rad/s
    pub frequency: f64,
    /// k, n
    pub field: Vector,
}

impl TimeDependent for Driven {
    fn dim(&self) -> usize {
        self.system.dim()
    }

    fn lagrangian(&self, t: f64, q: &Vector, v: &Vector) -> f64 {
        self.system.lagrangian(q, v) + (self.frequency * t).cos() * self.field.dot(q)
    }

    fn gradient(&self, t: f64, q: &Vector, v: &Vector) -> Gradient {
        let mut gradient = self.system.gradient(q, v);
        gradient.q.axpy((self.frequency * t).cos(), &self.field, 1.0);
        gradient
    }

    fn hessian(&self, _t: f64, q: &Vector, v: &Vector) -> Hessian {
        self.system.hessian(q, v)
    }

    fn by_time(&self, t: f64, q: &Vector, _v: &Vector) -> TimeDerivatives {
        let (w, along) = (self.frequency, self.field.dot(q));
        let (s, c) = (w * t).sin_cos();
        TimeDerivatives {
            t: -w * s * along,
            tt: -w * w * c * along,
            tq: &self.field * (-w * s),
            tv: Vector::zeros(q.len()),
        }
    }
}

/// `L~(x, x')` on R^(n+1), `x = (t, q)`.
pub struct Extended<S>(pub S);

/// `t, q, t', v = q'/t'`
fn parts(x: &Vector, rate: &Vector) -> (f64, Vector, f64, Vector) {
    let n = x.len() - 1;
    (x[0], x.rows(1, n).into_owned(), rate[0], rate.rows(1, n) / rate[0])
}

impl<S: TimeDependent> LagrangianSystem for Extended<S> {
    fn dim(&self) -> usize {
        self.0.dim() + 1
    }

    fn lagrangian(&self, x: &Vector, rate: &Vector) -> f64 {
        let (t, q, pace, v) = parts(x, rate);
        pace * self.0.lagrangian(t, &q, &v)
    }

    fn gradient(&self, x: &Vector, rate: &Vector) -> Gradient {
        let (t, q, pace, v) = parts(x, rate);
        let first = self.0.gradient(t, &q, &v);
        let scalar = |s: f64| Vector::from_element(1, s);
        Gradient {
            q: join(&scalar(pace * self.0.by_time(t, &q, &v).t), &(first.q * pace)),
            v: join(&scalar(-self.0.energy(t, &q, &v)), &first.v),
        }
    }

    fn hessian(&self, x: &Vector, rate: &Vector) -> Hessian {
        let (t, q, pace, v) = parts(x, rate);
        let (first, second) = (self.0.gradient(t, &q, &v), self.0.hessian(t, &q, &v));
        let time = self.0.by_time(t, &q, &v);
        let inertia = &second.vv * &v;
        // d/dt' at fixed q' changes v by -v/t'.
        let q_by_pace = &first.q - &second.qv * &v;
        let transposed = |a: &Vector| a.transpose();
        Hessian {
            qq: bordered(time.tt * pace, transposed(&time.tq) * pace, &time.tq * pace, &second.qq * pace),
            qv: bordered(time.t - time.tv.dot(&v), transposed(&time.tv), q_by_pace, second.qv),
            vv: bordered(v.dot(&inertia) / pace, -transposed(&inertia) / pace, -&inertia / pace, second.vv / pace),
        }
    }
}

/// `[[corner, row], [column, block]]`
fn bordered(corner: f64, row: nalgebra::RowDVector<f64>, column: Vector, block: Matrix) -> Matrix {
    let n = column.len();
    let mut all = Matrix::zeros(n + 1, n + 1);
    all[(0, 0)] = corner;
    all.view_mut((0, 1), (1, n)).copy_from(&row);
    all.view_mut((1, 0), (n, 1)).copy_from(&column);
    all.view_mut((1, 1), (n, n)).copy_from(&block);
    all
}

/// A state of the extended discrete Hamiltonian map.
#[derive(Clone, Debug)]
pub struct ExtendedState {
    pub t: f64,
    pub q: Vector,
    pub p: Vector,
    /// Discrete energy.
    pub energy: f64,
}

/// Extended discrete Hamiltonian map with the step solved for (MW 4.9.1):
///
/// ```text
/// p0 = -D_q0 L_d,  E0 = D_t0 L_d          implicit in q1 and t1
/// p1 =  D_q1 L_d,  E1 = -D_t1 L_d
/// ```
///
/// `length` is a guess for the step, such as the last one; the iteration starts from the step of that length. There is
/// a solution only where the energy can be had with a real step; a natural energy of the initial state often cannot (MW
/// example 4.9.1), so start with [`step_of_length`].
///
/// # Errors
/// [`SolveError`] where no step is found.
pub fn extended_map(
    ld: &(impl DiscreteLegendre + ?Sized),
    state: &ExtendedState,
    length: f64,
) -> Result<ExtendedState, SolveError> {
    let scalar = |s: f64| Vector::from_element(1, s);
    let (_, near) = step_of_length(ld, (state.t, &state.q, &state.p), length)?;
    let (x, y) = hamiltonian_map_from(
        ld,
        &join(&scalar(state.t), &state.q),
        &join(&scalar(-state.energy), &state.p),
        join(&scalar(near.t), &near.q),
        1.0,
    )?;
    Ok(unpack(&x, &y))
}

/// The step of a given length from `(t0, q0, p0)`, with the energies that it has (MW 4.9.2): the state at `t0`, whose
/// energy is the discrete one, and the state at its end.
///
/// # Errors
/// [`SolveError`] where `q1` is not found.
pub fn step_of_length(
    ld: &(impl DiscreteLegendre + ?Sized),
    (t0, q0, p0): (f64, &Vector, &Vector),
    length: f64,
) -> Result<(ExtendedState, ExtendedState), SolveError> {
    let n = q0.len();
    let scalar = |s: f64| Vector::from_element(1, s);
    let (x0, t1) = (join(&scalar(t0), q0), t0 + length);
    let q1 = newton("step of fixed length", q0.clone(), |q1| {
        let at = ld.legendre(&x0, &join(&scalar(t1), q1), 1.0)?;
        Ok((at.p0.rows(1, n) - p0, at.p0_q1.view((1, 1), (n, n)).into_owned()))
    })?;
    let x1 = join(&scalar(t1), &q1);
    let at = ld.legendre(&x0, &x1, 1.0)?;
    Ok((unpack(&x0, &at.p0), unpack(&x1, &at.p1)))
}

fn unpack(x: &Vector, y: &Vector) -> ExtendedState {
    let n = x.len() - 1;
    ExtendedState { t: x[0], q: x.rows(1, n).into_owned(), p: y.rows(1, n).into_owned(), energy: -y[0] }
}
