//! The rank of the rows of loops and couplings.

/// Singular values, pivots and lengths of rows below this part of the largest count as zero.
///
/// Measured on the shipped linkages: where a system starts, rows that others imply leave at most 3e-16 and independent
/// ones at least 0.3; the singular values that closing meets are below 2e-16 or above 2e-3. Every value from 1e-7 to
/// 1e-11 decides alike there. Off the manifold, at the stages of an explicit method, the redundant ones of `bricard`
/// come up to 4e-11. Where the path of a linkage forks, the least singular value passes through zero within a step:
/// with 1e-9 and 1e-7 the exact linearisation left out a row that it needed there at 0.25 and 0.5 ms.
pub(crate) const RANK: f64 = 1e-10;
