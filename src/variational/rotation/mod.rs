//! How a body turns over one step: `R1 = R0 F(s)` with the Cayley rotation `F(s)`, the quaternion `(1, s) / sqrt(1 +
//! |s|^2)`.
//!
//! The vector `s` follows from the body's angular momentum `m0 = R0^T pi` (body axes) by the discrete Legendre
//! transform of the rule's discrete Lagrangian. All rules are variational, of order 2 and time-reversible, and leave
//! `pi` as it is.
//!
//! Moser-Veselov makes the step RATTLE proper and has no solution once a body turns by about 1 rad a step; the
//! splitting is explicit, exact for a body with two equal moments, and has no such limit. Measured energy errors of
//! RATTLE with each rule:
//!
//! | motion | step | Moser-Veselov | Cayley | splitting |
//! | --- | --- | --- | --- | --- |
//! | top at 300 rad/s, 1 s | 1 ms | 5.5e-5 | 1.7e-3 | 6.4e-6 |
//! | | 10 ms | no solution | 5.4e-2 | 6.4e-4 |
//! | chain of 10 rods, 2 s | 1 ms | 1.21e-5 | 1.03e-5 | 1.15e-5 |
//! | chain of 5 asymmetric links, 1 s | 10 ms | 1.5e-3 | 9.9e-4 | 1.4e-3 |
//! | whip of 50 rods, 5 s | 2 ms | 1.08e-4 | 9.1e-5 | 1.02e-4 |
//!
//! On ordinary chains the rules differ by 10 to 40 %, so RATTLE proper is the default while it can be solved; a fast
//! body is where they part, and there the splitting is the most accurate.

mod free_body;
mod implicit;
mod rule;

pub use rule::Rotation;
