//! The section of topic `orders`.

use super::section::Section;
use super::table::Table;
use crate::report::charts::{
    ChartError,
    theory::{convergence, order_table},
};
use crate::report::page::document::Picture;
use crate::report::record::theory::orders::{OrderRecord, OrdersRecord};
use crate::report::words::number::{plain, two_decimals};

pub(super) fn section(problems: &[OrdersRecord]) -> Result<Section, ChartError> {
    let rows = || problems.iter().flat_map(|p| &p.methods);
    let deviations = rows().flat_map(|r| r.measured.list().into_iter().zip(r.theory.list()));
    let deviations: Vec<f64> = deviations.filter_map(|(m, t)| Some((m? - t?).abs())).collect();
    let lower = rows().filter(|r| r.measured.legendre_plus < r.measured.map.map(|order| order - 0.5)).count();
    let finding = format!(
        "{} of {} orders could be measured, all within {} of theory; the discrete Legendre transforms F± have one \
         order less than L_d and the map in {lower} of {} cases.",
        deviations.len(),
        4 * rows().count(),
        plain(deviations.iter().copied().fold(0.0, f64::max), 2),
        rows().count(),
    );
    let explanation = "Order r: the error of one step is O(h^(r+1)), against the exact discrete Lagrangian, the exact \
                       momenta at both ends, and the flow. Root mean squares over 20 steps along a motion and its \
                       reversal; slope through the four smallest steps that are clear of roundoff. Theorem 2.3.1 of \
                       Marsden and West gives F± the order of L_d; the division by h that Patrick and Cuell point out \
                       takes one off, and the map has the full order all the same. Methods that need a constant mass \
                       matrix are absent from the double pendulum, whose mass matrix depends on its position."
        .to_string();
    let table = Picture {
        caption: "Measured order of L_d, F−, F+ and the map of every method on two nonlinear problems",
        png: order_table::draw(problems)?,
    };
    let lines = Picture {
        caption: "Error of one step of the map and of the Legendre transform F+ against the step size, for one method \
                  of each order",
        png: convergence::draw(&problems[0])?,
    };
    Ok(Section {
        title: "Orders of the discrete Lagrangian, its Legendre transforms and its map",
        finding,
        explanation,
        charts: vec![("orders.png".to_string(), table), ("convergence.png".to_string(), lines)],
        tables: problems.iter().map(order_columns).collect(),
    })
}

fn order_columns(problem: &OrdersRecord) -> Table {
    let row = |r: &OrderRecord| {
        let figures = r.measured.list().into_iter().zip(r.theory.list());
        let cells = figures.map(|(m, t)| format!("{} ({})", cell(m, two_decimals), cell(t, |x| plain(x, 1))));
        [r.method.clone(), r.equation.clone()].into_iter().chain(cells).collect()
    };
    Table {
        caption: format!("Orders on the {}: measured (theory).", problem.problem),
        headings: vec!["method", "Marsden and West", "L_d", "F−", "F+", "map"],
        rows: problem.methods.iter().map(row).collect(),
    }
}

/// Text of a figure, a dash where there is none.
fn cell(x: Option<f64>, text: impl Fn(f64) -> String) -> String {
    x.map_or_else(|| "–".to_string(), text)
}
