//! Galerkin with sinusoidal trajectories, for motion that oscillates with a known frequency.

use crate::discrete::force::Force;
use crate::discrete::lagrangian::{DiscreteLagrangian, Forced, Jet};
use crate::discrete::quadrature::Quadrature;
use crate::discrete::solve::SolveError;
use crate::discrete::stencil::{Node, Part, Stencil, StencilLagrangian};
use crate::discrete::system::SharedSystem;
use crate::discrete::{Matrix, Vector};

/// Galerkin method (MW 2.6.10) on the trajectories `a + b cos(w t) + c sin(w t)` (MW 5.3.8), with one internal point in
/// the middle of the step.
///
/// Exact for an oscillator of frequency `w` up to quadrature; on other smooth problems as good as polynomials of degree
/// two, order `min(4, u)` for a quadrature of order `u`. Needs `|w h| < pi`.
pub struct Trigonometric {
    pub system: SharedSystem,
    /// w, rad/s
    pub frequency: f64,
    pub quadrature: Quadrature,
}

impl Trigonometric {
    /// The basis `1, sin(x)/y, (1 - cos(x))/y^2` and its derivatives in `t = x/y`, at `x = t y`, `y = w h`. The scaling
    /// keeps it independent as `y` goes to 0.
    fn basis(t: f64, y: f64) -> ([f64; 3], [f64; 3]) {
        let half = (0.5 * t * y).sin();
        let x = t * y;
        ([1.0, x.sin() / y, 2.0 * half * half / (y * y)], [0.0, x.cos(), x.sin() / y])
    }

    fn at_step(&self, h: f64) -> Result<StencilLagrangian, SolveError> {
        let y = self.frequency * h;
        let control = [0.0, 0.5, 1.0];
        // Row k: the basis at control point k. The cardinal functions are basis times its inverse.
        let collocation = Matrix::from_fn(3, 3, |k, j| Self::basis(control[k], y).0[j]);
        let inverse =
            collocation.try_inverse().ok_or(SolveError::Singular { what: "trigonometric trajectories (w h = pi?)" })?;
        let cardinal = |row: [f64; 3]| (Matrix::from_row_slice(1, 3, &row) * &inverse).as_slice().to_vec();
        let nodes = self.quadrature.nodes.iter().zip(&self.quadrature.weights).map(|(&c, &weight)| {
            let (value, slope) = Self::basis(c, y);
            Node { part: Part::Lagrangian, weight, position: cardinal(value), velocity: cardinal(slope) }
        });
        let stencil = Stencil { nodes: nodes.collect(), internal: vec![[0.5, 0.5]], side_condition: None };
        Ok(StencilLagrangian::new(self.system.clone(), stencil))
    }
}

impl DiscreteLagrangian for Trigonometric {
    fn dim(&self) -> usize {
        self.system.dim()
    }

    fn jet(&self, q0: &Vector, q1: &Vector, h: f64) -> Result<Jet, SolveError> {
        self.at_step(h)?.jet(q0, q1, h)
    }

    fn forced(&self, force: &dyn Force, q0: &Vector, q1: &Vector, h: f64) -> Result<Forced, SolveError> {
        self.at_step(h)?.forced(force, q0, q1, h)
    }
}
