//! Springs and dampers that are far faster than the step.

use nalgebra::Vector3;

use super::common::{ROD_LENGTH, SCAN, chain};
use crate::measure::stability::scan::{Family, FineRun, Scan};
use crate::model::Scene;
use crate::model::scene::{Anchor, Spring};

const STIFFNESS: Scan = Scan {
    full_values: &[1.0, 1e2, 1e4, 1e6, 1e8, 1e10, 1e12],
    quick_values: &[1e2, 1e6, 1e12],
    truth: Some(FineRun { engine: "rattle", step: |_| 2e-5 }),
    ..SCAN
};

pub(super) static FAMILY: Family = Family {
    name: "stiffness",
    title: "Stiff springs and dampers",
    question: "does a force that is far faster than the step stay harmless?",
    explicit: true,
    scans: &[
        Scan {
            name: "joint_spring",
            title: "two rods, a spring in the elbow that is unstrained when straight",
            parameter: "stiffness, N m/rad",
            scene: joint_spring,
            ..STIFFNESS
        },
        Scan {
            name: "point_spring",
            title: "two rods, the tip hung from a point 0.5 m above it by a spring without slack",
            parameter: "stiffness, N/m",
            scene: |stiffness| point_spring(stiffness, 0.0),
            ..STIFFNESS
        },
        Scan {
            name: "joint_damper",
            title: "two rods, a viscous damper in the elbow, which is bent by 0.5 rad",
            parameter: "damping, N m s/rad",
            scene: joint_damper,
            ..STIFFNESS
        },
        Scan {
            name: "point_damper",
            title: "two rods, the tip hung from a point 0.5 m above it by a soft spring with a damper",
            parameter: "damping, N s/m",
            scene: |damping| point_spring(100.0, damping),
            ..STIFFNESS
        },
    ],
};

/// Two rods, let go from horizontal.
fn joint_spring(stiffness: f64) -> Scene {
    let mut scene = chain(2, |_| 1.0, 0.0);
    scene.springs = vec![Spring::Joint { joint: 1, stiffness, damping: 0.0, rest: 0.0 }];
    scene
}

/// Two rods, let go from horizontal, the elbow bent by 0.5 rad and damped.
fn joint_damper(damping: f64) -> Scene {
    let mut scene = chain(2, |_| 1.0, 0.5);
    scene.model.joints[1].damping = damping;
    scene
}

/// Two rods from horizontal whose tip hangs from the ground; the spring is as long as it wants to be at the start.
fn point_spring(stiffness: f64, damping: f64) -> Scene {
    let (from, to) = (Vector3::new(ROD_LENGTH, 0.0, 0.0), Vector3::new(2.0 * ROD_LENGTH, 0.0, 0.5));
    let (from, to) = (Anchor { link: Some(2), point: from }, Anchor { link: None, point: to });
    let mut scene = chain(2, |_| 1.0, 0.0);
    scene.springs = vec![Spring::Points { from, to, stiffness, damping, rest_length: 0.5 }];
    scene
}
