//! Discrete mechanics on linear spaces (Marsden and West 2001, parts 1 to 4).

pub mod constrained;
pub mod constraint;
pub mod extended;
pub mod flow;
pub mod force;
pub mod lagrangian;
pub mod maps;
pub mod methods;
pub mod order;
pub mod problems;
pub mod quadrature;
pub mod solve;
pub mod stencil;
pub mod structure;
pub mod system;
pub mod tangent;

/// A vector of R^n.
pub type Vector = nalgebra::DVector<f64>;
/// A real matrix.
pub type Matrix = nalgebra::DMatrix<f64>;
