//! Measured orders of all methods.

use rattlebench::discrete::order::order_table;

#[test]
fn orders_of_all_methods_are_within_0_15_of_theory() {
    let rows = order_table().expect("reference motion");
    for row in &rows {
        let (t, m) = (row.theory, row.measured);
        println!(
            "{:33} {:16} {:5.2} {:5.2} {:5.2} {:5.2} (theory {} {} {})",
            row.method,
            row.problem,
            m.lagrangian,
            m.legendre_minus,
            m.legendre_plus,
            m.map,
            t.lagrangian,
            t.legendre_minus,
            t.map
        );
    }
    for row in &rows {
        let (t, m) = (row.theory, row.measured);
        for (what, theory, measured) in [
            ("L_d", t.lagrangian, m.lagrangian),
            ("F-", t.legendre_minus, m.legendre_minus),
            ("F+", t.legendre_plus, m.legendre_plus),
            ("map", t.map, m.map),
        ] {
            assert!(
                (measured - theory).abs() <= 0.15,
                "{} on {}: {what} has order {measured}, not {theory}",
                row.method,
                row.problem
            );
        }
    }
}
