//! Runs that no other beats in both cost and error.

/// Of `(cost, error)` pairs those that no other is both as cheap as and more accurate than, by index, the cheapest
/// first.
pub fn front(runs: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..runs.len()).collect();
    order.sort_by(|&a, &b| runs[a].0.total_cmp(&runs[b].0).then(runs[a].1.total_cmp(&runs[b].1)));
    let mut best = f64::INFINITY;
    order.retain(|&i| {
        let better = runs[i].1 < best;
        best = best.min(runs[i].1);
        better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_front_has_what_no_other_beats() {
        assert_eq!(front(&[(2.0, 1e-2), (1.0, 1e-1), (3.0, 2e-2), (4.0, 1e-4)]), [1, 0, 3]);
    }
}
