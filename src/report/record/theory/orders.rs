//! Measured orders of methods.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::discrete::order::{OrderRow, OrderSample, Orders};
use crate::measure::theory::ProblemOrders;

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
        let error = |s: &OrderSample| ErrorRecord {
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

impl From<ProblemOrders> for OrdersRecord {
    fn from(found: ProblemOrders) -> OrdersRecord {
        let methods = found.methods.into_iter().map(OrderRecord::from).collect();
        OrdersRecord { problem: found.problem.to_string(), methods }
    }
}

/// `x`, where it is a number that JSON can hold.
fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}
