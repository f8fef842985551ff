//! Measured orders of all methods.

use rattlebench::discrete::methods::METHODS;
use rattlebench::discrete::order::order_table;

/// Of `L_d`, `F-`, `F+` and the map, on a nonlinear, non-separable problem with a constant mass matrix and on one whose
/// mass matrix depends on the position. The Legendre transforms are one order worse than the rest (PC section 4).
#[test]
fn orders_of_all_methods_are_within_0_15_of_theory() {
    let rows = order_table().expect("the reference motions exist");
    for row in &rows {
        let (t, m) = (row.theory, row.measured);
        for (what, theory, measured) in [
            ("L_d", t.lagrangian, m.lagrangian),
            ("F-", t.legendre_minus, m.legendre_minus),
            ("F+", t.legendre_plus, m.legendre_plus),
            ("map", t.map, m.map),
        ] {
            // measured at worst 0.14, of L_d of Gauss-Legendre 4 on the double pendulum; below order 8 at worst 0.07
            assert!(
                (measured - theory).abs() <= 0.15,
                "{} on {}: {what} has order {measured}, not {theory}",
                row.method,
                row.problem
            );
        }
        assert!(row.samples.len() >= 4, "{}", row.method);
    }
    let everywhere = METHODS.len();
    assert_eq!(rows.iter().filter(|row| row.problem == "coupled wells").count(), everywhere);
    // Newmark (2) and the explicit methods (2) need a constant mass.
    assert_eq!(rows.iter().filter(|row| row.problem == "double pendulum").count(), everywhere - 4);
}
