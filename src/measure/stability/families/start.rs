//! Initial states at the edge.

use std::f64::consts::PI;

use super::{Family, SCAN, Scan, chain};

pub(super) static FAMILY: Family = Family {
    name: "start",
    title: "Initial states",
    question: "is a state that is legal but odd taken as it is meant?",
    scans: &[Scan {
        name: "angle",
        title: "two rods, the elbow bent by many turns",
        parameter: "initial angle of the elbow, rad",
        full_values: &[-1e6, -PI, -1.0, 1.0, PI, 1e2, 1e4, 1e6],
        quick_values: &[-PI, PI, 1e6],
        scene: |angle| chain(2, |_| 1.0, angle),
        ..SCAN
    }],
};
