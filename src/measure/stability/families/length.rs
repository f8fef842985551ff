//! Chains of many links.

use nalgebra::Vector3;

use super::common::{FINE, ROD_LENGTH, ROD_RADIUS, SCAN, chain, closure};
use crate::measure::stability::scan::{Family, FineRun, Length, Scan};
use crate::model::assemble::{Assembly, Mount};
use crate::model::scene::LoopKind;
use crate::model::{Inertial, Scene};

const LINKS: &[f64] = &[10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0];

const CHAIN: Scan = Scan {
    parameter: "links",
    full_values: LINKS,
    quick_values: &[10.0, 50.0],
    full_steps: &[0.01, 1.0 / 240.0, 0.001],
    length: Length::Time(2.0),
    truth: Some(FineRun { engine: "rattle:order=4", step: |links| if links > 100.0 { 1e-2 } else { 2e-3 } }),
    ..SCAN
};

pub(super) static FAMILY: Family = Family {
    name: "length",
    title: "Long chains",
    question: "do joints and energy hold when a chain has many links?",
    explicit: false,
    scans: &[
        Scan {
            name: "hanging",
            title: "rods of 0.3 m, hanging, let go 0.1 rad from the vertical",
            scene: hanging,
            ..CHAIN
        },
        Scan {
            name: "whip",
            title: "rods of 0.3 m, let go from horizontal",
            scene: |links| chain(links as usize, |_| 1.0, 0.05),
            length: Length::Time(3.0),
            ..CHAIN
        },
        Scan {
            name: "net",
            title: "a net of rods with ball joints, hung from one side and blown aside",
            parameter: "meshes to a side",
            full_values: &[1.0, 2.0, 3.0, 4.0, 6.0],
            quick_values: &[1.0, 2.0],
            full_steps: &[0.01, 1.0 / 240.0, 0.001],
            length: Length::Time(1.0),
            scene: net,
            truth: Some(FINE),
            ..CHAIN
        },
    ],
};

fn hanging(links: f64) -> Scene {
    let mut scene = chain(links as usize, |_| 1.0, 0.0);
    scene.initial[0].position = vec![std::f64::consts::FRAC_PI_2 - 0.1];
    scene
}

/// `n + 1` hanging chains of `n` rods, 0.3 m apart, with a rod across from each joint to that of the next chain: `n^2`
/// loops. Gravity leans by half out of the plane.
fn net(n: f64) -> Scene {
    let n = n as usize;
    let mut assembly = Assembly::new("net");
    let rod = || Some(Inertial::rod(ROD_LENGTH, ROD_RADIUS, 0.1));
    let down = || {
        let mut rod = Inertial::rod(ROD_LENGTH, ROD_RADIUS, 0.1);
        rod.com = Vector3::new(0.0, 0.0, -0.5 * ROD_LENGTH);
        rod.inertia.swap((0, 0), (2, 2));
        Some(rod)
    };
    let end = Vector3::new(0.0, 0.0, -ROD_LENGTH);
    let mut links = vec![vec![0; n]; n + 1];
    for (column, links) in links.iter_mut().enumerate() {
        for row in 0..n {
            let (parent, at) = match row {
                0 => (0, Vector3::new(column as f64 * ROD_LENGTH, 0.0, 0.0)),
                _ => (links[row - 1], end),
            };
            links[row] = assembly.add(parent, Mount::ball(at), down());
        }
    }
    let mut loops = Vec::new();
    for column in 0..n {
        for row in 0..n {
            let across = assembly.add(links[column][row], Mount::ball(end), rod());
            let tip = (Some(across), Vector3::new(ROD_LENGTH, 0.0, 0.0));
            loops.push(closure(LoopKind::Spherical, tip, (Some(links[column + 1][row]), end)));
        }
    }
    Scene { loops, gravity: Vector3::new(0.0, 4.9, -9.81), ..assembly.scene() }
}
