//! Tiny steps, and very many of them.

use super::common::{FINE, SCAN, chain};
use crate::measure::stability::scan::{Family, Length, Scan};

pub(super) static FAMILY: Family = Family {
    name: "step",
    title: "Tiny steps and long runs",
    question: "does roundoff stay out when steps are tiny or very many?",
    explicit: true,
    scans: &[
        Scan {
            name: "size",
            title: "rods from horizontal",
            parameter: "links",
            full_values: &[1.0, 2.0, 5.0],
            quick_values: &[2.0],
            full_steps: &[0.1, 0.01, 1e-3, 1e-4, 1e-5, 1e-6],
            quick_steps: &[0.01, 1e-4],
            length: Length::Time(1.0),
            scene: |links| chain(links as usize, |_| 1.0, 0.1),
            truth: Some(FINE),
            ..SCAN
        },
        Scan {
            name: "count",
            title: "a pendulum from horizontal",
            parameter: "steps",
            full_values: &[1e4, 1e5, 1e6, 1e7],
            quick_values: &[1e4, 1e5],
            full_steps: &[0.01, 0.001],
            length: Length::Steps,
            scene: |_| chain(1, |_| 1.0, 0.0),
            truth: None,
            ..SCAN
        },
    ],
};
