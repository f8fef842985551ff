//! The maps of one drift between two kicks: RATTLE and its relatives (Marsden and West 2001, sections 3.5.3 and 3.5.4).
//!
//! A discrete Lagrangian on `N x N` with `q1 - q0 = h v` differs from RATTLE's by where it takes the potential. With
//! the parts `w0 + w1 = 1` of the impulse `h f` of the forces that have a potential,
//!
//! ```text
//! p'  = p0 + h w0 f + G(q0)^T lambda0 ,   q1 = q0 + h M^-1 p' ,   phi(q1) = 0
//! p1  = p' + h w1 f + G(q1)^T lambda1 ,   G(q1) M^-1 p1 = 0 .
//! ```

/// Where the forces act, and what is carried from step to step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// `L_d = h/2 (L(q0, v) + L(q1, v))`: `w0 = w1 = 1/2`. Order 2, time-reversible.
    ///
    /// The constrained midpoint rule, `L_d = h L((q0 + q1)/2, v)`, is the same map: on the linear space of positions
    /// and attitude matrices the kinetic energy does not depend on the position and gravity is constant.
    Rattle,
    /// `L_d = h L(q0, v)`: `w0 = 1`, a symplectic Euler map. Order 1; its adjoint is [`Method::EulerB`].
    EulerA,
    /// `L_d = h L(q1, v)`: `w1 = 1`, a symplectic Euler map. Order 1; its adjoint is [`Method::EulerA`].
    EulerB,
    /// RATTLE in positions (Ryckaert, Ciccotti and Berendsen 1977),
    ///
    /// ```text
    /// M (q2 - 2 q1 + q0) = h^2 (f + G(q1)^T lambda1) ,   phi(q2) = 0 ,
    /// ```
    ///
    /// written with the momenta `M (q1 - q0) / h` of the middles of the steps, which are not projected. The momenta
    /// that are handed out are RATTLE's, made of them by a projection from which nothing is fed back.
    Shake,
}

impl Method {
    /// `w0`, `w1`
    #[inline(always)]
    pub(in crate::variational) fn parts(self) -> (f64, f64) {
        match self {
            Method::Rattle | Method::Shake => (0.5, 0.5),
            Method::EulerA => (1.0, 0.0),
            Method::EulerB => (0.0, 1.0),
        }
    }
}
