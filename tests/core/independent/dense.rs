//! RATTLE and the symplectic Euler maps as Marsden and West (2001) print them in sections 3.5.3 and 3.5.4, with all
//! multipliers, solved by dense Newton.

use rattlebench::discrete::constraint::Constraint;
use rattlebench::discrete::{Matrix, Vector};

/// A constrained system with a constant diagonal mass matrix and a constant force.
pub struct Problem<C> {
    pub mass: Vector,
    pub force: Vector,
    /// Quadratic in `q`.
    pub constraint: C,
}

impl<C: Constraint> Problem<C> {
    /// One step from `phi(q0) = 0`, `G(q0) v0 = 0`; returns `q1` and `v1 = M^-1 p1`.
    ///
    /// ```text
    /// p'  = p0 + h w0 f(q0) + G(q0)^T lambda0 ,     q1 = q0 + h M^-1 p' ,     phi(q1) = 0
    /// p1  = p' + h w1 f(q1) + G(q1)^T lambda1 ,     G(q1) M^-1 p1 = 0
    /// ```
    ///
    /// With the parts `(w0, w1) = (1/2, 1/2)` it is RATTLE, with `(1, 0)` and `(0, 1)` the two symplectic Euler maps.
    ///
    /// The unknowns of the first line are `w = M^-1 p'` and `lambda0`. Since `phi` is quadratic and zero at `q0`,
    /// `phi(q1) / h = 1/2 (G(q0) + G(q1)) w`, in which nothing cancels for small `h`.
    pub fn step(&self, (w0, w1): (f64, f64), q0: &Vector, v0: &Vector, h: f64) -> (Vector, Vector) {
        let (n, m) = (q0.len(), self.constraint.count());
        let p0 = self.mass.component_mul(v0);
        let g0 = self.constraint.jacobian(q0);
        let (mut w, mut lambda0) = (v0.clone(), Vector::zeros(m));
        let mut last = f64::INFINITY;
        for iteration in 0.. {
            let g1 = self.constraint.jacobian(&(q0 + &w * h));
            let momentum = self.mass.component_mul(&w) - &p0 - &self.force * (w0 * h) - g0.tr_mul(&lambda0);
            let closure = (&g0 + &g1) * &w * 0.5;
            let update = self.saddle(&g0, &g1, &momentum, &closure);
            w -= update.rows(0, n);
            lambda0 -= update.rows(n, m);
            let size = update.rows(0, n).amax();
            if size <= 1e-12 * w.amax() && size >= 0.5 * last || size == 0.0 {
                break;
            }
            assert!(iteration < 30, "Newton's method stops at {size:e}");
            last = size;
        }
        let q1 = q0 + &w * h;
        let v1 = self.project(&q1, &(self.mass.component_mul(&w) + &self.force * (w1 * h)));
        (q1, v1)
    }

    /// `v = M^-1 (p + G(q)^T lambda)` with `G(q) v = 0`.
    pub fn project(&self, q: &Vector, p: &Vector) -> Vector {
        let g = self.constraint.jacobian(q);
        self.saddle(&g, &g, p, &Vector::zeros(g.nrows())).rows(0, p.len()).into_owned()
    }

    /// Solves `M a - push^T b = top`, `pull a = bottom` and stacks `a` and `b`.
    fn saddle(&self, push: &Matrix, pull: &Matrix, top: &Vector, bottom: &Vector) -> Vector {
        let (n, m) = (top.len(), bottom.len());
        let mut all = Matrix::zeros(n + m, n + m);
        all.view_mut((0, 0), (n, n)).set_diagonal(&self.mass);
        all.view_mut((0, n), (n, m)).copy_from(&-push.transpose());
        all.view_mut((n, 0), (m, n)).copy_from(pull);
        let right = Vector::from_iterator(n + m, top.iter().chain(bottom.iter()).copied());
        all.lu().solve(&right).expect("independent constraints")
    }
}
