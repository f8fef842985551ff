//! Chains of many links.

use super::{Family, Length, SCAN, Scan, Truth, chain};
use crate::model::Scene;

const LINKS: &[f64] = &[10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0];

const CHAIN: Scan = Scan {
    parameter: "links",
    full_values: LINKS,
    quick_values: &[10.0, 50.0],
    full_steps: &[0.01, 1.0 / 240.0, 0.001],
    length: Length::Time(2.0),
    truth: Truth::Fine { engine: "rattle:order=4", step: |links| if links > 100.0 { 1e-2 } else { 2e-3 } },
    ..SCAN
};

pub(super) static FAMILY: Family = Family {
    name: "length",
    title: "Long chains",
    question: "do joints and energy hold when a chain has many links?",
    scans: &[
        Scan { name: "hanging", title: "rods of 0.3 m, hanging, let go 0.1 rad from the vertical", scene: hanging, ..CHAIN },
        Scan {
            name: "whip",
            title: "rods of 0.3 m, let go from horizontal",
            scene: |links| chain(links as usize, |_| 1.0, 0.05),
            length: Length::Time(3.0),
            ..CHAIN
        },
    ],
};

fn hanging(links: f64) -> Scene {
    let mut scene = chain(links as usize, |_| 1.0, 0.0);
    scene.initial[0].position = vec![std::f64::consts::FRAC_PI_2 - 0.1];
    scene
}
