//! Topic `orders`: measured orders of all methods (MW 2.3, PC section 4).

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::charts::{
    ChartError,
    theory::{convergence, order_table},
};
use super::{Data, Section, Table, Topic, cell, finite};
use crate::discrete::methods::METHODS;
use crate::discrete::order::{OrderRow, Orders, order_row, problems};
use crate::discrete::solve::SolveError;
use crate::report::page::document::Picture;
use crate::report::words::number::{plain, two_decimals};

pub(super) const TOPIC: Topic = Topic {
    name: "orders",
    summary: "measured orders of L_d, F-, F+ and the map of every method against theory",
    work: || (METHODS.len() * problems().len()) as u64,
    compute,
};

/// All methods on one problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OrdersRecord {
    pub problem: String,
    pub methods: Vec<OrderRecord>,
}

/// One method on one problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OrderRecord {
    pub method: String,
    /// Section or equation of Marsden and West (2001).
    pub equation: String,
    pub theory: Quantities,
    pub measured: Quantities,
    pub errors: Vec<ErrorRecord>,
}

/// A figure for each thing that belongs to a discrete Lagrangian; absent where it could not be had.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Quantities {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lagrangian: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub legendre_minus: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub legendre_plus: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<f64>,
}

/// Errors of one step, root mean square over steps along the motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ErrorRecord {
    pub step_s: f64,
    pub lagrangian: f64,
    pub legendre_minus: f64,
    pub legendre_plus: f64,
    pub map: f64,
}

impl Quantities {
    /// In the order of the table's columns.
    pub fn list(&self) -> [Option<f64>; 4] {
        [self.lagrangian, self.legendre_minus, self.legendre_plus, self.map]
    }
}

impl From<Orders> for Quantities {
    fn from(orders: Orders) -> Quantities {
        Quantities {
            lagrangian: finite(orders.lagrangian),
            legendre_minus: finite(orders.legendre_minus),
            legendre_plus: finite(orders.legendre_plus),
            map: finite(orders.map),
        }
    }
}

impl From<OrderRow> for OrderRecord {
    fn from(row: OrderRow) -> OrderRecord {
        let error = |s: &crate::discrete::order::OrderSample| ErrorRecord {
            step_s: s.h,
            lagrangian: s.lagrangian,
            legendre_minus: s.legendre_minus,
            legendre_plus: s.legendre_plus,
            map: s.map,
        };
        OrderRecord {
            method: row.method.to_string(),
            equation: row.equation.to_string(),
            theory: row.theory.into(),
            measured: row.measured.into(),
            errors: row.samples.iter().map(error).collect(),
        }
    }
}

/// Rows are independent: as many threads as there are cores take one after the other.
fn compute(done: &AtomicU64) -> Result<Data, SolveError> {
    let problems = problems();
    let tasks = METHODS.len() * problems.len();
    let (next, rows) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || -> Result<(), SolveError> {
        loop {
            let task = next.fetch_add(1, Ordering::Relaxed);
            if task >= tasks {
                return Ok(());
            }
            let row = order_row(&METHODS[task % METHODS.len()], &problems[task / METHODS.len()])?;
            rows.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push((task, row));
            done.fetch_add(1, Ordering::Relaxed);
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let mine = work();
        others
            .into_iter()
            .map(|t| t.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .fold(mine, Result::and)
    })?;
    let mut rows = rows.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    rows.sort_by_key(|(task, _)| *task);
    let mut records: Vec<OrdersRecord> =
        problems.iter().map(|p| OrdersRecord { problem: p.name.to_string(), methods: Vec::new() }).collect();
    for (task, row) in rows {
        records[task / METHODS.len()].methods.extend(row.map(OrderRecord::from));
    }
    Ok(Data::Orders(records))
}

pub(super) fn section(problems: &[OrdersRecord]) -> Result<Section, ChartError> {
    let rows = || problems.iter().flat_map(|p| &p.methods);
    let deviations = rows().flat_map(|r| r.measured.list().into_iter().zip(r.theory.list()));
    let deviations: Vec<f64> = deviations.filter_map(|(m, t)| Some((m? - t?).abs())).collect();
    let lower = rows().filter(|r| r.measured.legendre_plus < r.measured.map.map(|order| order - 0.5)).count();
    let finding = format!(
        "{} of {} orders could be measured, all within {} of theory; the discrete Legendre transforms F± have one order less than L_d \
         and the map in {lower} of {} cases.",
        deviations.len(),
        4 * rows().count(),
        plain(deviations.iter().copied().fold(0.0, f64::max), 2),
        rows().count(),
    );
    let explanation = "Order r: the error of one step is O(h^(r+1)), against the exact discrete Lagrangian, the exact momenta \
                       at both ends, and the flow. Root mean squares over 20 steps along a motion and its reversal; slope \
                       through the four smallest steps that are clear of roundoff. Theorem 2.3.1 of Marsden and West gives F± \
                       the order of L_d; the division by h that Patrick and Cuell point out takes one off, and the map has \
                       the full order all the same. Methods that need a constant mass matrix are absent from the double \
                       pendulum, whose mass matrix depends on its position."
        .to_string();
    let table = Picture {
        caption: "Measured order of L_d, F−, F+ and the map of every method on two nonlinear problems",
        png: order_table::draw(problems)?,
    };
    let lines = Picture {
        caption: "Error of one step of the map and of the Legendre transform F+ against the step size, for one method of \
                  each order",
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
