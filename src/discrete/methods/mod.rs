//! Discrete Lagrangians, one file each. A new one is a file and a line in [`METHODS`].

mod adjoint;
mod alpha;
mod composition;
mod equivalent;
mod exact;
mod explicit_prk;
mod galerkin;
mod newmark;
mod partitioned_rk;
mod symmetrised;
mod trigonometric;

use std::sync::Arc;

pub use adjoint::Adjoint;
pub use alpha::alpha;
pub use composition::Composition;
pub use equivalent::Equivalent;
pub use exact::Exact;
use explicit_prk::forest_ruth;
pub use explicit_prk::ruth;
pub use galerkin::polynomial;
pub use newmark::Newmark;
pub use partitioned_rk::{constrained_lobatto, gauss, lobatto, partitioned_rk};
pub use symmetrised::symmetrised;
pub use trigonometric::Trigonometric;

use super::lagrangian::{DiscreteLagrangian, SharedLagrangian};
use super::quadrature::Quadrature;
use super::system::SharedSystem;

/// A way to make a discrete Lagrangian from a system.
pub struct Method {
    pub name: &'static str,
    /// Where it stands in Marsden and West (2001).
    pub equation: &'static str,
    /// Order of `L_d` and of the discrete Hamiltonian map.
    pub order: usize,
    /// Order of the map under a force that depends on the velocity, lower than `order` where the discrete forces are.
    pub forced_order: usize,
    /// True where `L_d` is its own adjoint.
    pub self_adjoint: bool,
    /// `None` where the method is not defined for the system.
    pub build: fn(SharedSystem) -> Option<SharedLagrangian>,
}

fn some(ld: impl DiscreteLagrangian + 'static) -> Option<SharedLagrangian> {
    Some(Arc::new(ld))
}

fn shared(ld: Option<impl DiscreteLagrangian + 'static>) -> Option<SharedLagrangian> {
    ld.map(|ld| Arc::new(ld) as SharedLagrangian)
}

const fn method(
    name: &'static str,
    equation: &'static str,
    order: usize,
    self_adjoint: bool,
    build: fn(SharedSystem) -> Option<SharedLagrangian>,
) -> Method {
    Method { name, equation, order, forced_order: order, self_adjoint, build }
}

/// A method whose discrete forces are of a lower order than its discrete Lagrangian.
const fn with_forces_of_order(forced_order: usize, method: Method) -> Method {
    Method { forced_order, ..method }
}

/// All methods with a finite order. The exact discrete Lagrangian is [`Exact`].
pub const METHODS: &[Method] = &[
    method("symplectic Euler B (alpha = 0)", "2.3.2", 1, false, |s| some(alpha(s, 0.0))),
    method("symplectic Euler A (alpha = 1)", "2.3.2", 1, false, |s| some(alpha(s, 1.0))),
    method("alpha = 1/4", "2.3.2", 1, false, |s| some(alpha(s, 0.25))),
    method("midpoint (alpha = 1/2)", "2.3.2", 2, true, |s| some(alpha(s, 0.5))),
    method("Stoermer-Verlet", "2.6.1", 2, true, |s| some(symmetrised(s, 0.0))),
    method("symmetrised alpha = 1/4", "2.3.3", 2, true, |s| some(symmetrised(s, 0.25))),
    method("adjoint of alpha = 1/4", "2.4.1", 1, false, |s| some(Adjoint(Arc::new(alpha(s, 0.25))))),
    method("Newmark beta = 1/4", "2.6.2", 2, true, |s| shared(Newmark::new(s, 0.25))),
    method("Newmark beta = 1/6", "2.6.2", 2, true, |s| shared(Newmark::new(s, 1.0 / 6.0))),
    with_forces_of_order(1, method("Ruth 3", "2.6.3", 3, false, |s| shared(ruth(s)))),
    method("Forest-Ruth 4", "2.6.3", 4, true, |s| shared(forest_ruth(s))),
    method("Gauss-Legendre 1", "2.6.8", 2, true, |s| some(gauss(s, 1))),
    method("Gauss-Legendre 2", "2.6.8", 4, true, |s| some(gauss(s, 2))),
    method("Gauss-Legendre 3", "2.6.8", 6, true, |s| some(gauss(s, 3))),
    method("Gauss-Legendre 4", "2.6.8", 8, true, |s| some(gauss(s, 4))),
    method("Lobatto IIIA-IIIB 2", "2.6.8", 2, true, |s| some(lobatto(s, 2))),
    method("Lobatto IIIA-IIIB 3", "2.6.8", 4, true, |s| some(lobatto(s, 3))),
    method("Lobatto IIIA-IIIB 4", "2.6.8", 6, true, |s| some(lobatto(s, 4))),
    method("Lobatto IIIA-IIIB 5", "2.6.8", 8, true, |s| some(lobatto(s, 5))),
    method("Galerkin 1, Gauss 2", "2.6.10", 2, true, |s| some(polynomial(s, 1, &Quadrature::gauss(2)))),
    method("Galerkin 2, Lobatto 3", "2.6.10", 4, true, |s| some(polynomial(s, 2, &Quadrature::lobatto(3)))),
    method("Galerkin 2, Gauss 3", "2.6.10", 4, true, |s| some(polynomial(s, 2, &Quadrature::gauss(3)))),
    method("Galerkin 3, Gauss 4", "2.6.10", 6, true, |s| some(polynomial(s, 3, &Quadrature::gauss(4)))),
    method("Galerkin 4, Gauss 4", "2.6.10", 8, true, |s| some(polynomial(s, 4, &Quadrature::gauss(4)))),
    method("trigonometric, Gauss 3", "5.3.8", 4, true, |s| {
        some(Trigonometric { system: s, frequency: 1.5, quadrature: Quadrature::gauss(3) })
    }),
    method("composition, Verlet Suzuki 4", "2.5.1", 4, true, |s| {
        some(Composition::suzuki4(Arc::new(symmetrised(s, 0.0))))
    }),
    method("composition, midpoint Yoshida 6", "2.5.1", 6, true, |s| {
        some(Composition::yoshida6(Arc::new(alpha(s, 0.5))))
    }),
    method("composition, Euler and adjoint", "2.5.1", 2, true, |s| {
        let euler: SharedLagrangian = Arc::new(alpha(s, 0.0));
        some(Composition { parts: vec![(0.5, euler.clone()), (0.5, Arc::new(Adjoint(euler)))] })
    }),
];
