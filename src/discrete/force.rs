//! Forces that have no potential (MW section 3.1).

use super::{Matrix, Vector};

/// A force `f(q, v)`, a covector on R^n, with its derivatives.
pub trait Force: Send + Sync {
    fn value(&self, q: &Vector, v: &Vector) -> Vector;

    /// `df/dq` and `df/dv`, n x n each.
    fn jacobian(&self, q: &Vector, v: &Vector) -> (Matrix, Matrix);
}

/// Viscous drag `f = -C v`.
#[derive(Clone, Debug)]
pub struct LinearDrag {
    /// C, n x n
    pub coefficient: Matrix,
}

impl Force for LinearDrag {
    fn value(&self, _q: &Vector, v: &Vector) -> Vector {
        -(&self.coefficient * v)
    }

    fn jacobian(&self, _q: &Vector, v: &Vector) -> (Matrix, Matrix) {
        (Matrix::zeros(v.len(), v.len()), -&self.coefficient)
    }
}

/// Drag along the distance from the origin, `f = -c (q . v) q`: it takes energy and exerts no torque about the origin.
#[derive(Clone, Debug)]
pub struct RadialDrag {
    pub coefficient: f64,
}

impl Force for RadialDrag {
    fn value(&self, q: &Vector, v: &Vector) -> Vector {
        q * (-self.coefficient * q.dot(v))
    }

    fn jacobian(&self, q: &Vector, v: &Vector) -> (Matrix, Matrix) {
        let n = q.len();
        let by_q = (q * v.transpose() + Matrix::identity(n, n) * q.dot(v)) * -self.coefficient;
        (by_q, q * q.transpose() * -self.coefficient)
    }
}
