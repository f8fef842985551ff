//! What the tests of `discrete` share.

use rattlebench::discrete::Vector;
use rattlebench::discrete::problems::Problem;

/// Asserts `value <= bound`; NaN fails.
#[track_caller]
pub fn at_most(value: f64, bound: f64, what: impl std::fmt::Display) {
    assert!(value <= bound, "{what}: {value:e} > {bound:e}");
}

/// Asserts `value >= bound`: a negative control. NaN fails.
#[track_caller]
pub fn at_least(value: f64, bound: f64, what: impl std::fmt::Display) {
    assert!(value >= bound, "{what}: {value:e} < {bound:e}");
}

/// `(q, p)` at the start of a problem.
pub fn start(problem: &Problem) -> (Vector, Vector) {
    (problem.q.clone(), problem.system.momentum(&problem.q, &problem.v))
}

/// Largest difference of two points of T*R^n.
pub fn distance(a: &(Vector, Vector), b: &(Vector, Vector)) -> f64 {
    (&a.0 - &b.0).amax().max((&a.1 - &b.1).amax())
}
